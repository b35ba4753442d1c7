// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Every kernel against automatic derivatives of the formula that its header states, written out here once more.
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "pliant/base/random.h"
#include "pliant/residuals/ceres_adapter.h"
#include "pliant/residuals/edge_length.h"
#include "pliant/residuals/huber.h"
#include "pliant/residuals/reprojection.h"
#include "pliant/residuals/spatial.h"
#include "pliant/residuals/temporal.h"
#include "support/cost_agreement.h"

namespace pliant {
namespace {

std::vector<double> RandomBlock(Random& random, int size, double sigma) {
  std::vector<double> block;
  for (int i = 0; i < size; ++i) block.push_back(random.Normal(sigma));
  return block;
}

Camera MakeCamera(std::string_view model) {
  std::vector<double> params = {500, 510, 319.5, 239.5, -0.05, 0.01, 0.001, -0.002};
  if (model == "PINHOLE") params.resize(4);
  return Camera::Create(model, 640, 480, params).value();
}

// Exp(omega) x by Rodrigues' formula in its plain form, for |omega| > 0.
template <class T>
Vector3<T> Rotate(const Vector3<T>& omega, const Vector3<T>& x) {
  const T angle = omega.norm();
  const Vector3<T> axis = omega / angle;
  return x * cos(angle) + axis.cross(x) * sin(angle) + axis * (axis.dot(x) * (T(1.0) - cos(angle)));
}

struct PoseScene {
  Rigid3 cam_from_world = Rigid3(RotationExp({0.4, -0.3, 1.1}), {3, -2, 55});
  Eigen::Vector3d pivot = Eigen::Vector3d(1, 2, -3);
  PoseIncrement pose = PoseIncrement(cam_from_world, pivot);

  // Eq. E9 written out.
  template <class T>
  Vector3<T> InCamera(const std::vector<T>& increment, const Vector3<T>& x) const {
    const Vector3<T> omega(increment[0], increment[1], increment[2]);
    const Vector3<T> tau(increment[3], increment[4], increment[5]);
    const Vector3<T> centered = x - pivot.cast<T>();
    const Vector3<T> arm = cam_from_world.RotationMatrix().cast<T>() * centered;
    return Rotate(omega, arm) + (cam_from_world * pivot).cast<T>() + tau;
  }
};

template <class T>
std::vector<T> Reproject(const Camera& camera, const Vector3<T>& x, const Eigen::Vector2d& pixel, double sigma) {
  Vector2<T> projected;
  EXPECT_TRUE(camera.Visit([&](const auto& model) { return model.Project(x.data(), projected.data()); }));
  return {(projected(0) - pixel.x()) / sigma, (projected(1) - pixel.y()) / sigma};
}

class ReprojectionOfModel : public testing::TestWithParam<std::string_view> {};

TEST_P(ReprojectionOfModel, AgreesWithAutomaticDerivatives) {
  const Camera camera = MakeCamera(GetParam());
  const PoseScene scene;
  const double sigma = 0.7;
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Vector3d x(random.Normal(8), random.Normal(8), random.Normal(4));
    const Eigen::Vector2d pixel(random.Uniform(0, 640), random.Uniform(0, 480));
    const Blocks blocks = {RandomBlock(random, 6, trial < 10 ? 0.1 : 0.005), RandomBlock(random, 3, 0.5)};
    const auto jets = Variables(blocks);

    const std::unique_ptr<ceres::CostFunction> joint(NewReprojectionCost(camera, scene.pose, x, pixel, sigma));
    const Vector3<Jet> moved = x.cast<Jet>() + Vector3<Jet>(jets[1][0], jets[1][1], jets[1][2]);
    ExpectAgreement(*joint, blocks, Reproject(camera, scene.InCamera(jets[0], moved), pixel, sigma));

    const std::unique_ptr<ceres::CostFunction> pose_only(NewPoseReprojectionCost(camera, scene.pose, x, pixel, sigma));
    const Vector3<Jet> fixed = x.cast<Jet>();
    ExpectAgreement(*pose_only, {blocks[0]}, Reproject(camera, scene.InCamera(jets[0], fixed), pixel, sigma));
  }
}

INSTANTIATE_TEST_SUITE_P(Models, ReprojectionOfModel, testing::Values("PINHOLE", "OPENCV", "OPENCV_FISHEYE"),
                         [](const auto& test) { return std::string(test.param); });

TEST(Reprojection, RefusesAPointBehindTheCamera) {
  const Camera camera = MakeCamera("PINHOLE");
  const PoseIncrement pose(Rigid3(), Eigen::Vector3d::Zero());
  const Eigen::Vector3d behind(0, 0, -10);
  const double increment[6] = {};
  const double delta[3] = {};
  const double* parameters[] = {increment, delta};
  double residuals[2];
  const std::unique_ptr<ceres::CostFunction> joint(NewReprojectionCost(camera, pose, behind, {320, 240}, 1));
  EXPECT_FALSE(joint->Evaluate(parameters, residuals, nullptr));
  const std::unique_ptr<ceres::CostFunction> pose_only(NewPoseReprojectionCost(camera, pose, behind, {320, 240}, 1));
  EXPECT_FALSE(pose_only->Evaluate(parameters, residuals, nullptr));
}

TEST(Spatial, AgreesWithAutomaticDerivatives) {
  Random random(4);
  const Blocks blocks = {RandomBlock(random, 3, 1), RandomBlock(random, 3, 1)};
  const auto jets = Variables(blocks);
  std::vector<Jet> expected;
  for (int c = 0; c < 3; ++c) expected.push_back(0.8 * (jets[0][c] - jets[1][c]) / 10.0);
  const std::unique_ptr<ceres::CostFunction> cost(new DifferenceCost(SpatialKernel(0.8, 10.0)));
  ExpectAgreement(*cost, blocks, expected);
}

TEST(Temporal, AgreesWithAutomaticDerivatives) {
  Random random(5);
  const Blocks blocks = {RandomBlock(random, 3, 1)};
  const auto jets = Variables(blocks);
  std::vector<Jet> expected;
  for (int c = 0; c < 3; ++c) expected.push_back(jets[0][c] / 10.0);
  const std::unique_ptr<ceres::CostFunction> cost(new DisplacementCost(TemporalKernel(10.0)));
  ExpectAgreement(*cost, blocks, expected);
}

TEST(EdgeLength, AgreesWithAutomaticDerivatives) {
  Random random(6);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Vector3d p_i(random.Normal(5), random.Normal(5), random.Normal(5));
    const Eigen::Vector3d p_j(random.Normal(5), random.Normal(5), random.Normal(5));
    const Blocks blocks = {RandomBlock(random, 3, 1), RandomBlock(random, 3, 1)};
    const auto jets = Variables(blocks);
    Jet squared(0.0);
    for (int c = 0; c < 3; ++c) {
      const Jet difference = p_i[c] + jets[0][c] - p_j[c] - jets[1][c];
      squared += difference * difference;
    }
    const std::unique_ptr<ceres::CostFunction> cost(NewEdgeLengthCost(p_i, p_j, 4.0, 0.5));
    ExpectAgreement(*cost, blocks, {(sqrt(squared) - 4.0) / 0.5});
  }
}

TEST(EdgeLength, StaysFiniteWherePointsCoincide) {
  const EdgeLengthKernel kernel(2.0, 0.5);
  const Eigen::Vector3d p(1, 2, 3);
  EXPECT_DOUBLE_EQ(kernel.Residual<double>(p, p), -4.0);
  EXPECT_EQ(kernel.Jacobian(p, p), Eigen::Vector3d::Zero());
}

TEST(Huber, IsCeresHuberOnTheSquaredNorm) {
  for (const double chi2 : {3.841, 5.991, 7.815}) {
    const std::unique_ptr<ceres::LossFunction> loss(NewRobustLoss(chi2, 2.0));
    for (const double s : {0.0, 1.0, chi2, 1.001 * chi2, 40.0, 1e6}) {
      double rho[3];
      loss->Evaluate(s, rho);
      const RobustCost ours = Huber(s, chi2);
      EXPECT_NEAR(2.0 * ours.rho, rho[0], kAgreement * std::max(1.0, rho[0])) << s;
      EXPECT_NEAR(2.0 * ours.derivative, rho[1], kAgreement) << s;
    }
  }
}

TEST(PoseIncrement, PoseTransformsAsTheIncrementDoes) {
  const PoseScene scene;
  const Eigen::Vector3d x(4, -6, 2);
  EXPECT_LT((scene.pose.Pose(Vector6d::Zero()) * x - scene.cam_from_world * x).norm(), kAgreement * 100);
  for (const double size : {1e-9, 1e-4, 1e-3, 0.3, 2.0}) {
    const Vector6d increment = size * (Vector6d() << 0.2, -0.7, 0.5, 1, 2, -3).finished();
    EXPECT_LT((scene.pose.Pose(increment) * x - scene.pose.Transform<double>(increment, x)).norm(), kAgreement * 100);
  }
}

TEST(LeftJacobian, IsTheDerivativeOfTheExponentialMap) {
  const Eigen::Vector3d x(1, -2, 3);
  for (const double size : {0.01, 0.05, 0.0999, 0.1001, 1.0, 3.0}) {
    const Eigen::Vector3d omega = size * Eigen::Vector3d(0.6, -0.64, 0.48);
    Vector3<Jet> jets;
    for (int c = 0; c < 3; ++c) jets[c] = Jet(omega[c], c);
    const Vector3<Jet> x_jet = x.cast<Jet>();
    const Vector3<Jet> rotated = Rotate(jets, x_jet);
    const Eigen::Matrix3d jacobian = -Skew(RotateByExp<double>(omega, x)) * LeftJacobian(omega);
    for (int row = 0; row < 3; ++row)
      for (int col = 0; col < 3; ++col) EXPECT_NEAR(jacobian(row, col), rotated[row].v[col], kAgreement * 10) << size;
  }
  EXPECT_EQ(LeftJacobian(Eigen::Vector3d::Zero()), Eigen::Matrix3d::Identity());
}

}  // namespace
}  // namespace pliant
