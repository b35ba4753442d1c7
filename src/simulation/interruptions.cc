// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/interruptions.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/Core>
#include <opencv2/imgproc.hpp>
#include <tbb/parallel_for.h>

namespace pliant::simulation {
namespace {

// How much of an interruption has passed, 0 to 1; nothing while there is none.
std::optional<double> Age(double time_s, double period_s, double duration_s) {
  // Of the clock: a time that is a whole number of frames is not rounded to the frame before.
  constexpr double kRounding_s = 1e-6;
  if (!(period_s > 0) || time_s + kRounding_s < period_s) return std::nullopt;
  const double since_s = std::fmod(time_s + kRounding_s, period_s);
  if (since_s >= duration_s) return std::nullopt;
  return since_s / duration_s;
}

// A shaft of metal that comes in from the lower right, reaches over the middle, and goes back, swinging a little.
void CoverWithTool(double age, double gain, cv::Mat& light) {
  const double width = light.cols;
  const double radius_px = 0.06 * width;
  const double edge_px = 0.02 * radius_px + 1.0;
  const double in = std::sin(std::numbers::pi * age);
  const double angle_rad = 0.25 * std::numbers::pi + 0.25 * std::sin(2 * std::numbers::pi * age);
  const Eigen::Vector2d back(std::cos(angle_rad), std::sin(angle_rad));  // from the tip to the hand
  const Eigen::Vector2d corner(width + radius_px, light.rows + radius_px);
  const Eigen::Vector2d inmost(0.42 * width, 0.42 * light.rows);
  const Eigen::Vector2d tip = corner + in * (inmost - corner);
  tbb::parallel_for(0, light.rows, [&](int y) {
    auto* row = light.ptr<cv::Vec3f>(y);
    for (int x = 0; x < light.cols; ++x) {
      const Eigen::Vector2d from_tip = Eigen::Vector2d(x, y) - tip;
      const double along = from_tip.dot(back);
      const double across = back.x() * from_tip.y() - back.y() * from_tip.x();
      const double distance = along > 0 ? std::abs(across) : from_tip.norm();  // a round end
      const double weight = std::clamp((radius_px - distance) / edge_px, 0.0, 1.0);
      if (weight == 0) continue;
      // A cylinder under a light beside the camera, with a highlight along it.
      const double side = std::clamp(across / radius_px, -1.0, 1.0);
      const double facing = std::sqrt(1.0 - side * side);
      const double level = 0.05 + 0.3 * facing + 0.9 * std::exp(-std::pow((side - 0.2) / 0.12, 2));
      const auto value = static_cast<float>(level / gain);
      const auto share = static_cast<float>(weight);
      row[x] = (1.0F - share) * row[x] + share * cv::Vec3f(value, value, value);
    }
  });
}

}  // namespace

void Interrupt(const SimulationOptions& options, double gain, double time_s, cv::Mat* light) {
  const SimulationOptions::Interruption& interruption = options.interruption;
  if (const auto age = Age(time_s, interruption.tool_period_s, interruption.tool_s)) CoverWithTool(*age, gain, *light);
  if (Age(time_s, interruption.blur_period_s, interruption.blur_s) && interruption.blur_px > 0)
    cv::GaussianBlur(*light, *light, cv::Size(), interruption.blur_px, interruption.blur_px, cv::BORDER_REPLICATE);
  if (Age(time_s, interruption.blackout_period_s, interruption.blackout_s)) light->setTo(cv::Scalar::all(0));
}

}  // namespace pliant::simulation
