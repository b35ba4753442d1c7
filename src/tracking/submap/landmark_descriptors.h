// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the map's points looked like, to recognize them in an image of which nothing is known (docs/method.md, eq. R3).
#pragma once

#include <map>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pliant/base/ids.h"
#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/estimation/pose/absolute_pose.h"
#include "pliant/image/corners.h"
#include "pliant/image/masks.h"
#include "pliant/scene/map.h"
#include "pliant/tracking/relocalization/relocalization_options.h"

namespace pliant {

class StateArchive;

// The corners of an image, and what they look like, a row each.
struct DescribedImage {
  std::vector<Eigen::Vector2d> pixels;
  cv::Mat descriptors;
};
DescribedImage Describe(const cv::Mat& gray, const SupportMask& mask, const CornerOptions& corners,
                        const RelocalizationOptions& options);

class LandmarkDescriptors {
 public:
  explicit LandmarkDescriptors(const RelocalizationOptions& options) : options_(options) {}

  void Clear() { descriptors_.clear(); }
  // The landmarks as they look in an image, each at its pixel; what was known of them is replaced.
  void See(const cv::Mat& gray, const std::vector<Landmark>& landmarks);
  // All that `other` knows of other points.
  void TakeOver(LandmarkDescriptors&& other) { descriptors_.merge(other.descriptors_); }
  // Forgets all points but these. Sorted.
  void Keep(const std::vector<PointId>& known);

  // The camera of an image that sees some of these landmarks, wherever it may be. Fails as EstimateAbsolutePose does.
  Result<AbsolutePose> Recognize(const DescribedImage& image, const Camera& camera,
                                 const std::vector<Landmark>& landmarks) const;

  void Serialize(StateArchive& archive);

 private:
  RelocalizationOptions options_;
  std::map<PointId, cv::Mat> descriptors_;  // one row each
};

}  // namespace pliant
