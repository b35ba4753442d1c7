// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/pyramid.h"

#include <cassert>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace pliant {
namespace {

constexpr int kPad = ImagePyramid::kPadding;

cv::Mat Inner(const cv::Mat& padded) {
  return padded(cv::Rect(kPad, kPad, padded.cols - 2 * kPad, padded.rows - 2 * kPad));
}

void RepeatBorder(cv::Mat* padded) {
  cv::copyMakeBorder(Inner(*padded), *padded, kPad, kPad, kPad, kPad, cv::BORDER_REPLICATE | cv::BORDER_ISOLATED);
}

}  // namespace

cv::Mat ToGray(const cv::Mat& image) {
  assert(image.depth() == CV_8U && (image.channels() == 1 || image.channels() == 3));
  if (image.channels() == 1) return image;
  cv::Mat gray;
  cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  return gray;
}

ImagePyramid::ImagePyramid(const cv::Mat& gray, int levels) {
  assert(gray.type() == CV_8UC1 && !gray.empty() && levels >= 1);
  padded_.emplace_back(gray.rows + 2 * kPad, gray.cols + 2 * kPad, CV_8UC1);
  cv::copyMakeBorder(gray, padded_.back(), kPad, kPad, kPad, kPad, cv::BORDER_REPLICATE | cv::BORDER_ISOLATED);
  for (int level = 1; level < levels; ++level) {
    const cv::Mat finer = Inner(padded_.back());
    const cv::Size size((finer.cols + 1) / 2, (finer.rows + 1) / 2);
    if (size.width < kMinSide_px || size.height < kMinSide_px) break;
    cv::Mat padded(size.height + 2 * kPad, size.width + 2 * kPad, CV_8UC1);
    cv::Mat inner = Inner(padded);
    cv::pyrDown(finer, inner, size, cv::BORDER_REFLECT_101);
    RepeatBorder(&padded);
    padded_.push_back(padded);
  }
}

cv::Mat ImagePyramid::Level(int level) const { return Inner(padded_[static_cast<std::size_t>(level)]); }

std::optional<double> SampleBilinear(const cv::Mat& image, double x, double y) {
  assert(image.type() == CV_8UC1 || image.type() == CV_32FC1);
  if (!(x >= 0 && y >= 0 && x <= image.cols - 1 && y <= image.rows - 1)) return std::nullopt;
  const int x0 = std::min(static_cast<int>(x), std::max(image.cols - 2, 0));
  const int y0 = std::min(static_cast<int>(y), std::max(image.rows - 2, 0));
  const int x1 = std::min(x0 + 1, image.cols - 1);
  const int y1 = std::min(y0 + 1, image.rows - 1);
  const auto at = [&](int row, int col) {
    return image.depth() == CV_8U ? static_cast<double>(image.at<std::uint8_t>(row, col))
                                  : static_cast<double>(image.at<float>(row, col));
  };
  const double fx = x - x0;
  const double fy = y - y0;
  return (1 - fy) * ((1 - fx) * at(y0, x0) + fx * at(y0, x1)) + fy * ((1 - fx) * at(y1, x0) + fx * at(y1, x1));
}

}  // namespace pliant
