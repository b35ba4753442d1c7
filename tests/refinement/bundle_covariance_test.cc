// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "refinement/bundle_covariance.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/SparseCore>
#include <ceres/cost_function.h>
#include <ceres/crs_matrix.h>
#include <gtest/gtest.h>

#include "pliant/base/statistics.h"
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

// Derivatives by all numbers that Ceres solves for, one after another.
class Variables {
 public:
  explicit Variables(const BundleProblem& problem) : problem_(problem) {
    for (const auto* const all : {&problem.views(), &problem.nodes(), &problem.points()})
      for (double* const block : *all)
        if (problem.terms().HasParameterBlock(block) && !problem.terms().IsParameterBlockConstant(block)) Add(block);
  }

  // J^T J of all terms.
  Eigen::MatrixXd Normal() const {
    ceres::Problem::EvaluateOptions options;
    options.parameter_blocks = blocks_;
    ceres::CRSMatrix jacobian;
    EXPECT_TRUE(problem_.terms().Evaluate(options, nullptr, nullptr, nullptr, &jacobian));
    const Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>> sparse(
        jacobian.num_rows, jacobian.num_cols, static_cast<Eigen::Index>(jacobian.values.size()), jacobian.rows.data(),
        jacobian.cols.data(), jacobian.values.data());
    return Eigen::MatrixXd(sparse.transpose() * sparse);
  }

  // By small steps. The first view has no pose to solve for.
  Eigen::VectorXd Gradient(const std::function<double()>& value, const std::vector<double*>& of_blocks) const {
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size_);
    for (double* const block : of_blocks) {
      const auto found = std::ranges::find(blocks_, block);
      if (found == blocks_.end()) continue;
      const int first = begins_[static_cast<std::size_t>(found - blocks_.begin())];
      const int held = problem_.terms().ParameterBlockSize(block) - problem_.terms().ParameterBlockTangentSize(block);
      for (int k = held; k < problem_.terms().ParameterBlockSize(block); ++k) {
        constexpr double kStep = 1e-6;
        const double before = block[k];
        block[k] = before + kStep;
        const double above = value();
        block[k] = before - kStep;
        gradient(first + k - held) = (above - value()) / (2 * kStep);
        block[k] = before;
      }
    }
    return gradient;
  }

 private:
  void Add(double* block) {
    blocks_.push_back(block);
    begins_.push_back(size_);
    size_ += problem_.terms().ParameterBlockTangentSize(block);
  }

  const BundleProblem& problem_;
  std::vector<double*> blocks_;
  std::vector<int> begins_;
  int size_ = 0;
};

// The normal equations solved at once, for the log distance of a point and for cameras, in the unit of the points.
TEST_P(BundleCovarianceTest, IsThatOfTheNormalEquations) {
  const BundleProblem problem(input_, &state_);
  const auto covariance = ComputeCovariance(problem, start_);
  ASSERT_TRUE(covariance.ok()) << covariance.status().message();
  const Variables variables(problem);
  const Eigen::LLT<Eigen::MatrixXd> normal(variables.Normal());
  const auto sigma = [&](const Eigen::VectorXd& gradient) { return std::sqrt(gradient.dot(normal.solve(gradient))); };

  const auto pose = [&](std::size_t view) {
    return problem.poses()[view].Pose(Eigen::Map<const Vector6d>(problem.views()[view]));
  };
  const auto log_distance_gradient = [&](std::size_t point, std::size_t view) {
    const auto log_distance = [&] {
      Eigen::Vector3d position = Eigen::Map<const Eigen::Vector3d>(problem.points()[point]);
      for (int r = 0; r < problem.rank(); ++r)
        position += problem.views()[view][6 + r] *
                    Eigen::Map<const Eigen::Vector3d>(problem.points()[point] + 3 + static_cast<std::ptrdiff_t>(3) * r);
      return std::log((pose(view) * position).norm());
    };
    return variables.Gradient(log_distance, {problem.views()[view], problem.points()[point]});
  };

  std::vector<std::vector<int>> views_of_point(start_.rest_positions.size());
  for (const RecordedObservation& o : start_.observations)
    views_of_point[static_cast<std::size_t>(o.point_idx)].push_back(o.view_idx);
  Eigen::VectorXd unit =
      log_distance_gradient(0, static_cast<std::size_t>(views_of_point[0][views_of_point[0].size() / 2]));
  int points = 1;
  for (std::size_t i = 1; i < views_of_point.size(); ++i) {
    if (views_of_point[i].empty()) continue;
    unit += log_distance_gradient(i, static_cast<std::size_t>(views_of_point[i][views_of_point[i].size() / 2]));
    ++points;
  }
  unit /= points;

  const std::size_t observation = start_.observations.size() / 2;
  const RecordedObservation& seen = start_.observations[observation];
  EXPECT_NEAR(covariance->log_distance_sigmas[observation] /
                  sigma(log_distance_gradient(static_cast<std::size_t>(seen.point_idx),
                                              static_cast<std::size_t>(seen.view_idx)) -
                        unit),
              1, kSampled);
  for (const std::size_t view : {1U, 17U, 39U})
    for (int k = 0; k < 3; ++k) {
      const auto center = [&] { return pose(view).OriginInSource()(k); };
      const double from_first = center() - pose(0).OriginInSource()(k);
      const Eigen::VectorXd gradient = variables.Gradient(center, {problem.views()[view]}) - from_first * unit;
      EXPECT_NEAR(std::sqrt(covariance->poses[view](k, k)) / sigma(gradient), 1, kSampled) << view << ", " << k;
      const auto turn = [&] { return problem.views()[view][k]; };
      EXPECT_NEAR(
          std::sqrt(covariance->poses[view](3 + k, 3 + k)) / sigma(variables.Gradient(turn, {problem.views()[view]})),
          1, kSampled)
          << view << ", " << k;
    }
}

TEST_P(BundleCovarianceTest, OfTheFirstPoseIsZero) {
  const auto covariance = CovarianceOfBundle(input_, state_);
  ASSERT_TRUE(covariance.ok()) << covariance.status().message();
  EXPECT_EQ(covariance->poses.front().norm(), 0);
  EXPECT_GT(covariance->poses.back().norm(), 0);
}

// (F9) The unit is the run's: that the pixels do not know it makes no depth uncertain.
TEST_P(BundleCovarianceTest, TheUnitIsKnown) {
  input_.sigmas.log_distance = 1;
  const auto covariance = CovarianceOfBundle(input_, state_);
  input_.sigmas.log_distance = 30;
  const auto without_unit = CovarianceOfBundle(input_, state_);
  ASSERT_TRUE(covariance.ok() && without_unit.ok());
  EXPECT_NEAR(Median(without_unit->log_distance_sigmas) / Median(covariance->log_distance_sigmas), 1, 0.1);
  const auto center_sigma = [](const BundleCovariance& of) {
    return std::sqrt(of.poses.back().topLeftCorner<3, 3>().trace());
  };
  EXPECT_NEAR(center_sigma(*without_unit) / center_sigma(*covariance), 1, 0.1);
}

TEST_P(BundleCovarianceTest, SaysWhatTheSolutionLeavesOfMeasuredDistances) {
  start_.measured_view_idx = 5;
  const BundleProblem problem(input_, &state_);
  const auto residuals = MeasuredResiduals(problem);
  ASSERT_TRUE(residuals.ok()) << residuals.status().message();
  ASSERT_EQ(residuals->size(), problem.measured_distances().size());
  ASSERT_GT(residuals->size(), 50U);
  const Variables variables(problem);
  const Eigen::LLT<Eigen::MatrixXd> normal(variables.Normal());
  for (std::size_t k = 0; k < residuals->size(); k += 25) {
    const ceres::ResidualBlockId term = problem.measured_distances()[k];
    std::vector<double*> blocks;
    problem.terms().GetParameterBlocksForResidualBlock(term, &blocks);
    const auto residual = [&] {
      double value = 0;
      EXPECT_TRUE(problem.terms().GetCostFunctionForResidualBlock(term)->Evaluate(blocks.data(), &value, nullptr));
      return value;
    };
    EXPECT_EQ((*residuals)[k].residual, residual());
    const Eigen::VectorXd gradient = variables.Gradient(residual, blocks);
    const double taken = gradient.dot(normal.solve(gradient));
    EXPECT_NEAR((1 - (*residuals)[k].left_share) / taken, 1, 2 * kSampled) << k;  // variances: twice as far off
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, BundleCovarianceTest, testing::Values(0.0, 4.0));

}  // namespace
}  // namespace pliant
