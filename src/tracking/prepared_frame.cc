// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/prepared_frame.h"

#include <utility>

#include "pliant/image/sharpness.h"
#include "pliant/tracking/stage_times.h"

namespace pliant {

PreparedFrame PrepareFrame(int frame_idx, std::string name, double timestamp_s, const cv::Mat& image,
                           const cv::Mat& mask, const TrackerOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  PreparedFrame frame;
  frame.frame_idx = frame_idx;
  frame.step = frame_idx / options.frame_stride;
  frame.name = std::move(name);
  frame.timestamp_s = timestamp_s;
  frame.image = image;
  frame.gray = ToGray(image);
  frame.pyramid = ImagePyramid(frame.gray, options.point_tracker.lucas_kanade.levels);
  frame.mask = SupportMask(ValidMask(image, mask, options.masks));
  frame.sharpness = Sharpness(frame.gray, frame.mask.valid());
  frame.prepare_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return frame;
}

}  // namespace pliant
