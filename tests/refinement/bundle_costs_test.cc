// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "refinement/bundle_costs.h"

#include <memory>

#include "support/cost_agreement.h"

namespace pliant {
namespace {

constexpr int kRank = 2;
constexpr double kSigma = 0.3;
const Blocks kView = {{0.02, -0.03, 0.01, 0.4, -0.2, 0.6, 0.7, -1.2}};
const Blocks kPoint = {{3.0, -2.0, 55.0, 0.5, 0.1, -0.4, 0.2, 0.3, 0.6}};

const Camera& Lens() {
  static const Camera camera =
      Camera::Create("OPENCV", 640, 480, std::vector<double>{500, 510, 320, 240, -0.1, 0.02, 0.001, -0.002}).value();
  return camera;
}

const PoseIncrement& Pose() {
  static const PoseIncrement pose(Rigid3(RotationExp({0.1, -0.05, 0.02}), Eigen::Vector3d(1, 2, -3)), {1, 1, 50});
  return pose;
}

Blocks Join(const std::vector<Blocks>& parts) {
  Blocks all;
  for (const Blocks& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

Eigen::Matrix<Jet, 3, 1> InCamera(const std::vector<Jet>& view, const Eigen::Matrix<Jet, 3, 1>& point) {
  Eigen::Matrix<Jet, 6, 1> increment;
  for (int k = 0; k < 6; ++k) increment(k) = view[static_cast<std::size_t>(k)];
  return Pose().Transform<Jet>(increment, point);
}

Eigen::Matrix<Jet, 3, 1> Part(const std::vector<Jet>& block, std::size_t from) {
  return {block[from], block[from + 1], block[from + 2]};
}

TEST(BundleCosts, ReprojectionIsThatOfThePointMovedByItsShapes) {
  const Eigen::Vector2d pixel(340, 220);
  const std::unique_ptr<ceres::CostFunction> cost(NewBundleReprojectionCost(Lens(), Pose(), pixel, kSigma, kRank));
  const Blocks blocks = Join({kView, kPoint});
  const auto x = Variables(blocks);
  const Eigen::Matrix<Jet, 3, 1> moved = Part(x[1], 0) + x[0][6] * Part(x[1], 3) + x[0][7] * Part(x[1], 6);
  const Eigen::Matrix<Jet, 3, 1> in_cam = InCamera(x[0], moved);
  std::vector<Jet> projected(2);
  Lens().Visit([&](const auto& model) { ASSERT_TRUE(model.Project(in_cam.data(), projected.data())); });
  ExpectAgreement(*cost, blocks, {(projected[0] - pixel.x()) / kSigma, (projected[1] - pixel.y()) / kSigma});
}

TEST(BundleCosts, ReprojectionOfARigidSceneHasNoShapes) {
  const std::unique_ptr<ceres::CostFunction> cost(
      NewBundleReprojectionCost(Lens(), Pose(), Eigen::Vector2d(340, 220), kSigma, 0));
  EXPECT_EQ(cost->parameter_block_sizes(), (std::vector<std::int32_t>{6, 3}));
}

TEST(BundleCosts, ReprojectionOfAPointBehindTheCameraFails) {
  const std::unique_ptr<ceres::CostFunction> cost(
      NewBundleReprojectionCost(Lens(), Pose(), Eigen::Vector2d(340, 220), kSigma, 0));
  const std::vector<double> view(6, 0.0);
  const std::vector<double> point = {0, 0, -80};
  const double* const parameters[] = {view.data(), point.data()};
  double residuals[2];
  EXPECT_FALSE(cost->Evaluate(parameters, residuals, nullptr));
}

TEST(BundleCosts, APointIsPulledToTheNodesAroundIt) {
  const std::vector<double> weights = {0.7, 0.3};
  const std::unique_ptr<ceres::CostFunction> cost(NewNodePullCost(1.5, weights, kRank));
  const Blocks blocks = Join({kPoint, {{0.1, 0.2, 0.3, 0.4, 0.5, 0.6}}, {{-0.3, 0.1, 0.9, 0.2, 0.1, 0.0}}});
  const auto x = Variables(blocks);
  std::vector<Jet> expected;
  for (std::size_t k = 0; k < 3 * kRank; ++k)
    expected.push_back(1.5 * (x[0][3 + k] - weights[0] * x[1][k] - weights[1] * x[2][k]));
  ExpectAgreement(*cost, blocks, expected);
}

TEST(BundleCosts, AWeightedSumIsOfTheLastNumbersOfItsBlocks) {
  const std::unique_ptr<ceres::CostFunction> cost(NewWeightedSumCost({2.0, -3.0}, 8, kRank));
  const Blocks blocks = Join({kView, {{1, 2, 3, 4, 5, 6, 0.5, -0.25}}});
  const auto x = Variables(blocks);
  ExpectAgreement(*cost, blocks, {2.0 * x[0][6] - 3.0 * x[1][6], 2.0 * x[0][7] - 3.0 * x[1][7]});
}

TEST(BundleCosts, DistanceIsTheLogarithmByThatOfTheStart) {
  const std::unique_ptr<ceres::CostFunction> cost(NewDistanceCost(Pose(), 48.0, kSigma, kRank));
  const Blocks blocks = Join({kView, kPoint});
  const auto x = Variables(blocks);
  ExpectAgreement(*cost, blocks, {log(InCamera(x[0], Part(x[1], 0)).norm() / 48.0) / kSigma});
}

}  // namespace
}  // namespace pliant
