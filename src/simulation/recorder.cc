// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/recorder.h"

#include <vector>

#include <opencv2/imgcodecs.hpp>

namespace pliant::simulation {

Recorder::Recorder(const SimulationOptions::Recording& options) : jpeg_quality_(options.jpeg_quality) {
  if (options.video_qp > 0) video_.emplace(options.video_qp, options.key_frame_every);
}

cv::Mat Recorder::Record(const cv::Mat& image) {
  if (image.empty()) return image;
  cv::Mat video = video_ ? video_->Decode(image) : image;
  if (jpeg_quality_ == 0) return video;
  std::vector<unsigned char> file;
  cv::imencode(".jpg", video, file, {cv::IMWRITE_JPEG_QUALITY, jpeg_quality_});
  return cv::imdecode(file, cv::IMREAD_COLOR);
}

}  // namespace pliant::simulation
