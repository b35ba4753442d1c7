// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/trajectory_error.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "pliant/base/random.h"
#include "pliant/evaluation/track_survival.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

constexpr double kSummed_mm = 1e-8;     // lengths of 29 steps, summed
constexpr double kSampled_mm = 1e-6;    // extents of an ellipse of 50 mm that is sampled all around
constexpr double kWrongScale_mm = 5.0;  // the path is smaller by 0.4
constexpr double kDegPerRad = 180.0 / std::numbers::pi;

Rigid3 At(double x, double y, double z) { return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(x, y, z)}; }

// A true path and the same path as a run sees it: in another frame and scale.
std::vector<PosePair> MovedPath(const Sim3& run_from_truth) {
  Random random(11);
  std::vector<PosePair> pairs;
  for (int i = 0; i < 30; ++i) {
    const Rigid3 truth(RotationExp({random.Normal(0.3), random.Normal(0.3), random.Normal(0.3)}),
                       Eigen::Vector3d(2.0 * i, random.Normal(5), random.Normal(5)));
    pairs.push_back({i, {run_from_truth.rotation * truth.rotation, run_from_truth * truth.translation}, truth});
  }
  return pairs;
}

TEST(TrajectoryError, IsZeroForTheTruePathInAnotherFrameAndScale) {
  const auto error = ComputeTrajectoryError(MovedPath({0.4, RotationExp({1, -2, 0.5}), {7, 8, 9}}), {});
  ASSERT_TRUE(error.ok());
  EXPECT_LT(error->ate_rmse_mm, kLengthRoundOff_mm);
  EXPECT_LT(error->ate_max_mm, kLengthRoundOff_mm);
  EXPECT_LT(error->rotation_rmse_deg, kAngleRoundOff_deg);
  EXPECT_LT(error->rpe_translation_rmse_mm, kLengthRoundOff_mm);
  EXPECT_LT(error->rpe_rotation_rmse_deg, kAngleRoundOff_deg);
  EXPECT_NEAR(error->truth_from_run.scale, 2.5, kLengthRoundOff_mm);
  EXPECT_NEAR(error->path_length_mm, error->true_path_length_mm, kSummed_mm);
  EXPECT_EQ(error->rpe_pairs, 29);
}

// True positions on an ellipse; the run's differ by `error_mm` across it, now up, now down.
TrajectoryError OfEllipse(double half_length_mm, double half_width_mm, double error_mm) {
  std::vector<PosePair> pairs;
  for (int i = 0; i < 40; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 40;
    const double x = half_length_mm * std::cos(angle);
    const double y = half_width_mm * std::sin(angle);
    pairs.push_back({i, At(x, y, i % 2 == 0 ? error_mm : -error_mm), At(x, y, 0)});
  }
  const auto error = ComputeTrajectoryError(pairs, {});
  EXPECT_TRUE(error.ok());
  return error.ok() ? *error : TrajectoryError();
}

TEST(TrajectoryError, TheTurnAboutANearlyStraightPathIsUnknown) {
  const TrajectoryError straight = OfEllipse(50, 0.5, 0.3);
  EXPECT_NEAR(straight.true_path_extent_mm, 50 / std::numbers::sqrt2, kSampled_mm);
  EXPECT_NEAR(straight.true_path_width_mm, 0.5 / std::numbers::sqrt2, kSampled_mm);
  EXPECT_TRUE(straight.TurnIsUnknown());
  EXPECT_FALSE(OfEllipse(50, 0.5, 0.01).TurnIsUnknown()) << "the path is known well enough";
  EXPECT_FALSE(OfEllipse(10, 10, 6).TurnIsUnknown()) << "a circle is not straight, however wrong the run";
}

TEST(TrajectoryError, AlignsEverySubmapByItself) {
  auto pairs = MovedPath({0.4, RotationExp({1, -2, 0.5}), {7, 8, 9}});
  const auto other = MovedPath({1.7, RotationExp({-1, 0.2, 0.5}), {-70, 8, 0}});
  const std::size_t size = pairs.size();
  for (std::size_t i = 0; i < size; ++i)
    if (i % 10 >= 6) {  // goes and comes back, several times
      pairs[i] = other[i];
      pairs[i].submap = 1;
    }
  pairs.back().submap = 2;  // too short to be aligned
  const auto error = ComputeTrajectoryError(pairs, {});
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->submaps, 2);
  EXPECT_EQ(error->poses, static_cast<int>(size) - 1);
  EXPECT_LT(error->ate_max_mm, kLengthRoundOff_mm);
  EXPECT_NEAR(error->truth_from_run.scale, 2.5, kLengthRoundOff_mm);  // of the one with more poses
  EXPECT_NEAR(error->path_length_mm, error->true_path_length_mm, kSummed_mm);
}

TEST(TrajectoryError, CountsAWrongScaleUnderSe3) {
  const auto pairs = MovedPath({0.4, RotationExp({1, -2, 0.5}), {7, 8, 9}});
  const auto error = ComputeTrajectoryError(pairs, {.alignment = TrajectoryAlignment::kSe3});
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->truth_from_run.scale, 1.0);
  EXPECT_GT(error->ate_rmse_mm, kWrongScale_mm);
}

// By hand: true centers (+-1, 0, 0), (0, +-1, 0); estimates (+-2, 0, 0), (0, +-1, 0). Both are centered and the best
// rotation is none. The best scale is sum(a.b) / sum(a.a) = (2 + 2 + 1 + 1) / (4 + 4 + 1 + 1) = 0.6, which leaves
// 0.2 twice and 0.4 twice: RMSE sqrt(0.1). With the scale fixed at 1 it leaves 1, 1, 0, 0: sqrt(0.5).
TEST(TrajectoryError, MatchesACaseWorkedByHand) {
  const std::vector<PosePair> pairs = {{0, At(2, 0, 0), At(1, 0, 0)},
                                       {1, At(0, 1, 0), At(0, 1, 0)},
                                       {2, At(-2, 0, 0), At(-1, 0, 0)},
                                       {3, At(0, -1, 0), At(0, -1, 0)}};
  const auto sim3 = ComputeTrajectoryError(pairs, {});
  ASSERT_TRUE(sim3.ok());
  EXPECT_NEAR(sim3->ate_rmse_mm, std::sqrt(0.1), kLengthRoundOff_mm);
  EXPECT_NEAR(sim3->ate_median_mm, 0.3, kLengthRoundOff_mm);
  EXPECT_NEAR(sim3->ate_max_mm, 0.4, kLengthRoundOff_mm);
  EXPECT_NEAR(sim3->ate_min_mm, 0.2, kLengthRoundOff_mm);
  EXPECT_NEAR(sim3->ate_mean_mm, 0.3, kLengthRoundOff_mm);
  EXPECT_NEAR(sim3->ate_std_mm, 0.1, kLengthRoundOff_mm);
  EXPECT_NEAR(sim3->true_path_length_mm, 3 * std::sqrt(2.0), kLengthRoundOff_mm);
  const auto se3 = ComputeTrajectoryError(pairs, {.alignment = TrajectoryAlignment::kSe3});
  ASSERT_TRUE(se3.ok());
  EXPECT_NEAR(se3->ate_rmse_mm, std::sqrt(0.5), kLengthRoundOff_mm);
}

// One pose of the path turned in place by a known angle: it spoils two relative rotations of 29 and one absolute one.
TEST(TrajectoryError, RelativeErrorSeesOneTurnedPoseTwice) {
  std::vector<PosePair> pairs = MovedPath({1, Eigen::Quaterniond::Identity(), {0, 0, 0}});
  pairs[10].world_from_cam.rotation = pairs[10].world_from_cam.rotation * RotationExp({0, 0, 0.1});
  const auto error = ComputeTrajectoryError(pairs, {});
  ASSERT_TRUE(error.ok());
  EXPECT_LT(error->ate_rmse_mm, kLengthRoundOff_mm);
  EXPECT_NEAR(error->rotation_rmse_deg, 0.1 * kDegPerRad / std::sqrt(30.0), kAngleRoundOff_deg);
  EXPECT_NEAR(error->rpe_rotation_rmse_deg, 0.1 * kDegPerRad * std::sqrt(2.0 / 29.0), kAngleRoundOff_deg);
  EXPECT_NEAR(error->rpe_rotation_mean_deg, 0.1 * kDegPerRad * 2.0 / 29.0, kAngleRoundOff_deg);
  const auto far = ComputeTrajectoryError(pairs, {.rpe_delta = 29});
  EXPECT_EQ(far->rpe_pairs, 1);
  EXPECT_LT(far->rpe_rotation_rmse_deg, kAngleRoundOff_deg);
}

// One pose of ten turned in place. Of all pairs four frames apart it spoils two; of those that do not overlap, 0 to 4
// and 4 to 8, both if it is where they meet, none if it is beside.
TEST(TrajectoryError, RelativePairsOverlapOnlyWhereAskedTo) {
  const auto spoiled = [](std::size_t turned, RelativePairs rpe_pairs) {
    std::vector<PosePair> pairs = MovedPath({1, Eigen::Quaterniond::Identity(), {0, 0, 0}});
    pairs.resize(10);
    pairs[turned].world_from_cam.rotation = pairs[turned].world_from_cam.rotation * RotationExp({0, 0, 0.1});
    const auto error = ComputeTrajectoryError(pairs, {.rpe_delta = 4, .rpe_pairs = rpe_pairs});
    EXPECT_EQ(error->rpe_pairs, rpe_pairs == RelativePairs::kAll ? 6 : 2);
    return error->rpe_rotation_rmse_deg / (0.1 * kDegPerRad);
  };
  EXPECT_NEAR(spoiled(4, RelativePairs::kConsecutive), 1, kAngleRoundOff_deg);
  EXPECT_NEAR(spoiled(5, RelativePairs::kConsecutive), 0, kAngleRoundOff_deg);
  EXPECT_NEAR(spoiled(5, RelativePairs::kAll), std::sqrt(2.0 / 6), kAngleRoundOff_deg);
}

TEST(TrajectoryError, RefusesTooFewPosesAndACameraThatStandsStill) {
  std::vector<PosePair> pairs = MovedPath({1, Eigen::Quaterniond::Identity(), {0, 0, 0}});
  EXPECT_EQ(ComputeTrajectoryError(std::span(pairs).first(2), {}).status().code(), ErrorCode::kInsufficient);
  for (PosePair& pair : pairs) pair.true_world_from_cam.translation.setConstant(3);
  EXPECT_EQ(ComputeTrajectoryError(pairs, {}).status().code(), ErrorCode::kDegenerate);
}

TEST(TrackSurvival, APointThatIsFoundAgainWasAliveInBetween) {
  const std::vector<FrameTracks> frames = {
      {0, true, {{0}, {1}}}, {1, true, {{0}}}, {2, false, {}}, {3, true, {{0}}}, {4, true, {{0}, {1}}}};
  const TrackSurvival survival = ComputeTrackSurvival(frames);
  EXPECT_EQ(survival.alive_shares, (std::array<double, 4>{1, 1, 1, 1}));
  EXPECT_EQ(survival.frames[3].alive_of_first, 1);
}

TEST(TrackSurvival, CountsInterruptionsAndWhatCameBack) {
  const std::vector<FrameTracks> frames = {{0, false, {}},           {1, true, {{0}, {1}}, 0},
                                           {2, true, {{0}, {2}}, 0},                    // 1 is missing
                                           {3, true, {{0}, {1}}, 0},                    // and comes back
                                           {4, false, {}},                              // survived
                                           {5, true, {{0}, {2}}, 0},                    // 0 was not missing, 2 was
                                           {6, false, {}},           {7, false, {}},    // another map follows
                                           {8, true, {{8}}, 1},      {9, false, {}},    // the first map is found again
                                           {10, true, {{1}}, 0},     {11, false, {}}};  // the end
  const TrackSurvival survival = ComputeTrackSurvival(frames);
  EXPECT_EQ(survival.submaps, 2);
  EXPECT_EQ(survival.interruptions, 4);
  EXPECT_EQ(survival.interruptions_survived, 1);
  EXPECT_EQ(survival.returned_points, 2);
}

TEST(TrackSurvival, CountsPointsTracksAndFrames) {
  const auto ids = [](const std::vector<int>& values) {
    std::vector<PointId> result;
    for (const int value : values) result.push_back({value});
    return result;
  };
  const std::vector<FrameTracks> frames = {{3, false, {}},
                                           {4, true, ids({0, 1, 2, 3})},
                                           {5, true, ids({0, 2, 3, 7})},
                                           {6, true, ids({3, 7})},
                                           {7, false, {}}};
  const TrackSurvival survival = ComputeTrackSurvival(frames);
  EXPECT_EQ(survival.frames_read, 5);
  EXPECT_EQ(survival.frames_tracked, 3);
  EXPECT_EQ(survival.first_points, 4);
  EXPECT_EQ(survival.last_points, 2);
  EXPECT_NEAR(survival.mean_points, 10 / 3.0, kLengthRoundOff_mm);
  EXPECT_EQ(survival.last_alive_of_first, 1);
  EXPECT_EQ(survival.tracks, 5);
  EXPECT_EQ(survival.median_track_length, 2);  // lengths 2, 1, 2, 3, 2
  EXPECT_EQ(survival.frames[2].alive_of_first, 3);
  // Frames 4 to 7: places 1, 2, 2 and 3 of the way (0.75, 1.5, 2.25 and 3 frames, rounded).
  EXPECT_EQ(survival.alive_shares, (std::array<double, 4>{0.75, 0.25, 0.25, 0}));
}

}  // namespace
}  // namespace pliant
