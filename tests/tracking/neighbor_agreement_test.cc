// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/frame/neighbor_agreement.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "pliant/base/random.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

constexpr double kDamped_px = 1.0;  // the gradient across the surface is damped, so an affine field is met up to that
constexpr int kMaxAtTheRim = 3;     // 1 %: neighbors at the sheet's rim lie on one side only
constexpr int kPoints = 300;
constexpr double kDepthMm = 50;
constexpr double kPxPerMm = 500 / kDepthMm;

// Points of a bumpy sheet before a camera at the origin, moved by `motion`.
template <class Motion>
std::vector<NeighborMotion> MovingSheet(const Motion& motion) {
  Random random(11);
  std::vector<NeighborMotion> motions;
  for (int i = 0; i < kPoints; ++i) {
    const double x = random.Uniform(-25, 25);
    const double y = random.Uniform(-20, 20);
    const Eigen::Vector3d anchor(x, y, kDepthMm + 2 * std::sin(0.2 * x) * std::cos(0.15 * y));
    motions.push_back({anchor, motion(anchor)});
  }
  return motions;
}

std::vector<std::vector<int>> Nearest(const std::vector<NeighborMotion>& motions, int count) {
  std::vector<std::vector<int>> neighbors(motions.size());
  for (std::size_t i = 0; i < motions.size(); ++i) {
    std::vector<int> order(motions.size());
    std::iota(order.begin(), order.end(), 0);
    const auto distance = [&](int j) { return (motions[j].anchor - motions[i].anchor).squaredNorm(); };
    std::sort(order.begin(), order.end(), [&](int a, int b) { return distance(a) < distance(b); });
    neighbors[i].assign(order.begin() + 1, order.begin() + 1 + count);
  }
  return neighbors;
}

TEST(NeighborAgreement, AffineMotionOfTheWholeSceneIsNoOutlier) {
  Eigen::Matrix3d gradient;
  gradient << 0.02, 0.01, 0, -0.03, 0.01, 0, 0.02, 0.05, 0;
  const auto motions = MovingSheet(
      [&](const Eigen::Vector3d& x) -> Eigen::Vector3d { return x + Eigen::Vector3d(1, -2, 3) + gradient * x; });
  const auto disagreements = MeasureDisagreement(motions, Nearest(motions, 20), Eigen::Vector3d::Zero(), 1);
  const auto on_threads = MeasureDisagreement(motions, Nearest(motions, 20), Eigen::Vector3d::Zero(), 3);
  for (std::size_t k = 0; k < motions.size(); ++k) {
    EXPECT_EQ(on_threads[k].distance_mm, disagreements[k].distance_mm);
    EXPECT_EQ(on_threads[k].sigma_mm, disagreements[k].sigma_mm);
  }
  ASSERT_EQ(disagreements.size(), motions.size());
  for (const Disagreement& d : disagreements) EXPECT_LT(d.distance_mm * kPxPerMm, kDamped_px);
}

TEST(NeighborAgreement, SmoothDeformationIsAcceptedAndSlidingPointsAreFound) {
  Random random(3);
  auto motions = MovingSheet([&](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    const double noise = 0.03;  // 0.3 px
    return x + Eigen::Vector3d(random.Normal(noise), 2.5 * std::sin(0.06 * (x.x() + x.y())) + random.Normal(noise), 0);
  });
  std::vector<int> sliding;
  for (int i = 7; i < kPoints; i += 20) {  // one in twenty slides by 8 px
    motions[i].position += Eigen::Vector3d(0.8, 0, 0);
    sliding.push_back(i);
  }
  const AgreementOptions options;
  const auto disagreements = MeasureDisagreement(motions, Nearest(motions, 20), Eigen::Vector3d::Zero(), 1);
  int found = 0;
  int false_alarms = 0;
  for (int i = 0; i < kPoints; ++i) {
    const bool is_sliding = std::find(sliding.begin(), sliding.end(), i) != sliding.end();
    const bool flagged = Contradicts(disagreements[i], kPxPerMm, options);
    (is_sliding ? found : false_alarms) += flagged ? 1 : 0;
  }
  EXPECT_EQ(found, static_cast<int>(sliding.size()));
  EXPECT_LE(false_alarms, kMaxAtTheRim);
}

TEST(NeighborAgreement, MotionAlongTheRayIsNotMeasured) {
  auto motions = MovingSheet([](const Eigen::Vector3d& x) { return x; });
  motions[42].position *= 1.2;
  const auto disagreements = MeasureDisagreement(motions, Nearest(motions, 20), Eigen::Vector3d::Zero(), 1);
  EXPECT_LT(disagreements[42].distance_mm, kLengthRoundOff_mm);
}

TEST(NeighborAgreement, TooFewNeighborsSayNothing) {
  auto motions = MovingSheet([](const Eigen::Vector3d& x) { return x; });
  motions[0].position.x() += 100;
  const auto disagreements = MeasureDisagreement(motions, Nearest(motions, 3), Eigen::Vector3d::Zero(), 1);
  EXPECT_FALSE(Contradicts(disagreements[0], kPxPerMm, AgreementOptions{}));
}

}  // namespace
}  // namespace pliant
