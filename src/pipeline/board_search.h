// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Where the board is in the images of a recording: in the sharpest of every stretch of it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pliant/base/status.h"
#include "pliant/board/find_board.h"
#include "pliant/pipeline/calibrate_images.h"

namespace pliant {

// One image, or a pair: a value by camera. The image itself is not kept, since hundreds of large ones fill the memory.
struct SearchedImage {
  std::string name;
  double sharpness = 0;
  std::vector<std::optional<BoardView>> found;
  std::vector<cv::Mat> smaller;  // AsSearched
};

struct BoardRecording {
  std::vector<SearchedImage> images;
  std::vector<cv::Size> sizes;  // of the images, by camera
  int images_read = 0;
  std::optional<double> fps = {};
};

// Searches at most CalibrateOptions::max_images. Fails as CalibrateImages does.
Result<BoardRecording> SearchBoards(const CalibrateRequest& request, const CalibrateOptions& options,
                                    const JobProgress& progress);

}  // namespace pliant
