// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/centerline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "pliant/base/random.h"

namespace pliant::simulation {
namespace {
constexpr double kCenterlineStepMm = 0.5;
}  // namespace

Centerline::Centerline(double length_mm, double bend_deg_per_cm, int seed) {
  // Curvature: two incommensurable waves in each plane, so that no bend repeats.
  constexpr std::array kWavesMm = {310.0, 170.0};
  Random random = Random(static_cast<std::uint64_t>(seed)).Child("centreline");
  std::array<std::array<double, 2>, 2> phase;
  for (auto& plane : phase)
    for (double& p : plane) p = random.Uniform(0.0, 2.0 * std::numbers::pi);
  const double peak_rad_mm = bend_deg_per_cm / 10.0 * std::numbers::pi / 180.0;
  const auto bend = [&](int plane, double s) {
    double sum = 0;
    for (std::size_t i = 0; i < kWavesMm.size(); ++i)
      sum += 0.5 * std::sin(2.0 * std::numbers::pi * s / kWavesMm[i] + phase[plane][i]);
    return peak_rad_mm * sum;
  };

  const int count = static_cast<int>(std::ceil(length_mm / kCenterlineStepMm)) + 2;
  frames_.reserve(count);
  Rigid3 frame;
  for (int i = 0; i < count; ++i) {
    frames_.push_back(frame);
    const double middle = (i + 0.5) * kCenterlineStepMm;
    const Eigen::Vector3d omega(bend(0, middle) * kCenterlineStepMm, bend(1, middle) * kCenterlineStepMm, 0.0);
    // Half the turn, the step, half the turn: the polygon then follows the curve to second order.
    const Eigen::Quaterniond half = RotationExp(0.5 * omega);
    const Eigen::Quaterniond middle_rotation = frame.rotation * half;
    frame =
        Rigid3(middle_rotation * half, frame.translation + middle_rotation * Eigen::Vector3d(0, 0, kCenterlineStepMm));
  }
}

Rigid3 Centerline::WorldFromFrame(double s_mm) const {
  const double position = std::clamp(s_mm / kCenterlineStepMm, 0.0, static_cast<double>(frames_.size()) - 1.001);
  const auto i = static_cast<std::size_t>(position);
  return Interpolated(frames_[i], frames_[i + 1], position - static_cast<double>(i));
}

}  // namespace pliant::simulation
