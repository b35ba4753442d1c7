// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The energy of a frame, against the paper's sums and against residual blocks.
#include "estimation/frame/frame_energy.h"

#include <algorithm>
#include <cmath>

#include <ceres/problem.h>
#include <gtest/gtest.h>

#include "estimation/frame_scene.h"
#include "pliant/estimation/frame/frame_problem.h"
#include "pliant/residuals/ceres_adapter.h"
#include "pliant/residuals/spatial.h"
#include "pliant/residuals/temporal.h"

namespace pliant {
namespace {

constexpr double kCostRounding = 1e-12;      // relative; the same sums in another order
constexpr double kGradientRounding = 1e-10;  // relative to the largest entry; long sums of both signs

double PlainHuber(double s, double chi2) { return s <= chi2 ? s : 2 * std::sqrt(chi2) * std::sqrt(s) - chi2; }

// The paper's energy with its directed sums, written out from the formula: neighbors by sorting all distances.
std::vector<CostTerm> DirectedCosts(const FrameScene& scene, const Rigid3& pose,
                                    const std::vector<Eigen::Vector3d>& moved) {
  double reprojection = 0;
  double temporal = 0;
  double spatial = 0;
  const int count = static_cast<int>(moved.size());
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d delta = moved[i] - scene.positions[i];
    const Eigen::Vector3d x = pose * moved[i];
    const Eigen::Vector2d u(500 * x.x() / x.z() + 319.5, 500 * x.y() / x.z() + 239.5);
    reprojection += 0.5 * PlainHuber((u - scene.pixels[i]).squaredNorm(), 5.991);
    temporal += 0.5 * PlainHuber(delta.squaredNorm() / 100.0, 7.815);
    std::vector<std::pair<double, int>> others;
    for (int j = 0; j < count; ++j)
      if (j != i) others.emplace_back((scene.positions[i] - scene.positions[j]).squaredNorm(), j);
    std::sort(others.begin(), others.end());
    for (int k = 0; k < std::min(20, count - 1); ++k) {
      const auto [squared_distance, j] = others[k];
      const double w = std::exp(-squared_distance / (2 * 15.0 * 15.0));
      const Eigen::Vector3d difference = delta - (moved[j] - scene.positions[j]);
      spatial += 0.5 * PlainHuber(w * w * difference.squaredNorm() / 100.0, 7.815);
    }
  }
  return {{"reprojection", reprojection}, {"spatial", spatial}, {"temporal", temporal}, {"edge_length", 0}};
}

TEST(FrameProblem, CostsAreThePapersDirectedSums) {
  FrameScene scene = MakeFrameScene({.num_points = 150});
  std::vector<Eigen::Vector3d> moved = scene.true_positions;
  Random random(3);
  for (std::size_t i = 0; i < moved.size(); i += 10)  // far enough for every robust loss to act
    moved[i] += Eigen::Vector3d(random.Normal(30), random.Normal(30), random.Normal(3));
  const std::vector<CostTerm> expected = DirectedCosts(scene, scene.true_cam_from_world, moved);
  const auto costs =
      EvaluateFrameCosts(scene.camera, scene.Input(scene.last_cam_from_world), scene.true_cam_from_world, moved, {});
  ASSERT_TRUE(costs.ok());
  ASSERT_EQ(costs->size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_EQ((*costs)[k].name, expected[k].name);
    EXPECT_NEAR((*costs)[k].value, expected[k].value, kCostRounding * expected[k].value) << expected[k].name;
  }
}

// One residual block a term, by the adapter that the kernels' own tests hold against automatic derivatives.
void AddResidualBlocks(const FrameData& data, Vector6d* increment, std::vector<Eigen::Vector3d>* deltas,
                       ceres::Problem* problem) {
  const FrameProblemOptions& o = data.options;
  for (std::size_t i = 0; i < deltas->size(); ++i) {
    double* delta = (*deltas)[i].data();
    problem->AddResidualBlock(
        NewReprojectionCost(*data.camera, data.pose, data.positions[i], data.pixels[i], o.sigma_rep_px),
        NewRobustLoss(o.chi2_rep, 1.0), increment->data(), delta);
    problem->AddResidualBlock(new DisplacementCost(TemporalKernel(o.sigma_tmp_mm)),
                              NewRobustLoss(o.chi2_tmp, o.lambda_tmp), delta);
  }
  for (const GraphEdge& edge : data.edges) {
    double* delta_i = (*deltas)[edge.i].data();
    double* delta_j = (*deltas)[edge.j].data();
    problem->AddResidualBlock(new DifferenceCost(SpatialKernel(edge.weight, o.sigma_spa_mm)),
                              NewRobustLoss(o.chi2_spa, o.lambda_spa * edge.multiplicity), delta_i, delta_j);
    problem->AddResidualBlock(
        NewEdgeLengthCost(data.positions[edge.i], data.positions[edge.j], edge.rest_length_mm, o.sigma_len_mm),
        NewRobustLoss(o.chi2_len, o.lambda_len * edge.multiplicity), delta_i, delta_j);
  }
}

TEST(FrameProblem, GradientOfTheEnergyIsThatOfTheResidualBlocks) {
  const FrameScene scene = MakeFrameScene({.num_points = 40, .deformation_mm = 2});
  FrameData data;
  data.camera = &scene.camera;
  data.options.edge_length = Switch::kOn;
  data.options.sigma_spa_mm = data.options.sigma_tmp_mm = 0.5;
  data.positions = scene.positions;
  data.pixels = scene.pixels;
  data.edges = scene.graph.edges;
  for (GraphEdge& edge : data.edges) edge.rest_length_mm *= 1.1;
  data.pose = PoseIncrement(scene.last_cam_from_world, scene.positions[0]);

  Random random(8);
  Vector6d increment;
  for (int k = 0; k < 6; ++k) increment[k] = random.Normal(k < 3 ? 0.02 : 0.5);
  std::vector<Eigen::Vector3d> points_in_cam;
  for (const Eigen::Vector3d& position : scene.true_positions)
    points_in_cam.push_back(data.pose.Transform<double>(increment, position) +
                            Eigen::Vector3d(random.Normal(0.5), random.Normal(0.5), random.Normal(0.5)));
  const FrameTerms terms = MakeFrameTerms(data);
  FrameEnergy energy(data, terms);
  double cost = 0;
  std::vector<Eigen::Vector3d> by_points(points_in_cam.size());
  Vector6d by_increment;
  ASSERT_TRUE(energy.Evaluate(points_in_cam, increment, &cost, &by_points, &by_increment));

  // The same point of the problem in the published variables, x = T(increment) (X + delta), and its gradient by Ceres.
  const Rigid3 pose = data.pose.Pose(increment);
  std::vector<Eigen::Vector3d> deltas;
  for (std::size_t i = 0; i < points_in_cam.size(); ++i)
    deltas.push_back(pose.Inverse() * points_in_cam[i] - data.positions[i]);
  ceres::Problem problem;
  AddResidualBlocks(data, &increment, &deltas, &problem);
  double expected_cost = 0;
  std::vector<double> expected;
  std::vector<double*> blocks = {increment.data()};
  for (Eigen::Vector3d& delta : deltas) blocks.push_back(delta.data());
  ceres::Problem::EvaluateOptions evaluate_options;
  evaluate_options.parameter_blocks = blocks;
  ASSERT_TRUE(problem.Evaluate(evaluate_options, &expected_cost, nullptr, &expected, nullptr));
  EXPECT_NEAR(cost, expected_cost, kCostRounding * expected_cost);

  // By the chain rule: by_delta = R' by_point, and the pose moves the points that the displacements are fixed to.
  const Eigen::Matrix3d rotation = pose.RotationMatrix();
  const Eigen::Vector3d origin = data.pose.pivot_in_cam() + increment.tail<3>();
  double largest = 0;
  for (const double entry : expected) largest = std::max(largest, std::abs(entry));
  for (std::size_t i = 0; i < points_in_cam.size(); ++i) {
    const Eigen::Vector3d by_delta = rotation.transpose() * by_points[i];
    EXPECT_LT((by_delta - Eigen::Vector3d(&expected[6 + 3 * i])).norm(), kGradientRounding * largest) << i;
    const Eigen::Vector3d arm = points_in_cam[i] - origin;
    by_increment.head<3>() += LeftJacobian(increment.head<3>()).transpose() * arm.cross(by_points[i]);
    by_increment.tail<3>() += by_points[i];
  }
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(by_increment[k], expected[k], kGradientRounding * largest) << k;
}

}  // namespace
}  // namespace pliant
