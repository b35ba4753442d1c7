// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "refinement/bundle_covariance.h"

#include <ceres/covariance.h>
#include <gtest/gtest.h>

#include "refinement/bundle.h"
#include "refinement/recorded_scene.h"

namespace pliant {
namespace {

using refinement_test::kNoisePx;
using refinement_test::kStartError;
using refinement_test::RecordedScene;
using refinement_test::RecordingCamera;

constexpr double kSampled = 0.25;  // a sigma from 150 samples is right to 6 %: four of these

class BundleCovarianceTest : public testing::TestWithParam<double> {
 protected:
  BundleCovarianceTest() : scene_(GetParam()), start_(scene_.Start()), input_{RecordingCamera(), start_} {
    input_.used.assign(start_.observations.size(), true);
    input_.sigmas.noise_px = kNoisePx;
    input_.sigmas.log_distance = kStartError;
    input_.distance = 60;
    state_.cams_from_world = start_.cams_from_world;
    state_.rest_positions = start_.rest_positions;
    if (GetParam() > 0) {
      state_ = DeformingStart(start_, 3, 24);
      input_.graph = MakeGraph(state_, 6);
    }
    EXPECT_TRUE(SolveBundle(input_, 5, {}, &state_).ok());
  }

  RecordedScene scene_;
  Recording start_;
  BundleInput input_;
  BundleState state_;
};

// Ceres inverts the same normal equations in its own way.
TEST_P(BundleCovarianceTest, IsThatOfCeres) {
  const BundleProblem problem(input_, &state_);
  const auto covariance = ComputeCovariance(problem, start_);
  ASSERT_TRUE(covariance.ok()) << covariance.status().message();
  ceres::Covariance expected({});
  const std::vector<std::size_t> views = {1, 17, 39};
  const std::size_t observation = start_.observations.size() / 2;
  const auto of_view = static_cast<std::size_t>(start_.observations[observation].view_idx);
  const auto of_point = static_cast<std::size_t>(start_.observations[observation].point_idx);
  double* const view_block = problem.views()[of_view];
  double* const point_block = problem.points()[of_point];
  std::vector<std::pair<const double*, const double*>> blocks = {
      {point_block, point_block}, {view_block, point_block}, {view_block, view_block}};
  for (const std::size_t view : views) blocks.emplace_back(problem.views()[view], problem.views()[view]);
  ASSERT_TRUE(expected.Compute(blocks, &problem.terms()));
  using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const int view_size = 6 + problem.rank();
  const int point_size = 3 + 3 * problem.rank();
  const auto block = [&](const double* a, int rows, const double* b, int columns) {
    RowMajorMatrix matrix(rows, columns);
    EXPECT_TRUE(expected.GetCovarianceBlock(a, b, matrix.data()));
    return matrix;
  };

  for (const std::size_t view : views) {
    const RowMajorMatrix of_increment = block(problem.views()[view], view_size, problem.views()[view], view_size);
    const Eigen::Matrix3d rotation = covariance->poses[view].bottomRightCorner<3, 3>();
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(std::sqrt(rotation(k, k) / of_increment(k, k)), 1, kSampled) << "view " << view;
    // The center by small steps of the increment.
    RowMajorMatrix by_increment(3, 6);
    for (int k = 0; k < 6; ++k) {
      constexpr double kStep = 1e-6;
      const auto at = [&](double step) { return problem.poses()[view].Pose(step * Vector6d::Unit(k)); };
      by_increment.col(k) = (at(kStep).OriginInSource() - at(-kStep).OriginInSource()) / (2 * kStep);
    }
    const Eigen::Matrix3d center = by_increment * of_increment.topLeftCorner(6, 6) * by_increment.transpose();
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(std::sqrt(covariance->poses[view](k, k) / center(k, k)), 1, kSampled) << "view " << view;
  }

  // The log distance by small steps of view and point.
  const auto log_distance = [&](const Eigen::VectorXd& step) {
    const Eigen::VectorXd view = Eigen::Map<Eigen::VectorXd>(view_block, view_size) + step.head(view_size);
    const Eigen::VectorXd point = Eigen::Map<Eigen::VectorXd>(point_block, point_size) + step.tail(point_size);
    Eigen::Vector3d position = point.head<3>();
    for (int r = 0; r < problem.rank(); ++r) position += view(6 + r) * point.segment<3>(3 + 3 * r);
    return std::log((problem.poses()[of_view].Pose(view.head<6>()) * position).norm());
  };
  Eigen::VectorXd gradient(view_size + point_size);
  for (int k = 0; k < gradient.size(); ++k) {
    const Eigen::VectorXd step = 1e-6 * Eigen::VectorXd::Unit(gradient.size(), k);
    gradient(k) = (log_distance(step) - log_distance(-step)) / 2e-6;
  }
  Eigen::MatrixXd joint(gradient.size(), gradient.size());
  const RowMajorMatrix mixed = block(view_block, view_size, point_block, point_size);
  joint << block(view_block, view_size, view_block, view_size), mixed, mixed.transpose(),
      block(point_block, point_size, point_block, point_size);
  const double sigma = std::sqrt(gradient.dot(joint * gradient));
  EXPECT_NEAR(covariance->log_distance_sigmas[observation] / sigma, 1, kSampled);
}

TEST_P(BundleCovarianceTest, OfTheFirstPoseIsZero) {
  const auto covariance = CovarianceOfBundle(input_, state_);
  ASSERT_TRUE(covariance.ok()) << covariance.status().message();
  EXPECT_EQ(covariance->poses.front().norm(), 0);
  EXPECT_GT(covariance->poses.back().norm(), 0);
}

INSTANTIATE_TEST_SUITE_P(Scenes, BundleCovarianceTest, testing::Values(0.0, 4.0));

}  // namespace
}  // namespace pliant
