// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "support/synthetic_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "pliant/estimation/window/deforming_window.h"
#include "support/synthetic_frames.h"

namespace pliant::test {
namespace {

constexpr double kRounding = 1e-9;
// Of a normal by central differences.
constexpr double kDifferences = 1e-6;

TEST(SyntheticScene, TheWaveIsThatOfTheSimulatorAndAtRestInTheReference) {
  const SceneWave wave{.amplitude_mm = 3.0, .wavelength_mm = 150.0, .omega_rad_s = 2.0, .seconds = 0.7};
  const SceneOptions options{.motion = Motion::kStill, .num_points = 50, .num_frames = 3, .wave = wave};
  const Scene scene = MakeScene(options);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<Eigen::Vector3d> rays = RaysOf(scene, options, k);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Eigen::Vector3d& rest = scene.points[i];
      const double phase = 2.0 * std::numbers::pi * (rest.x() + rest.y() + rest.z()) / 150.0;
      const double t = 0.35 * static_cast<double>(k);
      const Eigen::Vector3d moved =
          rest + 3.0 * (std::sin(2.0 * t + phase) - std::sin(phase)) * Eigen::Vector3d::UnitY();
      EXPECT_LT((rays[i] - moved.normalized()).norm(), kRounding);
    }
  }
}

TEST(SyntheticScene, AWholePeriodOfTheWaveLeavesEverythingWhereItWas) {
  SceneOptions options{.num_points = 50, .num_frames = 2, .wave = {.amplitude_mm = 5.0, .omega_rad_s = 4.0}};
  options.wave.seconds = 2.0 * std::numbers::pi / 4.0;
  const Scene after = MakeScene(options);
  options.wave = {};
  const Scene rigid = MakeScene(options);
  for (std::size_t i = 0; i < rigid.points.size(); ++i)
    EXPECT_LT((after.pixels[1][i] - rigid.pixels[1][i]).norm(), 1e3 * kRounding);
}

TEST(SyntheticScene, ABaselineCanBeGivenInsteadOfAParallax) {
  for (const Motion motion : {Motion::kForward, Motion::kSideways, Motion::kRotation, Motion::kStill}) {
    const bool moves = motion == Motion::kForward || motion == Motion::kSideways;
    const Scene scene = MakeScene({.motion = motion, .num_points = 10, .baseline_mm = 18.0});
    EXPECT_NEAR(scene.cams_from_world.back().OriginInSource().norm(), moves ? 18.0 : 0.0, kRounding);
  }
}

TEST(SyntheticScene, BrightnessSpeaksOfDistanceAndSlope) {
  const SceneOptions facing{.surface = Surface::kBlob, .motion = Motion::kStill, .num_points = 50, .num_frames = 2};
  const Scene scene = MakeScene(facing);
  for (std::size_t i = 0; i < scene.points.size(); ++i)
    EXPECT_NEAR(LogDistanceFromLight({}, scene.brightness[1][i], scene.points[i]),
                std::log(scene.points[i].norm() / 10.0), kRounding);

  const SceneOptions tilted{.surface = Surface::kPlane, .motion = Motion::kStill, .num_points = 50, .num_frames = 1};
  const Scene plane = MakeScene(tilted);
  const double tilt = 20.0 * std::numbers::pi / 180.0;
  for (std::size_t i = 0; i < plane.points.size(); ++i) {
    const double cosine = Eigen::Vector3d(0.0, std::sin(tilt), std::cos(tilt)).dot(plane.points[i].normalized());
    EXPECT_NEAR(LogDistanceFromLight({}, plane.brightness[0][i], plane.points[i]),
                std::log(plane.points[i].norm() / 10.0) - 0.5 * std::log(cosine), kDifferences);
  }
}

TEST(SyntheticFrames, APointThatLeavesTheViewIsLostFromThenOn) {
  // The camera goes in by 40 mm, past the near part of the wall.
  const SceneOptions options{.num_points = 200, .num_frames = 9, .baseline_mm = 40.0};
  const Scene scene = MakeScene(options);
  EXPECT_TRUE(std::any_of(scene.pixels.back().begin(), scene.pixels.back().end(),
                          [](const Eigen::Vector2d& pixel) { return std::isnan(pixel.x()); }));
  const auto frames = FramesOf(scene, options, 5);
  ASSERT_EQ(frames.size(), 9U);
  EXPECT_EQ(frames.front().observations.size(), 200U);
  EXPECT_EQ(frames.back().frame_idx, 13);
  for (std::size_t k = 1; k < frames.size(); ++k) {
    EXPECT_LE(frames[k].observations.size(), frames[k - 1].observations.size());
    for (const InitObservation& seen : frames[k].observations)
      EXPECT_GT((scene.cams_from_world[k] * scene.points[static_cast<std::size_t>(seen.id.value)]).z(), 0.0);
  }
}

}  // namespace
}  // namespace pliant::test
