// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "refinement/residual_correlation.h"

#include <cmath>

#include <gtest/gtest.h>

#include "refinement/recorded_scene.h"

namespace pliant {
namespace {

using refinement_test::RecordedScene;

constexpr double kMaxOfNoise = 0.05;  // of some thousand errors
constexpr double kMinOfMotion = 0.8;

TEST(ResidualCorrelation, OfNoiseIsNone) {
  const Recording recording = RecordedScene(0).Start();
  Random random(5);
  std::vector<Eigen::Vector2d> errors;
  for (std::size_t o = 0; o < recording.observations.size(); ++o) errors.emplace_back(random.Normal(), random.Normal());
  const std::vector<bool> used(errors.size(), true);
  const NeighborCorrelation correlation = ResidualCorrelation(recording, used, errors, recording.patch_px);
  EXPECT_LT(std::abs(correlation.value), kMaxOfNoise);
  EXPECT_LT(std::abs(correlation.value), 4 * correlation.standard_error);
  EXPECT_LT(correlation.standard_error, 0.5 * kMaxOfNoise);
}

TEST(ResidualCorrelation, OfACommonMotionIsNearOne) {
  const Recording recording = RecordedScene(0).Start();
  std::vector<Eigen::Vector2d> errors;
  for (const RecordedObservation& o : recording.observations)
    errors.emplace_back(std::sin(0.01 * o.pixel.x()), std::cos(0.01 * o.pixel.y()));
  const std::vector<bool> used(errors.size(), true);
  EXPECT_GT(ResidualCorrelation(recording, used, errors, recording.patch_px).value, kMinOfMotion);
  EXPECT_EQ(ResidualCorrelation(recording, std::vector<bool>(errors.size(), false), errors, recording.patch_px).value,
            0.0);
}

// Of a long recording few views are solved for: all of these count, wherever they lie.
TEST(ResidualCorrelation, IsOfTheViewsThatAreUsed) {
  RecordedScene scene(0);
  scene.views = 400;
  scene.poses.assign(400, scene.poses.front());
  const Recording recording = scene.Start();
  std::vector<Eigen::Vector2d> errors;
  std::vector<bool> used;
  std::vector<bool> used_twice_as_often;
  for (const RecordedObservation& o : recording.observations) {
    errors.emplace_back(o.view_idx % 40 == 0 ? Eigen::Vector2d(1, 0) : Eigen::Vector2d(0, 1));
    used.push_back(o.view_idx % 20 == 0);
    used_twice_as_often.push_back(o.view_idx % 10 == 0);
  }
  const NeighborCorrelation of_20 = ResidualCorrelation(recording, used, errors, recording.patch_px);
  const NeighborCorrelation of_40 = ResidualCorrelation(recording, used_twice_as_often, errors, recording.patch_px);
  EXPECT_GT(of_20.value, kMinOfMotion);
  EXPECT_NEAR(of_20.standard_error / of_40.standard_error, std::sqrt(2.0), 0.01);
}

}  // namespace
}  // namespace pliant
