// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <vector>

#include <gtest/gtest.h>

#include "pliant/base/random.h"
#include "pliant/geometry/alignment.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

constexpr double kUnitQuaternion = 1e-14;  // numbers up to one, through sine and cosine

TEST(Rigid3, ComposesAndInverts) {
  const Rigid3 b_from_a(RotationExp({0.3, -0.2, 0.9}), {1, 2, 3});
  const Rigid3 c_from_b(RotationExp({-1.0, 0.4, 0.1}), {-5, 0, 7});
  const Eigen::Vector3d x(4, -2, 8);
  EXPECT_LT(((c_from_b * b_from_a) * x - c_from_b * (b_from_a * x)).norm(), kLengthRoundOff_mm);
  EXPECT_LT((b_from_a.Inverse() * (b_from_a * x) - x).norm(), kLengthRoundOff_mm);
  EXPECT_LT((b_from_a * b_from_a.OriginInSource()).norm(), kLengthRoundOff_mm);
}

TEST(Rigid3, ExponentialMapMatchesAngleAxis) {
  for (const double angle : {0.0, 1e-9, 1e-5, 0.5, 3.0}) {
    const Eigen::Vector3d axis = Eigen::Vector3d(1, -2, 0.5).normalized();
    const Eigen::Quaterniond expected(Eigen::AngleAxisd(angle, axis));
    EXPECT_LT((RotationExp(angle * axis).coeffs() - expected.coeffs()).norm(), kUnitQuaternion) << angle;
  }
}

TEST(Sim3, ComposesAndInverts) {
  const Sim3 b_from_a{2.5, RotationExp({0.3, -0.2, 0.9}), {1, 2, 3}};
  const Sim3 c_from_b{0.25, RotationExp({-1.0, 0.4, 0.1}), {-5, 0, 7}};
  const Eigen::Vector3d x(4, -2, 8);
  const Eigen::Vector3d y(1, 0, -3);
  EXPECT_LT(((c_from_b * b_from_a) * x - c_from_b * (b_from_a * x)).norm(), kLengthRoundOff_mm);
  EXPECT_LT((b_from_a.Inverse() * (b_from_a * x) - x).norm(), kLengthRoundOff_mm);
  EXPECT_LT((b_from_a.Turn(x - y) - (b_from_a * x - b_from_a * y)).norm(), kLengthRoundOff_mm);
}

TEST(Sim3, MovesACameraWithWhatItSees) {
  const Sim3 b_from_a{2.5, RotationExp({0.3, -0.2, 0.9}), {1, 2, 3}};
  const Rigid3 cam_from_a(RotationExp({-1.0, 0.4, 0.1}), {-5, 0, 7});
  const Eigen::Vector3d x(4, -2, 8);
  const Rigid3 cam_from_b = PoseInWorld(b_from_a, cam_from_a);
  EXPECT_LT((cam_from_b * (b_from_a * x) - b_from_a.scale * (cam_from_a * x)).norm(), kLengthRoundOff_mm);
  const Sim3 found = WorldFromPoses(cam_from_b, cam_from_a, b_from_a.scale);
  EXPECT_LT((found * x - b_from_a * x).norm(), kLengthRoundOff_mm);
}

TEST(AlignPoints, RecoversASimilarity) {
  Random random(5);
  const Sim3 truth{2.5, RotationExp({0.5, 1.5, -0.3}), {10, -20, 30}};
  std::vector<Eigen::Vector3d> a;
  std::vector<Eigen::Vector3d> b;
  for (int i = 0; i < 20; ++i) {
    a.emplace_back(random.Normal(30), random.Normal(30), random.Normal(30));
    b.push_back(truth * a.back());
  }
  const auto b_from_a = AlignPoints(a, b, AlignmentScale::kEstimated);
  ASSERT_TRUE(b_from_a.ok());
  EXPECT_NEAR(b_from_a->scale, truth.scale, kLengthRoundOff_mm);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_LT((*b_from_a * a[i] - b[i]).norm(), kLengthRoundOff_mm);
}

TEST(AlignPoints, RefusesWhatDeterminesNothing) {
  const std::vector<Eigen::Vector3d> two(2, Eigen::Vector3d::Zero());
  EXPECT_EQ(AlignPoints(two, two, AlignmentScale::kEstimated).status().code(), ErrorCode::kInsufficient);
  const std::vector<Eigen::Vector3d> same(5, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(AlignPoints(same, same, AlignmentScale::kEstimated).status().code(), ErrorCode::kDegenerate);
}

}  // namespace
}  // namespace pliant
