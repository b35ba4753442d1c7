// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The images in which a board is searched for: of a stream of images, or of pairs of them, the sharpest of every
// stretch.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pliant/base/status.h"
#include "pliant/pipeline/calibrate_images.h"

namespace pliant {

struct BoardImage {
  std::string name;
  std::vector<cv::Mat> gray;  // CV_8UC1; of a pair left and right
  double sharpness = 0;       // of a pair the less sharp one's
};

struct BoardImages {
  std::vector<BoardImage> images;
  int count = 0;  // that were read
  std::optional<double> fps = {};
};

// At most `max_images`. Fails as CalibrateImages does.
Result<BoardImages> ReadBoardImages(const CalibrateRequest& request, int max_images, const CalibrateProgress& progress);

}  // namespace pliant
