// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "calibration/board_problem.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "support/board_views.h"

namespace pliant {
namespace {

TEST(BoardProblem, WidensWhatFewGroupsSayByStudentsT) {
  constexpr double kOneSigma = 0.682689;  // share of a normal distribution within a standard deviation
  constexpr double kOfTheTable = 1e-3;
  // The quantiles of one and two degrees of freedom have a closed form.
  EXPECT_NEAR(StudentFactor(2), std::tan(0.5 * std::numbers::pi * kOneSigma), kOfTheTable);
  EXPECT_NEAR(StudentFactor(3), kOneSigma * std::sqrt(2 / (1 - kOneSigma * kOneSigma)), kOfTheTable);
  for (int groups = 3; groups <= kMaxGroups; ++groups) EXPECT_LT(StudentFactor(groups), StudentFactor(groups - 1));
  EXPECT_GT(StudentFactor(kMaxGroups), 1);
}

TEST(BoardProblem, KnowsTheCovarianceOfWhatIsFreeOnly) {
  const Camera camera = Camera::Create("SIMPLE_RADIAL", 640, 480, std::vector<double>{500, 320, 240, -0.1}).value();
  const auto poses = VariedBoardPoses(kChessboard9x6, camera, 8, 4);
  const std::vector<BoardView> views = ViewsOf(kChessboard9x6, camera, poses, 0.1, 1);
  BoardFit fit{camera.model_id(), {camera.params().begin(), camera.params().end()}, 1, {}};
  for (const Rigid3& pose : poses) fit.poses.push_back(ToBoardPose(pose));
  const Eigen::MatrixXd of_focal_length = Covariance(kChessboard9x6.Points(), views, {}, fit);
  fit.num_free = 4;
  const Eigen::MatrixXd of_all = Covariance(kChessboard9x6.Points(), views, {}, fit);
  ASSERT_EQ(of_focal_length.rows(), 4);
  EXPECT_GT(of_focal_length(0, 0), 0);
  EXPECT_EQ(of_focal_length(1, 1), 0);
  EXPECT_GT(of_all(0, 0), of_focal_length(0, 0));  // what is held adds nothing to what is not known
  EXPECT_LT((of_all - of_all.transpose()).norm(), 1e-12 * of_all.norm());
  EXPECT_LT(std::sqrt(of_all(0, 0)), 5);  // 1 % of the focal length
}

}  // namespace
}  // namespace pliant
