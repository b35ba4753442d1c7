// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/motion.h"

#include <functional>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "pliant/base/random.h"
#include "support/tolerances.h"

namespace pliant::simulation {
namespace {

constexpr double kCentralDifference = 1e-8;  // steps of 1e-4 mm: rounding 1e-10, third derivatives 1e-11; a hundredfold

SimulationOptions::Deformation Everything() {
  SimulationOptions::Deformation options;
  options.amplitude_mm = 3.0;
  options.wavelength_mm = 120.0;
  options.breathing_mm = 4.0;
  options.poke_mm = 5.0;
  options.poke_radius_mm = 11.0;
  return options;
}

const Poke kPoke = {Eigen::Vector3d(3, 25, 40), Eigen::Vector3d(0.1, -0.9, 0.3).normalized()};

// The motion as a function of the position alone, C among it; its gradient by central differences.
Eigen::Matrix3d NumericGradient(const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& moved,
                                const Eigen::Vector3d& x) {
  constexpr double kStepMm = 1e-4;
  Eigen::Matrix3d gradient;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d step = kStepMm * Eigen::Vector3d::Unit(i);
    gradient.col(i) = (moved(x + step) - moved(x - step)) / (2.0 * kStepMm);
  }
  return gradient;
}

// Around a circle of this radius in the plane x = 0, the centerline of a bent tube.
constexpr double kBendMm = 140.0;
RestPoint OnBentTube(const Eigen::Vector3d& x, int part) {
  const Eigen::Vector3d middle(0.0, kBendMm, 0.0);
  const Eigen::Vector3d in_plane(0.0, x.y() - middle.y(), x.z());
  const Eigen::Vector3d nearest = middle + kBendMm * in_plane.normalized();
  const Eigen::Vector3d tangent = Eigen::Vector3d::UnitX().cross(in_plane.normalized());
  const Eigen::Vector3d curvature = (middle - nearest) / (kBendMm * kBendMm);
  return {x, nearest, tangent / std::sqrt(1.0 - curvature.dot(x - nearest)), part};
}

TEST(Motion, GradientIsTheDerivativeOfThePosition) {
  const Motion motion(Everything(), 25.0, kPoke);
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    const int part = i % 2;
    const Eigen::Vector3d x(random.Uniform(-20, 20), random.Uniform(-20, 30), random.Uniform(20, 60));
    const double time_s = random.Uniform(0, 6);
    const auto moved = [&](const Eigen::Vector3d& at) { return motion.Position(OnBentTube(at, part), time_s); };
    EXPECT_LT((motion.Gradient(OnBentTube(x, part), time_s) - NumericGradient(moved, x)).norm(), kCentralDifference);
  }
}

TEST(Motion, NormalsStayAcrossTheSurface) {
  const Motion motion(Everything(), 25.0, kPoke);
  Random random(6);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d x(random.Uniform(-20, 20), random.Uniform(-20, 30), random.Uniform(20, 60));
    const Eigen::Vector3d normal = Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized();
    const Eigen::Vector3d along = normal.unitOrthogonal();
    const RestPoint point = OnBentTube(x, 0);
    const Eigen::Vector3d moved_along = motion.Gradient(point, 1.3) * along;
    const Eigen::Vector3d moved_normal = motion.Normal(normal, point, 1.3);
    EXPECT_NEAR(moved_normal.dot(moved_along), 0.0, kRoundOff);
    EXPECT_NEAR(moved_normal.norm(), 1.0, kRoundOff);
    EXPECT_GT(moved_normal.dot(motion.Gradient(point, 1.3) * normal), 0.0);
  }
}

TEST(Motion, BoundsHoldForEveryPointAndTime) {
  const Motion motion(Everything(), 25.0, kPoke);
  Random random(7);
  constexpr double kFrameS = 1.0 / 30.0;
  for (int i = 0; i < 500; ++i) {
    RestPoint point = OnBentTube({random.Uniform(-20, 20), random.Uniform(-20, 30), random.Uniform(20, 60)}, i % 2);
    if (i % 3 == 0) point.position = kPoke.position;
    const double reach_mm = (point.position - point.swell_center).norm();
    const double time_s = random.Uniform(0, 6);
    const Eigen::Vector3d now = motion.Position(point, time_s);
    EXPECT_LE((now - point.position).norm(), motion.LargestDisplacementMm(reach_mm));
    EXPECT_LE((motion.Position(point, time_s + kFrameS) - now).norm(), motion.LargestStepMm(reach_mm, kFrameS));
  }
}

}  // namespace
}  // namespace pliant::simulation
