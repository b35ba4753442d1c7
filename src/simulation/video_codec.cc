// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/video_codec.h"

#include <cmath>
#include <cstdint>
#include <numbers>

#include <Eigen/Core>
#include <opencv2/imgproc.hpp>

namespace pliant::simulation {
namespace {

constexpr int kMacroblock = 16;  // luma pixels; 8 in chroma
constexpr int kTransform = 8;
constexpr int kReach_px = 24;  // of motions
using Block = Eigen::Matrix<double, kTransform, kTransform>;

// Orthonormal cosine transform: coefficients = T block T^t.
Block TransformMatrix() {
  Block transform;
  for (int k = 0; k < kTransform; ++k)
    for (int i = 0; i < kTransform; ++i)
      transform(k, i) =
          std::sqrt((k == 0 ? 1.0 : 2.0) / kTransform) * std::cos(std::numbers::pi * (i + 0.5) * k / kTransform);
  return transform;
}

double Quantized(double coefficient, double step, double rounding) {
  return std::copysign(step * std::floor(std::abs(coefficient) / step + rounding), coefficient);
}

// A block of the frame before, moved; what lies outside repeats the border.
cv::Mat Moved(const cv::Mat& plane, const cv::Rect& place, const cv::Point2f& motion) {
  cv::Mat block;
  const cv::Point2f center(static_cast<float>(place.x) + 0.5F * static_cast<float>(place.width - 1),
                           static_cast<float>(place.y) + 0.5F * static_cast<float>(place.height - 1));
  cv::getRectSubPix(plane, place.size(), center + motion, block);
  return block;
}

// `block` becomes the prediction and what is left of the difference to it.
void CodeDifference(const cv::Mat& block, const cv::Mat& prediction, double step, double rounding, cv::Mat decoded) {
  static const Block transform = TransformMatrix();
  for (int top = 0; top < block.rows; top += kTransform) {
    for (int left = 0; left < block.cols; left += kTransform) {
      Block difference;
      for (int y = 0; y < kTransform; ++y)
        for (int x = 0; x < kTransform; ++x)
          difference(y, x) = static_cast<double>(block.at<std::uint8_t>(top + y, left + x)) -
                             prediction.at<std::uint8_t>(top + y, left + x);
      Block coefficients = transform * difference * transform.transpose();
      for (double& c : coefficients.reshaped()) c = Quantized(c, step, rounding);
      difference = transform.transpose() * coefficients * transform;
      for (int y = 0; y < kTransform; ++y)
        for (int x = 0; x < kTransform; ++x)
          decoded.at<std::uint8_t>(top + y, left + x) =
              cv::saturate_cast<std::uint8_t>(prediction.at<std::uint8_t>(top + y, left + x) + difference(y, x));
    }
  }
}

// Y, Cr, Cb, the chroma at half the size; sizes are made multiples of a macroblock by repeating the border.
std::array<cv::Mat, 3> ToPlanes(const cv::Mat& image) {
  const auto missing = [](int side) { return (kMacroblock - side % kMacroblock) % kMacroblock; };
  cv::Mat whole;
  cv::copyMakeBorder(image, whole, 0, missing(image.rows), 0, missing(image.cols), cv::BORDER_REPLICATE);
  cv::cvtColor(whole, whole, cv::COLOR_BGR2YCrCb);
  std::array<cv::Mat, 3> planes;
  cv::split(whole, planes.data());
  for (int c = 1; c < 3; ++c) cv::resize(planes[c], planes[c], cv::Size(), 0.5, 0.5, cv::INTER_AREA);
  return planes;
}

cv::Mat ToImage(std::array<cv::Mat, 3> planes, const cv::Size& size) {
  for (int c = 1; c < 3; ++c) cv::resize(planes[c], planes[c], planes[0].size(), 0, 0, cv::INTER_LINEAR);
  cv::Mat image;
  cv::merge(planes.data(), 3, image);
  cv::cvtColor(image, image, cv::COLOR_YCrCb2BGR);
  return image(cv::Rect(cv::Point(), size)).clone();
}

}  // namespace

VideoCodec::VideoCodec(int qp, int key_frame_every)
    : step_(0.625 * std::pow(2.0, qp / 6.0)), key_frame_every_(key_frame_every) {}

// From the neighbor's motion or none, downhill in ever smaller steps. A motion unlike the neighbor's costs bits.
cv::Point2f VideoCodec::FindMotion(const cv::Mat& block, const cv::Point& corner, const cv::Point2f& neighbor) const {
  const cv::Rect place(corner, cv::Size(kMacroblock, kMacroblock));
  const auto cost = [&](const cv::Point2f& motion) {
    if (std::abs(motion.x) > kReach_px || std::abs(motion.y) > kReach_px) return HUGE_VAL;
    const cv::Point2f unlike = motion - neighbor;
    return cv::norm(block, Moved(previous_[0], place, motion), cv::NORM_L1) +
           step_ * std::log2(1.0 + std::abs(unlike.x) + std::abs(unlike.y));
  };
  cv::Point2f best = neighbor;
  double best_cost = cost(best);
  const auto take_if_better = [&](const cv::Point2f& motion) {
    const double new_cost = cost(motion);
    if (new_cost >= best_cost) return false;
    best = motion;
    best_cost = new_cost;
    return true;
  };
  take_if_better({0, 0});
  constexpr int kTries = 8;
  for (const float step_px : {4.0F, 2.0F, 1.0F, 0.5F}) {
    for (int i = 0; i < kTries; ++i) {
      const cv::Point2f from = best;
      bool better = false;
      for (const cv::Point2f& way : {cv::Point2f(1, 0), cv::Point2f(-1, 0), cv::Point2f(0, 1), cv::Point2f(0, -1)})
        better |= take_if_better(from + step_px * way);
      if (!better) break;
    }
  }
  return best;
}

void VideoCodec::CodeMacroblock(const Planes& planes, const cv::Point& corner, const cv::Point2f& motion,
                                Planes* decoded) const {
  const bool key = previous_[0].empty();
  for (std::size_t c = 0; c < planes.size(); ++c) {
    const int reduction = c == 0 ? 1 : 2;
    const int side = kMacroblock / reduction;
    const cv::Rect place(corner / reduction, cv::Size(side, side));
    const cv::Mat prediction = key ? cv::Mat(side, side, CV_8UC1, cv::Scalar(128))
                                   : Moved(previous_[c], place, motion * (1.0F / static_cast<float>(reduction)));
    CodeDifference(planes[c](place), prediction, step_, key ? 1.0 / 3 : 1.0 / 6, (*decoded)[c](place));
  }
}

cv::Mat VideoCodec::Decode(const cv::Mat& image) {
  if (frames_++ % key_frame_every_ == 0) previous_ = {};
  const Planes planes = ToPlanes(image);
  Planes decoded;
  for (std::size_t c = 0; c < planes.size(); ++c) decoded[c].create(planes[c].size(), CV_8UC1);
  for (int y = 0; y < planes[0].rows; y += kMacroblock) {
    cv::Point2f motion(0, 0);
    for (int x = 0; x < planes[0].cols; x += kMacroblock) {
      const cv::Mat block = planes[0](cv::Rect(x, y, kMacroblock, kMacroblock));
      if (!previous_[0].empty()) motion = FindMotion(block, {x, y}, motion);
      CodeMacroblock(planes, {x, y}, motion, &decoded);
    }
  }
  previous_ = decoded;
  return ToImage(decoded, image.size());
}

}  // namespace pliant::simulation
