// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/working_image.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "pliant/image/interlacing.h"

namespace pliant {

cv::Size WorkingImage::SizeOf(const cv::Size& source) const {
  return {std::max(1, static_cast<int>(std::lround(scale * source.width))),
          std::max(1, static_cast<int>(std::lround(scale * source.height)))};
}

Eigen::Vector2d WorkingImage::ToWorking(const Eigen::Vector2d& source_pixel) const {
  return scale * (source_pixel.array() + 0.5) - 0.5;
}

Eigen::Vector2d WorkingImage::ToSource(const Eigen::Vector2d& working_pixel) const {
  return (working_pixel.array() + 0.5) / scale - 0.5;
}

cv::Mat WorkingImage::Image(const cv::Mat& source) const {
  if (IsSource()) return source;
  // Never into the source's own memory: its owner may need it again.
  cv::Mat image = interlaced ? WithoutOddRows(source) : source;
  if (scale < 1) {
    const double sigma = 0.5 * std::sqrt(1 / (scale * scale) - 1);  // what the smaller image cannot hold
    cv::Mat without_aliases;
    cv::GaussianBlur(image, without_aliases, {}, sigma, sigma, cv::BORDER_REPLICATE);
    image = without_aliases;
  }
  if (scale != 1) image = Resampled(image, cv::INTER_LINEAR);
  if (smoothing_px > 0) {
    cv::Mat smooth;
    cv::GaussianBlur(image, smooth, {}, smoothing_px, smoothing_px, cv::BORDER_REPLICATE);
    image = smooth;
  }
  return image;
}

cv::Mat WorkingImage::Nearest(const cv::Mat& source) const {
  return source.empty() || scale == 1 ? source : Resampled(source, cv::INTER_NEAREST);
}

// cv::resize would divide the rounded sizes instead, and positions be off by up to half a pixel at the far border.
cv::Mat WorkingImage::Resampled(const cv::Mat& source, int interpolation) const {
  const double shift = 0.5 / scale - 0.5;
  const cv::Mat source_from_working = (cv::Mat_<double>(2, 3) << 1 / scale, 0, shift, 0, 1 / scale, shift);
  cv::Mat resampled;
  cv::warpAffine(source, resampled, source_from_working, SizeOf(source.size()), interpolation | cv::WARP_INVERSE_MAP,
                 cv::BORDER_REPLICATE);
  return resampled;
}

}  // namespace pliant
