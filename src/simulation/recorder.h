// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the way from the camera to the files does to images: a video codec, then JPEG. The frames of one camera, in
// their order.
#pragma once

#include <optional>

#include <opencv2/core/mat.hpp>

#include "pliant/simulation/options.h"
#include "simulation/video_codec.h"

namespace pliant::simulation {

class Recorder {
 public:
  explicit Recorder(const SimulationOptions::Recording& options);

  // The next frame as it is recorded; CV_8UC3. An empty image stays empty.
  cv::Mat Record(const cv::Mat& image);

 private:
  std::optional<VideoCodec> video_;
  int jpeg_quality_;
};

}  // namespace pliant::simulation
