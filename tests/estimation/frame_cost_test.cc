// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A term that the calling program adds to the joint problem of a frame.
#include "pliant/estimation/frame/frame_cost.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "estimation/frame/frame_energy.h"
#include "estimation/frame_scene.h"
#include "pliant/estimation/frame/frame_problem.h"

namespace pliant {
namespace {

constexpr double kSameCost = 1e-6;  // relative; what both solvers' convergence guarantees
constexpr double kSamePosition_mm = 1e-2;
constexpr double kDifferenceStep = 1e-4;  // step of the differences, mm and rad
constexpr double kGradientError = 1e-5;   // relative to the largest entry; of central differences with this step

// Draws points to given places, and edges to a length; both change with a rotation of the world.
class Anchors final : public FrameCost {
 public:
  Anchors(std::vector<Eigen::Vector3d> places, double sigma_mm) : places_(std::move(places)), sigma_mm_(sigma_mm) {}

  std::string_view name() const override { return "anchors"; }

  bool Evaluate(const FrameCostInput& input, FrameCostValue* value) const override {
    const auto count = static_cast<int>(input.positions.size());
    for (int i = 0; i < count; ++i) {
      // With the place of the point's id, and of the z of its neighbor: an entry off the diagonal.
      const auto id = static_cast<std::size_t>(input.ids[i].value);
      const int next = (i + 1) % count;
      for (int c = 0; c < 3; ++c) {
        const int row = 3 * i + c;
        value->residuals.push_back(
            (input.positions[i][c] - places_[id][c] + 0.1 * (input.positions[next].z() - input.previous[next].z())) /
            sigma_mm_);
        value->jacobian.push_back({row, 3 * i + c, 1 / sigma_mm_});
        value->jacobian.push_back({row, 3 * next + 2, 0.1 / sigma_mm_});
      }
    }
    return true;
  }

 private:
  std::vector<Eigen::Vector3d> places_;
  double sigma_mm_;
};

class NoAnswer final : public FrameCost {
 public:
  explicit NoAnswer(double residual) : residual_(residual) {}
  std::string_view name() const override { return "no_answer"; }
  bool Evaluate(const FrameCostInput&, FrameCostValue* value) const override {
    value->residuals.push_back(residual_);
    return !std::isinf(residual_);
  }

 private:
  double residual_;
};

// Ids that are not the points' numbers.
std::vector<PointId> IdsOf(const FrameScene& scene) {
  std::vector<PointId> ids;
  for (std::size_t i = 0; i < scene.positions.size(); ++i) ids.push_back(PointId{static_cast<std::int64_t>(i) + 7});
  return ids;
}

// 1 mm to the side of where the points are, by id.
Anchors ShiftedAnchors(const FrameScene& scene, double sigma_mm) {
  std::vector<Eigen::Vector3d> places(7, Eigen::Vector3d::Zero());
  for (const Eigen::Vector3d& position : scene.true_positions) places.push_back(position + Eigen::Vector3d(0, 0, 1));
  return {places, sigma_mm};
}

FrameProblemInput WithCost(const FrameScene& scene, const std::vector<PointId>& ids, const FrameCost& cost) {
  FrameProblemInput input = scene.Input(scene.last_cam_from_world);
  input.cost = &cost;
  input.ids = ids;
  return input;
}

double Total(const std::vector<CostTerm>& costs) {
  double sum = 0;
  for (const CostTerm& term : costs) sum += term.value;
  return sum;
}

TEST(FrameCost, BothSolversEndInTheSameMinimumWhichItMoves) {
  FrameScene scene = MakeFrameScene({.num_points = 60});
  scene.positions[5] = scene.last_cam_from_world.Inverse() * Eigen::Vector3d(0, 0, -10);  // not in the problem
  const std::vector<PointId> ids = IdsOf(scene);
  const Anchors anchors = ShiftedAnchors(scene, 0.1);
  FrameProblemOptions options;
  options.function_tolerance = 1e-13;
  options.max_iterations = 2000;
  const auto plain = SolveFrameProblem(scene.camera, scene.Input(scene.last_cam_from_world), options);
  const auto by_lbfgs = SolveFrameProblem(scene.camera, WithCost(scene, ids, anchors), options);
  options.solver = FrameSolver::kLevenbergMarquardt;
  const auto by_lm = SolveFrameProblem(scene.camera, WithCost(scene, ids, anchors), options);
  ASSERT_TRUE(plain.ok() && by_lbfgs.ok() && by_lm.ok());
  EXPECT_EQ(by_lm->num_used, 59);
  EXPECT_EQ(by_lbfgs->costs.size(), NoFrameCosts().size() + 1);
  EXPECT_EQ(by_lbfgs->costs.back().name, "anchors");
  EXPECT_GT(by_lbfgs->initial_costs.back().value, by_lbfgs->costs.back().value);
  EXPECT_NEAR(Total(by_lbfgs->costs), Total(by_lm->costs), kSameCost * Total(by_lm->costs));
  double drawn = 0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    EXPECT_LT((by_lbfgs->points[i].position - by_lm->points[i].position).norm(), kSamePosition_mm);
    drawn += (by_lm->points[i].position - plain->points[i].position).z() / 60;
  }
  EXPECT_GT(drawn, 0.5);
}

// By the points and by the pose, away from the start.
TEST(FrameCost, GradientOfTheEnergyIsThatOfDifferences) {
  const FrameScene scene = MakeFrameScene({.num_points = 12});
  const std::vector<PointId> ids = IdsOf(scene);
  const Anchors anchors = ShiftedAnchors(scene, 0.5);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& position : scene.positions) mean += position / 12;
  FrameData data;
  data.camera = &scene.camera;
  data.positions = scene.positions;
  data.pixels = scene.pixels;
  data.edges = scene.graph.edges;
  data.pose = PoseIncrement(scene.last_cam_from_world, mean);
  data.cost = &anchors;
  data.ids = ids;
  const FrameTerms terms = MakeFrameTerms(data);
  FrameEnergy energy(data, terms);
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3d& position : scene.true_positions) points.push_back(scene.true_cam_from_world * position);
  Vector6d increment;
  increment << 0.03, -0.02, 0.05, 0.4, -0.3, 0.2;
  std::vector<Eigen::Vector3d> by_points(points.size());
  Vector6d by_increment;
  double value = 0;
  ASSERT_TRUE(energy.Evaluate(points, increment, &value, &by_points, &by_increment));

  std::vector<Eigen::Vector3d> ignored(points.size());
  Vector6d ignored_too;
  const auto slope = [&](double* variable) {
    const double at = *variable;
    double above = 0;
    double below = 0;
    *variable = at + kDifferenceStep;
    EXPECT_TRUE(energy.Evaluate(points, increment, &above, &ignored, &ignored_too));
    *variable = at - kDifferenceStep;
    EXPECT_TRUE(energy.Evaluate(points, increment, &below, &ignored, &ignored_too));
    *variable = at;
    return (above - below) / (2 * kDifferenceStep);
  };
  const double largest_by_increment = by_increment.cwiseAbs().maxCoeff();
  for (int k = 0; k < 6; ++k)
    EXPECT_NEAR(slope(&increment[k]), by_increment[k], kGradientError * largest_by_increment) << k;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(slope(&points[i][c]), by_points[i][c], kGradientError * largest_by_increment) << i;
}

TEST(FrameCost, WithoutAValueAtTheStartThereIsNoSolution) {
  const FrameScene scene = MakeFrameScene({.num_points = 30});
  const std::vector<PointId> ids = IdsOf(scene);
  for (const double residual : {std::numeric_limits<double>::infinity(), std::nan("")}) {
    const NoAnswer cost(residual);
    const auto solution = SolveFrameProblem(scene.camera, WithCost(scene, ids, cost), {});
    EXPECT_EQ(solution.status().code(), ErrorCode::kDegenerate);
    EXPECT_THAT(solution.status().message(), testing::HasSubstr("has no value at the start"));
  }
  const NoAnswer cost(0);
  EXPECT_EQ(SolveFrameProblem(scene.camera, WithCost(scene, {PointId{1}}, cost), {}).status().code(),
            ErrorCode::kMismatch);
}

}  // namespace
}  // namespace pliant
