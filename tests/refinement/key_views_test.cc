// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "refinement/key_views.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "refinement/recorded_scene.h"

namespace pliant {
namespace {

using refinement_test::RecordedScene;

std::vector<bool> All(const Recording& recording) { return std::vector<bool>(recording.observations.size(), true); }

BundleState StateOf(const Recording& recording) {
  BundleState state;
  state.cams_from_world = recording.cams_from_world;
  state.rest_positions = recording.rest_positions;
  return state;
}

TEST(KeyViews, LeaveTheMedianTrackSoManyViews) {
  const Recording recording = RecordedScene().Start();
  for (const int views_per_track : {5, 10}) {
    const int stride = StrideOfKeyViews(recording, All(recording), views_per_track);
    const std::vector<bool> used = UsedInKeyViews(recording, All(recording), stride);
    const std::vector<int> views = CountViews(recording, used);
    std::vector<double> of_track;
    for (const RecordedObservation& o : recording.observations)
      of_track.push_back(views[static_cast<std::size_t>(o.point_idx)]);
    EXPECT_NEAR(Median(of_track), views_per_track, 0.35 * views_per_track);
  }
  EXPECT_EQ(StrideOfKeyViews(recording, All(recording), 1000), 1);
}

TEST(KeyViews, HaveNoPointThatFewOfThemSee) {
  const Recording recording = RecordedScene().Start();
  const std::vector<bool> used = UsedInKeyViews(recording, All(recording), 4);
  const std::vector<int> views = CountViews(recording, used);
  EXPECT_GT(std::ranges::count(used, true), 0);
  for (std::size_t o = 0; o < used.size(); ++o) {
    if (!used[o]) continue;
    EXPECT_EQ(recording.observations[o].view_idx % 4, 0);
    EXPECT_GE(views[static_cast<std::size_t>(recording.observations[o].point_idx)], 3);
  }
}

TEST(KeyViews, HaveNoViewThatSeesFewPoints) {
  Recording recording = RecordedScene().Start();
  int left = 0;
  std::erase_if(recording.observations, [&](const RecordedObservation& o) { return o.view_idx == 20 && ++left > 3; });
  std::vector<bool> used = All(recording);
  KeepDetermined(recording, &used);
  EXPECT_GT(std::ranges::count(used, true), std::ssize(used) / 2);
  for (std::size_t o = 0; o < used.size(); ++o) EXPECT_FALSE(used[o] && recording.observations[o].view_idx == 20);
}

// A solution in another world: each pose is that of the recording in it, so what is between key views is known.
TEST(KeyViews, TakeTheOthersAlongIntoTheirWorld) {
  const Recording recording = RecordedScene().Start();
  const Rigid3 change(RotationExp(Eigen::Vector3d(0.1, -0.2, 0.05)), Eigen::Vector3d(3, -2, 1));
  BundleState state = StateOf(recording);
  for (std::size_t v = 0; v < recording.times.size(); v += 4)
    state.cams_from_world[v] = recording.cams_from_world[v] * change;
  InterpolateViews(recording, UsedInKeyViews(recording, All(recording), 4), &state);
  for (std::size_t v = 0; v < recording.times.size(); ++v) {
    const Rigid3 error = state.cams_from_world[v] * (recording.cams_from_world[v] * change).Inverse();
    EXPECT_LT(error.translation.norm(), 1e-9) << v;
    EXPECT_LT(RotationAngle(error.rotation), 1e-7) << v;
  }
}

TEST(KeyViews, SayHowTheSceneMovesBetweenThemByTime) {
  Recording recording = RecordedScene().Start();
  for (double& time : recording.times) time *= time;  // unevenly
  BundleState state = StateOf(recording);
  state.coefficients.setZero(1, static_cast<Eigen::Index>(recording.times.size()));
  for (std::size_t v = 0; v < recording.times.size(); v += 4)
    state.coefficients(0, static_cast<Eigen::Index>(v)) = 2.0 * recording.times[v];
  InterpolateViews(recording, UsedInKeyViews(recording, All(recording), 4), &state);
  const std::size_t last_key = (recording.times.size() - 1) / 4 * 4;
  for (std::size_t v = 0; v < recording.times.size(); ++v)
    EXPECT_NEAR(state.coefficients(0, static_cast<Eigen::Index>(v)), 2.0 * recording.times[std::min(v, last_key)],
                1e-9);
}

}  // namespace
}  // namespace pliant
