// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The images of a board, or pairs of them, of a folder or a video.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "datasets/image_stream.h"
#include "pliant/base/status.h"
#include "pliant/pipeline/calibrate_images.h"

namespace pliant {

struct BoardImage {
  std::string name;
  std::vector<cv::Mat> gray;  // CV_8UC1; of a pair left and right
  double sharpness = 0;       // of a pair the less sharp one's
};

using ImageStreams = std::vector<std::unique_ptr<ImageStream>>;  // one, or two of a pair

class BoardImageReader {
 public:
  // Fails as CalibrateImages does.
  static Result<BoardImageReader> Open(const CalibrateRequest& request);

  // The next image or pair; nothing at the end. Fails with kUnreadable where there is none at all, and with kMismatch
  // for images of different sizes, or pairs of which one image is missing.
  Result<std::optional<BoardImage>> Next();

  int count() const { return count_; }                                   // that were read
  const std::vector<cv::Size>& sizes() const { return sizes_; }          // of the images, by camera
  int expected() const { return streams_.front()->count(); }             // 0: not known
  std::optional<double> fps() const { return streams_.front()->fps(); }  // of a video

 private:
  BoardImageReader(CalibrateRequest request, ImageStreams streams)
      : request_(std::move(request)), streams_(std::move(streams)) {}

  CalibrateRequest request_;
  ImageStreams streams_;
  std::vector<cv::Size> sizes_;
  int count_ = 0;
};

}  // namespace pliant
