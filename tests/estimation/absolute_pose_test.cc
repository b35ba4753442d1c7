// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/pose/absolute_pose.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "pliant/base/random.h"

namespace pliant {
namespace {

constexpr double kFocal_px = 450;
constexpr double kOrigin_mm = 1.5;      // pixels of 1 px noise, 40 of them, some 60 mm away
constexpr double kRotation_rad = 0.03;  // the same over that distance
constexpr int kMinRight = 36;           // of 40; a few lie beyond the threshold
constexpr int kMaxNearByChance = 4;     // of 60, that are near their point by chance

struct Matches {
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> rays;
};

Rigid3 TruePose() { return {RotationExp({0.3, -0.5, 0.2}), {4.0, -7.0, 12.0}}; }

// The first `wrong` rays see anything.
Matches MakeMatches(int count, int wrong, double noise_px) {
  Random random(3);
  Matches matches;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d in_cam(random.Uniform(-30, 30), random.Uniform(-20, 20), random.Uniform(40, 90));
    matches.points.push_back(TruePose().Inverse() * in_cam);
    const Eigen::Vector3d noise(random.Normal(noise_px), random.Normal(noise_px), 0);
    const Eigen::Vector3d ray = in_cam / in_cam.z() + noise / kFocal_px;
    matches.rays.push_back(
        (i < wrong ? Eigen::Vector3d(random.Uniform(-0.6, 0.6), random.Uniform(-0.5, 0.5), 1) : ray).normalized());
  }
  return matches;
}

TEST(AbsolutePose, IsFoundAmongWrongMatches) {
  const Matches matches = MakeMatches(100, 60, 1.0);
  const auto pose = EstimateAbsolutePose(matches.points, matches.rays, kFocal_px, {});
  ASSERT_TRUE(pose.ok()) << pose.status().message();
  EXPECT_LT((pose->cam_from_world.OriginInSource() - TruePose().OriginInSource()).norm(), kOrigin_mm);
  EXPECT_LT(RotationAngle(pose->cam_from_world.rotation * TruePose().rotation.conjugate()), kRotation_rad);
  int right = 0;
  for (const int i : pose->inliers) right += i >= 60 ? 1 : 0;
  EXPECT_GT(right, kMinRight);
  EXPECT_LT(static_cast<int>(pose->inliers.size()) - right, kMaxNearByChance);
  EXPECT_TRUE(std::is_sorted(pose->inliers.begin(), pose->inliers.end()));
}

TEST(AbsolutePose, IsTheSameEveryTime) {
  const Matches matches = MakeMatches(60, 30, 1.0);
  const auto first = EstimateAbsolutePose(matches.points, matches.rays, kFocal_px, {});
  const auto second = EstimateAbsolutePose(matches.points, matches.rays, kFocal_px, {});
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_EQ(first->cam_from_world.translation, second->cam_from_world.translation);
  EXPECT_EQ(first->inliers, second->inliers);
}

ErrorCode CodeOf(const Matches& matches) {
  return EstimateAbsolutePose(matches.points, matches.rays, kFocal_px, {}).status().code();
}

TEST(AbsolutePose, IsRefusedWhereTheMatchesDoNotGiveOne) {
  EXPECT_EQ(CodeOf({}), ErrorCode::kInsufficient);
  EXPECT_EQ(CodeOf(MakeMatches(11, 0, 0)), ErrorCode::kInsufficient);
  EXPECT_EQ(CodeOf(MakeMatches(100, 100, 0)), ErrorCode::kDegenerate);  // all wrong
  EXPECT_EQ(CodeOf(MakeMatches(100, 85, 0)), ErrorCode::kDegenerate);   // fewer than the share
  Matches equal = MakeMatches(40, 0, 0);
  for (std::size_t i = 1; i < equal.points.size(); ++i) equal.points[i] = equal.points[0];
  EXPECT_EQ(CodeOf(equal), ErrorCode::kDegenerate);
  Matches broken = MakeMatches(40, 0, 0);
  broken.points[5].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(CodeOf(broken), ErrorCode::kInvalidArgument);
  Matches unequal = MakeMatches(40, 0, 0);
  unequal.rays.pop_back();
  EXPECT_EQ(CodeOf(unequal), ErrorCode::kMismatch);
}

}  // namespace
}  // namespace pliant
