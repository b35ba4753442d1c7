// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/align_runs.h"

#include <gtest/gtest.h>

#include "support/tolerances.h"

namespace pliant {
namespace {

constexpr double kTurned_mm = 1e-6;  // a rotation that is right to round-off, at the arm of the path

const Sim3 kWorld = {
    2.5, Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized())), {10, -20, 30}};

// The same poses in the world that kWorld leads to.
FramePoses Moved(const FramePoses& poses) {
  FramePoses moved;
  for (const auto& [frame_idx, pose] : poses) moved.emplace(frame_idx, PoseInWorld(kWorld, pose.Inverse()).Inverse());
  return moved;
}

void ExpectIsWorld(const std::optional<Sim3>& found, double scale = kWorld.scale) {
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->scale, scale, kLengthRoundOff_mm);
  EXPECT_LT(found->rotation.angularDistance(kWorld.rotation), kAngleRoundOff_rad);
  if (scale == kWorld.scale) {
    EXPECT_LT((found->translation - kWorld.translation).norm(), kTurned_mm);
  }
}

TEST(AlignWorlds, FindsTheScaleOfAPathItself) {
  FramePoses poses;
  for (int i = 0; i < 5; ++i)
    poses.emplace(i, Rigid3{RotationExp({0, 0.1 * i, 0}), Eigen::Vector3d(i, 0.2 * i * i, 0.1 * i)});
  ExpectIsWorld(AlignWorlds(poses, Moved(poses), std::nullopt, 50));
}

// Its centers alone would leave the roll about the line open.
TEST(AlignWorlds, IsCertainOnAStraightLine) {
  FramePoses poses;
  for (int i = 0; i < 5; ++i) poses.emplace(i, Rigid3{Eigen::Quaterniond::Identity(), Eigen::Vector3d(0, 0, i)});
  ExpectIsWorld(AlignWorlds(poses, Moved(poses), kWorld.scale, 50));
}

TEST(AlignWorlds, IsCertainForACameraThatStandsStill) {
  const FramePoses poses = {{3, {RotationExp({0.1, 0.2, 0.3}), {1, 2, 3}}}};
  ExpectIsWorld(AlignWorlds(poses, Moved(poses), kWorld.scale, 50));
  ExpectIsWorld(AlignWorlds(poses, Moved(poses), std::nullopt, 50), 1.0);  // nothing tells it
}

TEST(AlignWorlds, TakesCommonFramesAlone) {
  const FramePoses poses = {{1, {Eigen::Quaterniond::Identity(), {0, 0, 0}}},
                            {2, {Eigen::Quaterniond::Identity(), {1, 0, 0}}}};
  FramePoses other = Moved(poses);
  other.emplace(7, Rigid3{Eigen::Quaterniond::Identity(), {1000, 0, 0}});
  ExpectIsWorld(AlignWorlds(poses, other, kWorld.scale, 50));
  EXPECT_FALSE(AlignWorlds(poses, {{9, {Eigen::Quaterniond::Identity(), {0, 0, 0}}}}, std::nullopt, 50));
}

}  // namespace
}  // namespace pliant
