// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/image_fault.h"

#include <opencv2/core.hpp>

namespace pliant {

std::string Blankness(const cv::Mat& gray, const SupportMask& mask) {
  constexpr double kBlack = 8;         // gray levels, mean
  constexpr double kWhite = 247;       // gray levels, mean
  constexpr double kFeatureless = 2;   // gray levels, standard deviation: the noise of a sensor
  constexpr double kMinUsable = 0.01;  // of the pixels; where fewer are, there is no view to be found in the image
  cv::Scalar mean;
  cv::Scalar deviation;
  const cv::Mat& valid = mask.valid();
  const bool has_view = !valid.empty() && cv::countNonZero(valid) >= kMinUsable * static_cast<double>(gray.total());
  cv::meanStdDev(gray, mean, deviation, has_view ? valid : cv::Mat());
  if (mean[0] < kBlack) return "the image is black";
  if (mean[0] > kWhite) return "the image is white";
  if (deviation[0] < kFeatureless) return "the image is of one color";
  return {};
}

std::string ImageFault(const PreparedFrame& frame, const cv::Mat& previous_gray) {
  if (std::string blank = Blankness(frame.gray, frame.mask); !blank.empty()) return blank;
  if (previous_gray.size() == frame.gray.size() && cv::norm(frame.gray, previous_gray, cv::NORM_INF) == 0)
    return "the image is the same as the one before (frozen)";
  return {};
}

std::string WithFault(const std::string& note, const std::string& fault) {
  if (fault.empty() || note.empty()) return note + fault;
  return note + "; " + fault;
}

}  // namespace pliant
