// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/frame_checks.h"

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "datasets/image_file.h"
#include "pliant/base/statistics.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

constexpr double kMaxStep_s = 1000;        // of any camera
constexpr double kMicrosecondSteps = 1e6;  // larger ones are nanoseconds
constexpr double kMaxPriorStretch = 0.02;  // of the sides' ratio: sizes are rounded to multiples of a network's patches

// As in trajectory.txt, from which a run is read again.
std::string WrittenTime(double time_s) {
  constexpr int kDecimals = 6;
  std::string text;
  AppendFixed(&text, time_s, kDecimals);
  return text;
}

}  // namespace

double MedianStep(std::span<const double> times) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < times.size(); ++k) steps.push_back(times[k] - times[k - 1]);
  return Median(std::move(steps));
}

std::string_view UnitOfSteps(std::span<const double> times_s) {
  const double step_s = MedianStep(times_s);
  if (!(step_s > kMaxStep_s)) return "";
  return step_s < kMicrosecondSteps ? "microseconds" : "nanoseconds";
}

Status CheckFrameTimes(std::span<const double> times_s, const std::string& what) {
  for (std::size_t k = 0; k < times_s.size(); ++k) {
    if (!std::isfinite(times_s[k]) || (k > 0 && !(times_s[k] > times_s[k - 1])))
      return {ErrorCode::kInvalidArgument,
              what + " not finite, or not growing, at frame " + std::to_string(k) + "; give times that grow"};
  }
  for (std::size_t k = 1; k < times_s.size(); ++k) {
    if (WrittenTime(times_s[k]) == WrittenTime(times_s[k - 1]))
      return {ErrorCode::kInvalidArgument, what + " the same to a microsecond at the frames " + std::to_string(k - 1) +
                                               " and " + std::to_string(k) +
                                               ", and a run writes no more of them; give seconds"};
  }
  const std::string_view unit = UnitOfSteps(times_s);
  if (unit.empty()) return Status::Ok();
  return {ErrorCode::kInvalidArgument,
          what + " " + Digits(MedianStep(times_s), 0) + " apart, as " + std::string(unit) + " would be; give seconds"};
}

Status CheckDepthPriorSize(cv::Size prior, cv::Size images, const std::string& what) {
  const double stretch =
      static_cast<double>(prior.width) * images.height / (static_cast<double>(prior.height) * images.width);
  if (std::abs(stretch - 1.0) <= kMaxPriorStretch) return Status::Ok();
  return {ErrorCode::kMismatch, what + " is " + SizeText(prior.width, prior.height) + ", but the images are " +
                                    SizeText(images.width, images.height) + "; resize it to the sides of the images"};
}

}  // namespace pliant
