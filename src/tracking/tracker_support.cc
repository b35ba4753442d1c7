// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/tracker_support.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <opencv2/core.hpp>

namespace pliant {

StageTimer::StageTimer(FrameReport* report, std::string_view stage) : start_(std::chrono::steady_clock::now()) {
  for (auto& [name, ms] : report->stage_ms)
    if (name == stage) ms_ = &ms;
  assert(ms_ != nullptr);
}

StageTimer::~StageTimer() {
  *ms_ += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
}

std::string Blankness(const cv::Mat& gray) {
  constexpr double kBlack = 8;        // gray levels, mean
  constexpr double kWhite = 247;      // gray levels, mean
  constexpr double kFeatureless = 2;  // gray levels, standard deviation: the noise of a sensor
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(gray, mean, deviation);
  if (mean[0] < kBlack) return "the image is black";
  if (mean[0] > kWhite) return "the image is white";
  if (deviation[0] < kFeatureless) return "the image is of one color";
  return {};
}

std::string ImageFault(const TrackerFrame& frame, const TrackerFrame& previous) {
  if (const std::string blank = Blankness(frame.gray); !blank.empty()) return blank;
  if (previous.gray.size() == frame.gray.size() && cv::norm(frame.gray, previous.gray, cv::NORM_INF) == 0)
    return "the image is the same as the one before (frozen)";
  return {};
}

std::array<std::uint8_t, 3> ColorAt(const cv::Mat& image, const Eigen::Vector2d& pixel) {
  const cv::Point nearest(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
  if (image.channels() == 3) {
    const auto& bgr = image.at<cv::Vec3b>(nearest);
    return {bgr[2], bgr[1], bgr[0]};
  }
  const auto gray = image.at<std::uint8_t>(nearest);
  return {gray, gray, gray};
}

std::string WithFault(const std::string& note, const std::string& fault) {
  if (fault.empty() || note.empty()) return note + fault;
  return note + "; " + fault;
}

}  // namespace pliant
