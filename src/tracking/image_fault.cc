// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/image_fault.h"

#include <opencv2/core.hpp>

namespace pliant {

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

std::string ImageFault(const PreparedFrame& frame, const PreparedFrame& previous) {
  if (std::string blank = Blankness(frame.gray); !blank.empty()) return blank;
  if (previous.gray.size() == frame.gray.size() && cv::norm(frame.gray, previous.gray, cv::NORM_INF) == 0)
    return "the image is the same as the one before (frozen)";
  return {};
}

std::string WithFault(const std::string& note, const std::string& fault) {
  if (fault.empty() || note.empty()) return note + fault;
  return note + "; " + fault;
}

}  // namespace pliant
