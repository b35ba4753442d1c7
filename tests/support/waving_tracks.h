// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Tracks as the first map and those made again of it get them: pixels with noise, of a surface that waves.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "pliant/base/random.h"
#include "pliant/base/statistics.h"
#include "pliant/tracking/bootstrapping/initializer.h"
#include "pliant/tracking/bootstrapping/make_initializer.h"
#include "tracking/map_upkeep/reestimate_map.h"

namespace pliant::test {

inline constexpr double kNominalMm = 50;
inline constexpr double kShape = 0.03;  // relative depth error, median; a constant depth has about 0.15
inline constexpr double kNoisePx = 0.05;

// kStill and kRotation: nothing moves but the camera. kHeld: the camera alone does not.
enum class CameraPath { kForwards, kRotation, kStill, kHeld };

// Tracks on a wavy surface that waves. Points 100 and above come into view later.
struct WavingTracks {
  Camera camera = Camera::Create(CameraModelId::kSimplePinhole, 640, 480, std::array{450.0, 319.5, 239.5}).value();
  std::vector<InitFrame> frames;
  std::vector<Eigen::Vector3d> points;
  std::vector<Rigid3> poses;

  double amplitude_mm;

  explicit WavingTracks(int count, CameraPath motion = CameraPath::kForwards, double amplitude = 3, double relief = 15,
                        unsigned seed = 5)
      : amplitude_mm(amplitude) {
    const bool turns = motion == CameraPath::kForwards || motion == CameraPath::kRotation;
    const bool waves = motion == CameraPath::kForwards || motion == CameraPath::kHeld;
    Random random(seed);
    for (int i = 0; i < 160; ++i) {
      const double x = random.Uniform(-30, 30);
      const double y = random.Uniform(-22, 22);
      points.emplace_back(x, y, 60 + relief * std::sin(x / 14) * std::cos(y / 18));
    }
    for (int t = 0; t < count; ++t) {
      const double turn = turns ? 1 : 0;
      poses.emplace_back(RotationExp(turn * Eigen::Vector3d(0.02 * std::sin(0.05 * t), 0.002 * t, 0)),
                         motion == CameraPath::kForwards ? Eigen::Vector3d(0.5 * std::sin(0.06 * t), 0, -0.5 * t)
                                                         : Eigen::Vector3d::Zero());
      InitFrame frame{100 + t, {}};
      for (int i = 0; i < 160; ++i) {
        if (i >= 100 && t < 10) continue;
        const Eigen::Vector3d x = poses.back() * At(i, waves ? t : 0);
        const auto pixel = camera.Project(x);
        if (!pixel || !camera.Contains(*pixel)) continue;
        InitObservation seen{PointId{i}, *pixel + kNoisePx * Eigen::Vector2d(random.Normal(), random.Normal())};
        seen.brightness = 255 * std::pow(30 / x.norm(), 2 / 2.2) * std::exp(random.Normal(0.1));
        frame.observations.push_back(seen);
      }
      frames.push_back(frame);
    }
  }

  Eigen::Vector3d At(int point, int t) const {
    const Eigen::Vector3d& rest = points[static_cast<std::size_t>(point)];
    const double phase = 0.02 * rest.sum();
    return rest + Eigen::Vector3d(0, amplitude_mm * (std::sin(0.12 * t + phase) - std::sin(phase)), 0);
  }

  InitOutcome Try(const WindowInitOptions& options, InitMoment moment = InitMoment::kMoreFollow) const {
    return MakeWindowInitializer(options, kNominalMm)->Try({camera, frames, {}, moment});
  }

  InitOutcome Reestimate(WindowScene scene, bool of_provisional = false, const WindowInitOptions& options = {}) const {
    return ReestimateMap({camera, frames, {}}, scene, of_provisional, options, kNominalMm);
  }

  // Median relative depth error of a frame's positions, after the best scale.
  double ShapeError(const InitOutcome& outcome, int t) const {
    const InitFrameState& state = outcome.frames[static_cast<std::size_t>(t)];
    std::vector<double> ratios;
    for (const InitPosition& point : state.positions)
      ratios.push_back((state.cam_from_world * point.position).norm() /
                       (poses[static_cast<std::size_t>(t)] * At(static_cast<int>(point.id.value), t)).norm());
    const double scale = Median(ratios);
    for (double& ratio : ratios) ratio = std::abs(ratio / scale - 1);
    return Median(ratios);
  }
};

}  // namespace pliant::test
