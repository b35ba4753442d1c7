// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "surface/depth_holes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace pliant {
namespace {

constexpr float kContourSigmas = 3.0F;
constexpr double kMaxSlant = 6.0;      // tangent of the angle between a ray and the surface's normal
constexpr int kSpeckleShare = 3000;    // a connected piece has at least this part of the image's pixels
constexpr double kSpeckleStep = 0.02;  // of neighboring depths, relative
constexpr std::int16_t kNone = std::numeric_limits<std::int16_t>::min();

}  // namespace

double LargestStepOfASurface(double focal_length_px) { return kMaxSlant / focal_length_px; }

cv::Mat NearContours(const cv::Mat& inverse_distance, const cv::Mat& sigmas, double focal_length_px, int window_px) {
  const auto slant = static_cast<float>(LargestStepOfASurface(focal_length_px));
  cv::Mat step(inverse_distance.size(), CV_8U, cv::Scalar(0));
  for (int y = 1; y < step.rows; ++y)
    for (int x = 1; x < step.cols; ++x) {
      const float here = inverse_distance.at<float>(y, x);
      const float left = inverse_distance.at<float>(y, x - 1);
      const float above = inverse_distance.at<float>(y - 1, x);
      const float largest = slant + kContourSigmas * sigmas.at<float>(y, x);
      if (std::abs(here - left) > largest * here || std::abs(here - above) > largest * here)
        step.at<std::uint8_t>(y, x) = 255;
    }
  cv::dilate(step, step, cv::getStructuringElement(cv::MORPH_ELLIPSE, {window_px, window_px}));
  return step;
}

void RemoveSpeckles(cv::Mat* depth) {
  constexpr double kUnit = 1000.0;  // of a logarithm, in 16 bits
  cv::Mat known = *depth > 0.0F;
  const int count = cv::countNonZero(known);
  if (count == 0) return;
  const double mean = cv::mean(*depth, known)[0];
  cv::Mat logs(depth->size(), CV_16S, cv::Scalar(kNone));
  for (int y = 0; y < depth->rows; ++y)
    for (int x = 0; x < depth->cols; ++x)
      if (const float d = depth->at<float>(y, x); d > 0.0F)
        logs.at<std::int16_t>(y, x) =
            static_cast<std::int16_t>(std::clamp(kUnit * std::log(d / mean), -32000.0, 32000.0));
  cv::filterSpeckles(logs, kNone, static_cast<int>(depth->total()) / kSpeckleShare, kSpeckleStep * kUnit);
  depth->setTo(0.0F, logs == kNone);
}

cv::Mat Enlarged(const cv::Mat& values, cv::Size size) {
  if (values.size() == size) return values;
  cv::Mat large;
  cv::Mat large_known;
  cv::resize(values, large, size, 0, 0, cv::INTER_LINEAR);
  const cv::Mat known = values > 0.0F;
  cv::resize(known, large_known, size, 0, 0, cv::INTER_LINEAR);
  large.setTo(0.0F, large_known < 255);
  return large;
}

}  // namespace pliant
