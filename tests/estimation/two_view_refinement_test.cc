// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/two_view_refinement.h"

#include <array>
#include <numbers>

#include <ceres/jet.h>
#include <ceres/rotation.h>
#include <gtest/gtest.h>

#include "estimation/ray_residuals.h"
#include "pliant/geometry/triangulation.h"
#include "support/synthetic_scene.h"

namespace pliant {
namespace {

using test::MakeScene;
using test::RaysOf;
using test::Scene;
using test::SceneOptions;

constexpr double kDeg = std::numbers::pi / 180.0;
constexpr double kDerivative = 1e-12;  // analytic against automatic derivatives, entries of about one
constexpr double kExactRad = 1e-7;     // where the least squares rest without noise

template <class T>
using Vec3 = Eigen::Matrix<T, 3, 1>;

// Ceres' order is w, x, y, z; ours x, y, z, w.
template <class T>
Vec3<T> Rotate(const std::array<T, 4>& xyzw, const Vec3<T>& x) {
  const std::array<T, 4> wxyz = {xyzw[3], xyzw[0], xyzw[1], xyzw[2]};
  Vec3<T> rotated;
  ceres::UnitQuaternionRotatePoint(wxyz.data(), x.data(), rotated.data());
  return rotated;
}

TEST(RayResiduals, SampsonDerivativesMatchAutomaticOnes) {
  using Jet = ceres::Jet<double, 7>;
  Random random(2);
  for (int trial = 0; trial < 20; ++trial) {
    const auto draw = [&] { return Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal()); };
    const Eigen::Quaterniond q = RotationExp(draw());
    const Eigen::Vector3d t = draw().normalized();
    const Eigen::Vector3d ray0 = draw().normalized();
    const Eigen::Vector3d ray1 = draw().normalized();
    SampsonResidual residual;
    ASSERT_TRUE(EvaluateSampson(q, t, ray0, ray1, &residual));

    std::array<Jet, 4> q_jet;
    Vec3<Jet> t_jet;
    for (int k = 0; k < 4; ++k) q_jet[static_cast<std::size_t>(k)] = Jet(q.coeffs()[k], k);
    for (int k = 0; k < 3; ++k) t_jet[k] = Jet(t[k], 4 + k);
    const Vec3<Jet> y = Rotate<Jet>(q_jet, ray0.cast<Jet>());
    const Vec3<Jet> f1 = ray1.cast<Jet>();
    const Vec3<Jet> t_cross_y = t_jet.cross(y);
    const Jet c = f1.dot(t_cross_y);
    const Jet expected = c / sqrt(t_cross_y.squaredNorm() + t_jet.cross(f1).squaredNorm() - 2.0 * c * c);
    EXPECT_NEAR(residual.value, expected.a, kDerivative);
    EXPECT_LT((residual.by_rotation.transpose() - expected.v.head<4>()).norm(), kDerivative * (1 + expected.v.norm()));
    EXPECT_LT((residual.by_translation.transpose() - expected.v.tail<3>()).norm(),
              kDerivative * (1 + expected.v.norm()));
  }
}

TEST(RayResiduals, DirectionDerivativesMatchAutomaticOnes) {
  using Jet = ceres::Jet<double, 10>;
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const auto draw = [&] { return Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal()); };
    const Eigen::Quaterniond q = RotationExp(draw());
    const Eigen::Vector3d t = draw();
    const Eigen::Vector3d point = 5.0 * draw();
    const Eigen::Vector3d ray = ((q * point + t).normalized() + 0.1 * draw()).normalized();
    const RayBasis basis = BasisAcross(ray);
    DirectionResidual residual;
    ASSERT_TRUE(EvaluateDirection(q, t, point, ray, basis, &residual));
    EXPECT_FALSE(EvaluateDirection(q, t, point, -ray, basis, &residual));
    ASSERT_TRUE(EvaluateDirection(q, t, point, ray, basis, &residual));

    std::array<Jet, 4> q_jet;
    Vec3<Jet> t_jet;
    Vec3<Jet> point_jet;
    for (int k = 0; k < 4; ++k) q_jet[static_cast<std::size_t>(k)] = Jet(q.coeffs()[k], k);
    for (int k = 0; k < 3; ++k) t_jet[k] = Jet(t[k], 4 + k);
    for (int k = 0; k < 3; ++k) point_jet[k] = Jet(point[k], 7 + k);
    const Vec3<Jet> x = Rotate<Jet>(q_jet, point_jet) + t_jet;
    const Jet length = sqrt(x.squaredNorm());
    for (int row = 0; row < 2; ++row) {
      const Jet expected = (basis(row, 0) * x[0] + basis(row, 1) * x[1] + basis(row, 2) * x[2]) / length;
      EXPECT_NEAR(residual.value[row], expected.a, kDerivative);
      EXPECT_LT((residual.by_rotation.row(row).transpose() - expected.v.head<4>()).norm(),
                kDerivative * (1 + expected.v.norm()));
      EXPECT_LT((residual.by_translation.row(row).transpose() - expected.v.segment<3>(4)).norm(), kDerivative);
      EXPECT_LT((residual.by_point.row(row).transpose() - expected.v.tail<3>()).norm(), kDerivative);
    }
  }
}

Rigid3 Disturbed(const Rigid3& truth) {
  return {RotationExp({0.004, -0.006, 0.003}) * truth.rotation,
          (truth.translation.normalized() + Eigen::Vector3d(0.15, 0.2, 0.0)).normalized()};
}

TEST(TwoViewRefinement, FindsTheExactMotionWithoutNoise) {
  const SceneOptions options;
  const Scene scene = MakeScene(options);
  const Rigid3& truth = scene.cams_from_world.back();
  const auto refined =
      RefineTwoView(Disturbed(truth), RaysOf(scene, options, 0), RaysOf(scene, options, 8), options.focal_px, {});
  ASSERT_TRUE(refined.ok());
  EXPECT_LT(AngleBetween(refined->cam1_from_cam0.translation, truth.translation), kExactRad);
  EXPECT_LT(RotationAngle(refined->cam1_from_cam0.rotation * truth.rotation.conjugate()), kExactRad);
  EXPECT_NEAR(refined->cam1_from_cam0.translation.norm(), 1.0, 1e-12);
}

TEST(TwoViewRefinement, PredictsTheDirectionsSpread) {
  constexpr int kTrials = 40;
  double predicted = 0;
  double squares = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const SceneOptions options{.noise_px = 0.3, .outlier_share = 0.05, .seed = 50 + static_cast<std::uint64_t>(trial)};
    const Scene scene = MakeScene(options);
    const Rigid3& truth = scene.cams_from_world.back();
    const auto refined =
        RefineTwoView(Disturbed(truth), RaysOf(scene, options, 0), RaysOf(scene, options, 8), options.focal_px, {});
    ASSERT_TRUE(refined.ok());
    EXPECT_NEAR(refined->spread_px, 0.3, 0.06);  // the sample's own spread and the outliers' share in the median
    squares += std::pow(AngleBetween(refined->cam1_from_cam0.translation, truth.translation), 2) / kTrials;
    predicted += refined->direction_sigma_rad.squaredNorm() / kTrials;
  }
  // A few degrees of freedom by 40 trials: the spread is known to about 15 %; the bound leaves three times that.
  EXPECT_GT(std::sqrt(squares / predicted), 0.6);
  EXPECT_LT(std::sqrt(squares / predicted), 1.6);
}

TEST(TwoViewRefinement, RefusesTooFewPoints) {
  const std::vector<Eigen::Vector3d> rays(5, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(RefineTwoView({}, rays, rays, 450, {}).status().code(), ErrorCode::kInsufficient);
}

Window TrueWindow(const Scene& scene, const SceneOptions& options) {
  Window window{scene.cams_from_world, scene.points, {}};
  for (std::size_t i = 0; i < scene.points.size(); ++i)
    for (std::size_t k = 0; k < scene.pixels.size(); ++k)
      window.observations.push_back({static_cast<int>(k), static_cast<int>(i), RaysOf(scene, options, k)[i]});
  return window;
}

TEST(WindowRefinement, FindsExactPosesAndPointsWithoutNoise) {
  const SceneOptions options{.surface = test::Surface::kBlob, .motion = test::Motion::kSideways, .num_points = 60};
  const Scene scene = MakeScene(options);
  Window start = TrueWindow(scene, options);
  for (std::size_t i = 0; i < start.points_in_world.size(); ++i) start.points_in_world[i] *= i % 2 == 0 ? 1.05 : 0.95;
  for (std::size_t k = 1; k + 1 < start.cams_from_world.size(); ++k) start.cams_from_world[k].translation.x() += 0.05;
  const auto refined = RefineWindow(start, options.focal_px, WindowPoints::kRefined, {});
  ASSERT_TRUE(refined.ok()) << refined.status().message();
  constexpr double kExactMm = 1e-4;  // where the solver rests, of 50 mm
  for (std::size_t i = 0; i < scene.points.size(); ++i)
    EXPECT_LT((refined->window.points_in_world[i] - scene.points[i]).norm(), kExactMm) << i;
  for (std::size_t k = 0; k < scene.cams_from_world.size(); ++k)
    EXPECT_LT((refined->window.cams_from_world[k].translation - scene.cams_from_world[k].translation).norm(), kExactMm);
  EXPECT_EQ(refined->window.cams_from_world.front().translation, Eigen::Vector3d::Zero());
}

TEST(WindowRefinement, LocatesPosesOnFixedPoints) {
  const SceneOptions options{.num_points = 60};
  const Scene scene = MakeScene(options);
  Window start = TrueWindow(scene, options);
  for (Rigid3& pose : start.cams_from_world) pose = Rigid3();
  const auto refined = RefineWindow(start, options.focal_px, WindowPoints::kFixed, {.loss_scale_px = 10});
  ASSERT_TRUE(refined.ok());
  for (std::size_t k = 0; k < scene.cams_from_world.size(); ++k)
    EXPECT_LT((refined->window.cams_from_world[k].translation - scene.cams_from_world[k].translation).norm(), 1e-5);
  EXPECT_EQ(refined->window.points_in_world, start.points_in_world);
}

TEST(WindowRefinement, RefusesBadWindows) {
  const SceneOptions options{.num_points = 20};
  const Scene scene = MakeScene(options);
  Window window = TrueWindow(scene, options);
  window.observations.front().point_idx = 20;
  EXPECT_EQ(RefineWindow(window, 450, WindowPoints::kRefined, {}).status().code(), ErrorCode::kInvalidArgument);
  window = TrueWindow(scene, options);
  window.points_in_world[3] = -window.points_in_world[3];
  EXPECT_EQ(RefineWindow(window, 450, WindowPoints::kRefined, {}).status().code(), ErrorCode::kInvalidArgument);
  window.cams_from_world.resize(1);
  EXPECT_EQ(RefineWindow(window, 450, WindowPoints::kRefined, {}).status().code(), ErrorCode::kInsufficient);
}

}  // namespace
}  // namespace pliant
