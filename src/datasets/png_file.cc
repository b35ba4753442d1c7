// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/png_file.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "pliant/base/files.h"
#include "pliant/datasets/native_layout.h"

namespace pliant {

// Little compression: noise does not compress.
Status WritePng(const std::filesystem::path& path, const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1})) return Unwritable(path);
  return WriteFileAtomically(path.string(), {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

cv::Mat QuantizeDepth(const cv::Mat& depth, double scale) {
  cv::Mat steps(depth.size(), CV_16UC1);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const double value = std::round(depth.at<float>(y, x) / scale);
      steps.at<std::uint16_t>(y, x) =
          value >= 1 && value <= native::kMaxDepthSteps ? static_cast<std::uint16_t>(value) : 0;
    }
  }
  return steps;
}

}  // namespace pliant
