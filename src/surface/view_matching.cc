// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "surface/view_matching.h"

#include <cmath>

#include <opencv2/imgproc.hpp>

#include "pliant/image/pyramid.h"

namespace pliant {
namespace {

constexpr double kFillSigmaPx = 6.0;
constexpr float kFarOutside = -1e4F;

// Highlights would be compared with highlights: they are painted over with what is around them.
void FillInvalid(const cv::Mat& valid, cv::Mat* intensity) {
  if (cv::countNonZero(valid) == static_cast<int>(valid.total())) return;
  cv::Mat weight;
  valid.convertTo(weight, CV_32F, 1.0 / 255.0);
  cv::Mat sum = intensity->mul(weight);
  const cv::Scalar mean = cv::mean(*intensity, valid);
  cv::GaussianBlur(sum, sum, {}, kFillSigmaPx, kFillSigmaPx, cv::BORDER_REPLICATE);
  cv::GaussianBlur(weight, weight, {}, kFillSigmaPx, kFillSigmaPx, cv::BORDER_REPLICATE);
  for (int y = 0; y < valid.rows; ++y) {
    const auto* is_valid = valid.ptr<std::uint8_t>(y);
    auto* value = intensity->ptr<float>(y);
    for (int x = 0; x < valid.cols; ++x) {
      if (is_valid[x] != 0) continue;
      const float w = weight.at<float>(y, x);
      value[x] = w > 1e-3F ? sum.at<float>(y, x) / w : static_cast<float>(mean[0]);
    }
  }
}

template <class Model>
void ProjectRow(const Model& model, const float* a, const float* b, const float* rho, int count, float* pixel) {
  for (int x = 0; x < count; ++x, a += 3, b += 3, pixel += 2) {
    const double point[3] = {a[0] + rho[x] * b[0], a[1] + rho[x] * b[1], a[2] + rho[x] * b[2]};
    double projected[2];
    const bool seen = rho[x] > 0.0F && model.Project(point, projected);
    pixel[0] = seen ? static_cast<float>(projected[0]) : kFarOutside;
    pixel[1] = seen ? static_cast<float>(projected[1]) : kFarOutside;
  }
}

bool IsSeen(const MatchingImage& image, const float* pixel) {
  const auto x = static_cast<int>(std::lround(pixel[0]));
  const auto y = static_cast<int>(std::lround(pixel[1]));
  return x >= 0 && y >= 0 && x < image.valid.cols && y < image.valid.rows && image.valid.at<std::uint8_t>(y, x) != 0;
}

cv::Mat WindowMean(const cv::Mat& values, int window_px) {
  cv::Mat mean;
  cv::boxFilter(values, mean, CV_32F, {window_px, window_px}, {-1, -1}, true, cv::BORDER_REPLICATE);
  return mean;
}

}  // namespace

MatchingImage MakeMatchingImage(const cv::Mat& image, const cv::Mat& valid, cv::Size size, double smoothing_px) {
  MatchingImage result;
  cv::Mat gray = ToGray(image);
  result.valid = valid;
  if (gray.size() != size) {
    cv::resize(gray, gray, size, 0, 0, cv::INTER_AREA);
    cv::resize(valid, result.valid, size, 0, 0, cv::INTER_AREA);
    result.valid = result.valid == 255;
  }
  gray.convertTo(result.intensity, CV_32F);
  FillInvalid(result.valid, &result.intensity);
  if (smoothing_px > 0.0)
    cv::GaussianBlur(result.intensity, result.intensity, {}, smoothing_px, smoothing_px, cv::BORDER_REPLICATE);
  return result;
}

ReferenceWindows MakeReferenceWindows(const MatchingImage& image, int window_px, double noise_variance) {
  ReferenceWindows windows{image, window_px, noise_variance, WindowMean(image.intensity, window_px), {}};
  windows.variance = WindowMean(image.intensity.mul(image.intensity), window_px) - windows.mean.mul(windows.mean);
  return windows;
}

cv::Mat ProjectInto(const MatchingView& view, const Camera& camera, const cv::Mat& inverse_distance) {
  cv::Mat map(inverse_distance.size(), CV_32FC2);
  camera.Visit([&](const auto& model) {
    for (int y = 0; y < map.rows; ++y)
      ProjectRow(model, view.at_infinity.ptr<float>(y), view.by_inverse_distance.ptr<float>(y),
                 inverse_distance.ptr<float>(y), map.cols, map.ptr<float>(y));
  });
  return map;
}

cv::Mat Correlation(const ReferenceWindows& reference, const MatchingView& view, const Camera& camera,
                    const cv::Mat& inverse_distance) {
  const cv::Mat map = ProjectInto(view, camera, inverse_distance);
  cv::Mat warped;
  cv::remap(view.image.intensity, warped, map, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  const cv::Mat mean = WindowMean(warped, reference.window_px);
  const cv::Mat square = WindowMean(warped.mul(warped), reference.window_px);
  const cv::Mat product = WindowMean(warped.mul(reference.image.intensity), reference.window_px);
  const float damping = kDampingByNoise * static_cast<float>(reference.noise_variance);
  cv::Mat correlation(map.size(), CV_32F);
  for (int y = 0; y < map.rows; ++y) {
    const auto* pixel = map.ptr<float>(y);
    const auto* valid = reference.image.valid.ptr<std::uint8_t>(y);
    const auto* m = mean.ptr<float>(y);
    const auto* s = square.ptr<float>(y);
    const auto* p = product.ptr<float>(y);
    const auto* reference_mean = reference.mean.ptr<float>(y);
    const auto* reference_variance = reference.variance.ptr<float>(y);
    auto* out = correlation.ptr<float>(y);
    for (int x = 0; x < map.cols; ++x) {
      const float variances = (reference_variance[x] + damping) * (s[x] - m[x] * m[x] + damping);
      out[x] = valid[x] != 0 && variances > 0.0F && IsSeen(view.image, pixel + 2 * x)
                   ? (p[x] - m[x] * reference_mean[x]) / std::sqrt(variances)
                   : kNotSeen;
    }
  }
  return correlation;
}

}  // namespace pliant
