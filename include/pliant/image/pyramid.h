// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Gray images in several sizes. Level 0 is the image; each further level is half as large, low-pass filtered with the
// 5-tap binomial kernel (Burt and Adelson, 1983) before every second pixel is taken. The pixel (x, y) of level 0 lies
// at (x, y) / 2^l on level l: centers of first pixels coincide. Every level is surrounded by kPadding pixels that
// repeat its border, so that a patch may reach over the edge without tests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace pliant {

class StateArchive;

// 8-bit gray of an 8-bit image with 1 (returned as it is, not copied) or 3 (BGR; ITU-R BT.601 weights) channels.
cv::Mat ToGray(const cv::Mat& image);

class ImagePyramid {
 public:
  static constexpr int kPadding = 32;
  static constexpr int kMinSide_px = 16;  // no level is smaller than this

  ImagePyramid() = default;  // empty
  // `gray`: CV_8UC1, not empty. `levels` >= 1; fewer are built when the next would be smaller than kMinSide_px.
  ImagePyramid(const cv::Mat& gray, int levels);

  bool empty() const { return padded_.empty(); }
  int levels() const { return static_cast<int>(padded_.size()); }
  int width(int level = 0) const { return padded_[static_cast<std::size_t>(level)].cols - 2 * kPadding; }
  int height(int level = 0) const { return padded_[static_cast<std::size_t>(level)].rows - 2 * kPadding; }
  // Pixel (0, 0) of a level and the distance of its rows in bytes; readable from -kPadding to size + kPadding - 1.
  const std::uint8_t* origin(int level) const {
    return padded_[static_cast<std::size_t>(level)].ptr<std::uint8_t>(kPadding) + kPadding;
  }
  std::ptrdiff_t stride(int level) const {
    return static_cast<std::ptrdiff_t>(padded_[static_cast<std::size_t>(level)].step[0]);
  }
  // A level without its padding; a view.
  cv::Mat Level(int level) const;
  void Serialize(StateArchive& archive);

 private:
  std::vector<cv::Mat> padded_;
};

// Bilinear value of an 8-bit or float image of one channel; nothing outside [0, width - 1] x [0, height - 1].
std::optional<double> SampleBilinear(const cv::Mat& image, double x, double y);

}  // namespace pliant
