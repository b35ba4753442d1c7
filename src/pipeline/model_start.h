// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A COLMAP model as the start of a run: of each of its images the keypoints that have a point, with their depths.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/tracking/tracker.h"

namespace pliant {

class ModelStart {
 public:
  // Fails as colmap::ReadModel does; with kUnreadable for a damaged model; with kMismatch if its images are not of the
  // sequence's size.
  static Result<ModelStart> Open(const std::string& folder, const Camera& camera);

  // Those in the image of this name, or, where one image alone has it, of this stem; those with the longest tracks
  // first. Empty where the model does not have the image.
  std::vector<PixelDepth> PointsIn(const std::string& image_name) const;

 private:
  std::map<std::string, std::vector<PixelDepth>> points_;  // by the image's name
  std::map<std::string, std::vector<std::string>> names_of_stem_;
};

}  // namespace pliant
