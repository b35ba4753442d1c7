// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/geometry/triangulation.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "pliant/base/random.h"
#include "pliant/geometry/essential.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

constexpr double kLowParallax_mm = 1e-7;    // rounding of the rays by the parallax of 1e-4
constexpr double kPlaneStep = 1e-7;         // squared sines: the steps between the planes that are tried
constexpr double kCostRoundOff = 1e-9;      // of squared sines and relative; the cost is flat at its minimum
constexpr int kMinCompared = 100;           // of 200 random pairs of rays; the others diverge
constexpr double kFormulaRoundOff = 1e-15;  // of about 0.04: one formula written twice
constexpr double kUnequalDistances = 0.1;   // relative; the formula takes both distances as equal
constexpr double kSpreadOf2000 = 0.07;      // 2000 trials fix a deviation to 1.6 %; three times that, and the curvature
constexpr double kTurnOfRay = 1e-3;         // relative; Sampson's error is of first order in the turn
constexpr double kTurnOfPlane = 1e-2;  // relative; the planes' angle is the ray's turn by the parallax angle's sine

constexpr std::array kAllMethods = {&TriangulateIdwm, &TriangulateMidpoint, &TriangulateLinear, &TriangulateOptimalL2};

const Rigid3 kCam1FromCam0(RotationExp({0.05, -0.1, 0.2}), {4, -1, 2});

Eigen::Vector3d RayIn(const Rigid3& cam_from_world, const Eigen::Vector3d& x) {
  return (cam_from_world * x).normalized();
}

TEST(Triangulation, EveryMethodRecoversExactPoints) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d x(random.Uniform(-30, 30), random.Uniform(-30, 30), random.Uniform(20, 120));
    for (const auto triangulate : kAllMethods) {
      const TriangulatedPoint point = triangulate(kCam1FromCam0, x.normalized(), RayIn(kCam1FromCam0, x));
      ASSERT_TRUE(point.ok());
      EXPECT_LT((point.point_in_cam0 - x).norm(), kLengthRoundOff_mm * x.norm());
    }
  }
}

TEST(IdwmTriangulation, IsTheMeanOfTheDepthsOnBothRaysWeightedByInverseDepth) {
  // Rays that miss each other: the point of the other ray at the sine-rule depths l0 and l1, weighted by 1 / l.
  const Eigen::Vector3d ray0 = Eigen::Vector3d(0.10, 0.02, 1).normalized();
  const Eigen::Vector3d ray1 = RayIn(kCam1FromCam0, 60.0 * Eigen::Vector3d(0.10, 0.03, 1).normalized());
  const Eigen::Vector3d y = kCam1FromCam0.rotation * ray0;
  const Eigen::Vector3d& t = kCam1FromCam0.translation;
  const double p = y.cross(ray1).norm();
  const double depth0 = ray1.cross(t).norm() / p;
  const double depth1 = y.cross(t).norm() / p;
  const Eigen::Vector3d on_ray0 = t + depth0 * y;
  const Eigen::Vector3d on_ray1 = depth1 * ray1;
  const Eigen::Vector3d expected = (on_ray0 / depth0 + on_ray1 / depth1) / (1.0 / depth0 + 1.0 / depth1);
  const TriangulatedPoint point = TriangulateIdwm(kCam1FromCam0, ray0, ray1);
  ASSERT_TRUE(point.ok());
  EXPECT_LT((kCam1FromCam0 * point.point_in_cam0 - expected).norm(), kLengthRoundOff_mm);
}

// Rays that miss each other by about a degree.
struct Skewed {
  Eigen::Vector3d ray0;
  Eigen::Vector3d ray1;
};
Skewed MakeSkewed(Random* random) {
  const Eigen::Vector3d x(random->Uniform(-30, 30), random->Uniform(-30, 30), random->Uniform(20, 60));
  const auto shaken = [&](const Eigen::Vector3d& ray) {
    return (ray + 0.01 * Eigen::Vector3d(random->Normal(), random->Normal(), random->Normal())).normalized();
  };
  return {shaken(x.normalized()), shaken(RayIn(kCam1FromCam0, x))};
}

TEST(OptimalL2Triangulation, TurnsTheRaysLeastOfAllEpipolarPlanes) {
  Random random(5);
  const auto squared_sine = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return a.cross(b).squaredNorm() / b.squaredNorm();
  };
  int compared = 0;
  for (int i = 0; i < 200; ++i) {
    const auto [ray0, ray1] = MakeSkewed(&random);
    const TriangulatedPoint point = TriangulateOptimalL2(kCam1FromCam0, ray0, ray1);
    if (!point.ok()) continue;
    ++compared;
    const double cost =
        squared_sine(ray0, point.point_in_cam0) + squared_sine(ray1, kCam1FromCam0 * point.point_in_cam0);
    // The planes through the baseline, one by one: none turns the rays less.
    const Eigen::Vector3d& t = kCam1FromCam0.translation;
    const Eigen::Vector3d a = t.unitOrthogonal();
    const Eigen::Vector3d b = t.normalized().cross(a);
    double least = 1;
    constexpr int kPlanes = 20000;
    for (int k = 0; k < kPlanes; ++k) {
      const double angle = k * std::numbers::pi / kPlanes;
      const Eigen::Vector3d n = std::cos(angle) * a + std::sin(angle) * b;
      least = std::min(least, std::pow(n.dot(kCam1FromCam0.rotation * ray0), 2) + std::pow(n.dot(ray1), 2));
    }
    EXPECT_LT(cost, least + kCostRoundOff);
    EXPECT_GT(cost, least - kPlaneStep);
  }
  EXPECT_GT(compared, kMinCompared);
}

TEST(LinearTriangulation, LeavesTheLeastAlgebraicError) {
  Random random(6);
  int compared = 0;
  for (int i = 0; i < 200; ++i) {
    const auto rays = MakeSkewed(&random);
    const Eigen::Vector3d& ray0 = rays.ray0;
    const Eigen::Vector3d& ray1 = rays.ray1;
    const TriangulatedPoint point = TriangulateLinear(kCam1FromCam0, ray0, ray1);
    if (!point.ok()) continue;
    ++compared;
    const auto error = [&](const Eigen::Vector3d& x) {
      return (ray0.cross(x).squaredNorm() + ray1.cross(kCam1FromCam0 * x).squaredNorm()) / (1.0 + x.squaredNorm());
    };
    for (int k = 0; k < 20; ++k) {
      const Eigen::Vector3d step(random.Normal(), random.Normal(), random.Normal());
      EXPECT_LE(error(point.point_in_cam0), error(point.point_in_cam0 + 0.1 * step) * (1 + kCostRoundOff));
    }
  }
  EXPECT_GT(compared, kMinCompared);
}

TEST(Triangulation, RecoversPointAtLowParallax) {
  const Rigid3 nearly_still(Eigen::Quaterniond::Identity(), {0.005, 0, 0});  // 0.006 degrees at 50 mm
  const Eigen::Vector3d x(5, 5, 50);
  for (const auto triangulate : kAllMethods) {
    const TriangulatedPoint point = triangulate(nearly_still, x.normalized(), RayIn(nearly_still, x));
    ASSERT_TRUE(point.ok());
    EXPECT_LT((point.point_in_cam0 - x).norm(), kLowParallax_mm);
  }
}

TEST(Triangulation, RejectsDivergentRays) {
  const Rigid3 sideways(Eigen::Quaterniond::Identity(), {-1, 0, 0});  // cam1 lies to the right of cam0
  const Eigen::Vector3d left = Eigen::Vector3d(-0.1, 0, 1).normalized();
  const Eigen::Vector3d right = Eigen::Vector3d(0.1, 0, 1).normalized();
  for (const auto triangulate : kAllMethods) {
    EXPECT_TRUE(triangulate(sideways, right, left).ok());
    EXPECT_EQ(triangulate(sideways, left, right).status, TriangulationStatus::kCheirality);
  }
}

TEST(Triangulation, NamesParallelAndInvalidRays) {
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d nan = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  const Rigid3 sideways(Eigen::Quaterniond::Identity(), {1, 0, 0});
  const Rigid3 forward(Eigen::Quaterniond::Identity(), {0, 0, -1});
  for (const auto triangulate : kAllMethods) {
    EXPECT_EQ(triangulate(sideways, z, z).status, TriangulationStatus::kParallel);
    EXPECT_EQ(triangulate(forward, z, z).status, TriangulationStatus::kParallel);  // at the focus of expansion
    EXPECT_EQ(triangulate(sideways, nan, z).status, TriangulationStatus::kInvalidRay);
    EXPECT_EQ(triangulate(sideways, z, nan).status, TriangulationStatus::kInvalidRay);
  }
}

TEST(DepthUncertainty, FollowsTheTwoViewFormula) {
  EXPECT_NEAR(RelativeDepthSigma(0.5, 500.0, 2.0 * kDeg), std::sqrt(2.0) * 0.001 / std::sin(2.0 * kDeg),
              kFormulaRoundOff);
  EXPECT_TRUE(std::isinf(RelativeDepthSigma(0.5, 500.0, 0.0)));
}

TEST(DepthUncertainty, CovarianceMatchesNoisyTriangulation) {
  const Rigid3 sideways(Eigen::Quaterniond::Identity(), {-3, 0, 0});
  const Eigen::Vector3d x(2, -4, 50);
  constexpr double kSigmaRad = 5e-4;
  const std::array cams = {Rigid3(), sideways};
  const double predicted = DepthSigma(PointCovariance(cams, x, kSigmaRad), x);
  EXPECT_NEAR(predicted / x.norm(), RelativeDepthSigma(kSigmaRad, 1.0, AngleBetween(x, sideways * x)),
              kUnequalDistances * predicted / x.norm());
  Random random(9);
  double squares = 0;
  constexpr int kTrials = 2000;
  for (int i = 0; i < kTrials; ++i) {
    const auto shaken = [&](const Eigen::Vector3d& ray) {
      const Eigen::Vector3d noise(random.Normal(), random.Normal(), random.Normal());
      return (ray + kSigmaRad * noise).normalized();
    };
    const auto point = TriangulateIdwm(sideways, shaken(x.normalized()), shaken(RayIn(sideways, x)));
    ASSERT_TRUE(point.ok());
    squares += std::pow(point.point_in_cam0.norm() - x.norm(), 2);
  }
  EXPECT_NEAR(std::sqrt(squares / kTrials), predicted, kSpreadOf2000 * predicted);
}

TEST(DepthUncertainty, IsInfiniteWithoutParallax) {
  const std::array cams = {Rigid3(), Rigid3(Eigen::Quaterniond::Identity(), {0, 0, -5})};
  const Eigen::Vector3d ahead(0, 0, 50);
  EXPECT_TRUE(std::isinf(DepthSigma(PointCovariance(cams, ahead, 1e-3), ahead)));
}

TEST(Essential, DecompositionContainsTheMotionAndTheChoiceFindsIt) {
  Random random(4);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Vector3d omega(random.Normal(0.1), random.Normal(0.1), random.Normal(0.1));
    const Eigen::Vector3d t = Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized();
    const Rigid3 motion(RotationExp(omega), t);
    std::vector<Eigen::Vector3d> rays0;
    std::vector<Eigen::Vector3d> rays1;
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector3d x(random.Uniform(-10, 10), random.Uniform(-10, 10), random.Uniform(10, 30));
      rays0.push_back(x.normalized());
      rays1.push_back(RayIn(motion, x));
      EXPECT_LT(std::abs(SampsonErrorRad(motion, rays0.back(), rays1.back())), kLengthRoundOff_mm);
    }
    const double sign = trial % 2 == 0 ? 1.0 : -1.0;  // the sign of E is free
    const auto choice = ChooseMotion(sign * 3.0 * EssentialFromMotion(motion), rays0, rays1);
    ASSERT_TRUE(choice.ok());
    EXPECT_LT(RotationAngle(choice->cam1_from_cam0.rotation * motion.rotation.conjugate()), kAngleRoundOff_rad);
    EXPECT_LT((choice->cam1_from_cam0.translation - t).norm(), kAngleRoundOff_rad);
    EXPECT_EQ(choice->in_front, 20);
  }
}

TEST(Essential, RefusesWhatIsNone) {
  EXPECT_EQ(DecomposeEssential(Eigen::Matrix3d::Zero()).status().code(), ErrorCode::kInvalidArgument);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(DecomposeEssential(Eigen::Matrix3d::Constant(nan)).status().code(), ErrorCode::kInvalidArgument);
}

TEST(Essential, SampsonErrorIsTheTurnThatMakesTheRaysMeet) {
  const Rigid3 sideways(Eigen::Quaterniond::Identity(), {-3, 0, 0});
  const Eigen::Vector3d x(1, 2, 50);
  constexpr double kTurn = 1e-3;
  const Eigen::Vector3d off = RotationExp({kTurn, 0, 0}) * RayIn(sideways, x);  // about x: across the epipolar lines
  // One ray off by kTurn: both can share the mend, each by half, so that the root of the squares is kTurn / sqrt(2).
  EXPECT_NEAR(std::abs(SampsonErrorRad(sideways, x.normalized(), off)), kTurn / std::sqrt(2.0), kTurnOfRay * kTurn);
  EXPECT_NEAR(EpipolarPlaneAngle(sideways, x.normalized(), off), kTurn, kTurnOfPlane * kTurn);
}

}  // namespace
}  // namespace pliant
