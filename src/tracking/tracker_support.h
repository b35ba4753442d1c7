// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the tracker's two sources share: timing of stages, and what may be wrong with an image.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/scene/frame_report.h"
#include "pliant/tracking/tracker.h"

namespace pliant {

// Adds the time until its end to one of the report's stages.
class StageTimer {
 public:
  StageTimer(FrameReport* report, std::string_view stage);
  ~StageTimer();
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  std::chrono::steady_clock::time_point start_;
  double* ms_ = nullptr;
};

// That an image shows nothing: it is black, white, or of one color; empty where it shows something.
std::string Blankness(const cv::Mat& gray);

// What is wrong with an image in which nothing can be followed; empty when nothing is.
std::string ImageFault(const TrackerFrame& frame, const TrackerFrame& previous);

// The color (R, G, B) of the nearest pixel of an 8-bit image with 1 or 3 (BGR) channels.
std::array<std::uint8_t, 3> ColorAt(const cv::Mat& image, const Eigen::Vector2d& pixel);

// "note; fault", or the one that is not empty.
std::string WithFault(const std::string& note, const std::string& fault);

}  // namespace pliant
