// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/refinement/refine_recording.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "refinement/recorded_scene.h"

namespace pliant {
namespace {

using refinement_test::kNoisePx;
using refinement_test::RecordedScene;
using refinement_test::RecordingCamera;

constexpr double kRigidError = 0.002;    // noise of 0.05 px over some degrees of parallax
constexpr double kShareOfStart = 0.25;   // of its error; a scene that moves as fast as the camera keeps more than noise
constexpr double kNoiseAgreement = 0.2;  // the found noise: points and poses adapt to some of it
constexpr double kUnit = 1e-9;           // medians agree to rounding

Result<RefinedRecording> Refine(const Recording& start, const RefineOptions& options = {},
                                const RefinementCallback& callback = {}) {
  return RefineRecording(RecordingCamera(), start, options, callback);
}

TEST(RefineRecording, OfARigidSceneIsBundleAdjustment) {
  const RecordedScene scene(0);
  const auto refined = Refine(scene.Start());
  ASSERT_TRUE(refined.ok()) << refined.status().message();
  EXPECT_FALSE(refined->deforming);
  EXPECT_LT(scene.DepthError(refined->recording), kRigidError);
  EXPECT_NEAR(refined->noise_px, kNoisePx, kNoiseAgreement * kNoisePx);
}

TEST(RefineRecording, FindsDepthsOfASceneThatDeforms) {
  const RecordedScene scene;
  const Recording start = scene.Start();
  const auto refined = Refine(start);
  ASSERT_TRUE(refined.ok()) << refined.status().message();
  EXPECT_TRUE(refined->deforming);
  EXPECT_GT(refined->residual_correlation, RefineOptions().max_correlation);
  EXPECT_LT(scene.DepthError(refined->recording), kShareOfStart * scene.DepthError(start));
  EXPECT_NEAR(refined->noise_px, kNoisePx, kNoiseAgreement * kNoisePx);
}

TEST(RefineRecording, ARigidModelOfThatSceneDoesNot) {
  const RecordedScene scene;
  const Recording start = scene.Start();
  const auto refined = Refine(start, {.model = RefinementModel::kRigid});
  ASSERT_TRUE(refined.ok()) << refined.status().message();
  EXPECT_FALSE(refined->deforming);
  EXPECT_GT(refined->noise_px, 10 * kNoisePx);
}

TEST(RefineRecording, KeepsTheFirstPoseAndTheUnit) {
  const RecordedScene scene;
  const Recording start = scene.Start();
  const auto refined = Refine(start);
  ASSERT_TRUE(refined.ok()) << refined.status().message();
  const Rigid3 moved = refined->recording.cams_from_world.front() * start.cams_from_world.front().Inverse();
  EXPECT_LT(moved.translation.norm(), kUnit);
  EXPECT_LT(RotationAngle(moved.rotation), 1e-7);
  std::vector<double> ratios;
  for (std::size_t o = 0; o < start.observations.size(); ++o) {
    const auto view = static_cast<std::size_t>(start.observations[o].view_idx);
    if (refined->is_inlier[o])
      ratios.push_back((refined->recording.cams_from_world[view] * refined->recording.observations[o].position).norm() /
                       (start.cams_from_world[view] * start.observations[o].position).norm());
  }
  EXPECT_NEAR(Median(ratios), 1.0, kUnit);
}

// Share of the inliers whose error is within so many standard deviations.
double ShareWithin(double sigmas, const RecordedScene& scene, const RefinedRecording& refined) {
  const std::vector<double> errors = scene.LogDistanceErrors(refined.recording);
  double inliers = 0;
  double within = 0;
  for (std::size_t o = 0; o < errors.size(); ++o) {
    if (!refined.is_inlier[o]) continue;
    const RecordedObservation& observation = refined.recording.observations[o];
    const auto view = static_cast<std::size_t>(observation.view_idx);
    const double distance = (refined.recording.cams_from_world[view] * observation.position).norm();
    ++inliers;
    within += std::abs(errors[o]) * distance < sigmas * refined.sigmas[o] ? 1 : 0;
  }
  return within / inliers;
}

// A drift looks like parallax: the points' errors are larger than the residuals say.
TEST(RefineRecording, KnowsHowCertainItsPointsAreFromTracksThatDrift) {
  for (const double amplitude_mm : {0.0, 4.0}) {
    const RecordedScene scene(amplitude_mm);
    const auto refined = Refine(scene.Start(20 * kNoisePx));
    ASSERT_TRUE(refined.ok()) << refined.status().message();
    EXPECT_GT(ShareWithin(1, scene, *refined), 0.60) << amplitude_mm;
    EXPECT_GT(ShareWithin(2, scene, *refined), 0.91) << amplitude_mm;
    EXPECT_LT(ShareWithin(0.25, scene, *refined), 0.6) << "sigmas that are too large say nothing";
  }
}

TEST(RefineRecording, SolvesForFewerViewsAtOnceWhereTracksAreLong) {
  for (const double amplitude_mm : {0.0, 4.0}) {
    const RecordedScene scene(amplitude_mm);
    const Recording start = scene.Start();
    const auto all = Refine(start);
    const auto refined = Refine(start, {.max_rank = 3, .views_per_track = 10});
    ASSERT_TRUE(all.ok() && refined.ok());
    EXPECT_NE(all->recording.observations[0].position, refined->recording.observations[0].position);
    EXPECT_LT(scene.DepthError(refined->recording), 0.5 * scene.DepthError(start)) << amplitude_mm;
    for (std::size_t o = 0; o < start.observations.size(); ++o)
      ASSERT_EQ(refined->sigmas[o] > 0, static_cast<bool>(refined->is_inlier[o]));
  }
}

TEST(RefineRecording, OfThreeOrFourViewsHasNodesToo) {
  for (const int views : {3, 4}) {
    RecordedScene scene;
    scene.views = views;
    const Recording start = scene.Start();
    const auto refined = Refine(start, {.model = RefinementModel::kDeforming});
    ASSERT_TRUE(refined.ok()) << refined.status().message();
    EXPECT_GT(std::ranges::count(refined->is_inlier, true), std::ssize(start.observations) / 2);
  }
}

TEST(RefineRecording, NeedsPointsThatAreSeenOften) {
  RecordedScene scene;
  scene.views = 2;
  const auto refined = Refine(scene.Start());
  EXPECT_EQ(refined.status().code(), ErrorCode::kInsufficient);
}

TEST(RefineRecording, KnowsCertaintiesWhereTheFirstViewSeesNothing) {
  for (const double amplitude_mm : {0.0, 4.0}) {
    const RecordedScene scene(amplitude_mm);
    Recording start = scene.Start();
    std::erase_if(start.observations, [](const RecordedObservation& o) { return o.view_idx == 0; });
    const auto refined = Refine(start);
    ASSERT_TRUE(refined.ok()) << refined.status().message();
    EXPECT_EQ(refined->pose_covariances.size(), start.times.size());
    EXPECT_GT(std::ranges::max(refined->sigmas), 0.0);
  }
}

// Two points do not determine a pose.
TEST(RefineRecording, KnowsCertaintiesWhereAViewSeesNextToNothing) {
  for (const double amplitude_mm : {0.0, 4.0}) {
    const RecordedScene scene(amplitude_mm);
    Recording start = scene.Start();
    const auto whole = Refine(start);
    int left = 0;
    std::erase_if(start.observations, [&](const RecordedObservation& o) { return o.view_idx == 20 && ++left > 2; });
    const auto refined = Refine(start);
    ASSERT_TRUE(whole.ok() && refined.ok());
    EXPECT_EQ(refined->pose_covariances.size(), start.times.size());
    const auto median = [](std::vector<double> sigmas) {
      std::erase(sigmas, 0.0);
      return Median(sigmas);
    };
    EXPECT_NEAR(median(refined->sigmas) / median(whole->sigmas), 1.0, 0.1) << amplitude_mm;
    const auto away = [&](std::size_t view) {
      return Eigen::Vector3d((refined->recording.cams_from_world[view] * scene.poses[view].Inverse()).translation);
    };
    EXPECT_LT((away(20) - 0.5 * (away(19) + away(21))).norm(), 0.3) << "it goes along with the views beside it";
  }
}

TEST(RefineRecording, LeavesWrongTracksOut) {
  const RecordedScene scene;
  Recording start = scene.Start();
  Random random(9);
  const std::vector<int> wrong = {7, 30, 111};
  for (RecordedObservation& o : start.observations)  // along an edge, to and fro
    if (std::find(wrong.begin(), wrong.end(), o.point_idx) != wrong.end()) o.pixel.x() += random.Uniform(-6, 6);
  const auto refined = Refine(start);
  ASSERT_TRUE(refined.ok()) << refined.status().message();
  int left_out = 0;
  for (std::size_t o = 0; o < start.observations.size(); ++o) {
    const bool is_wrong = std::find(wrong.begin(), wrong.end(), start.observations[o].point_idx) != wrong.end();
    if (is_wrong) {
      EXPECT_FALSE(refined->is_inlier[o]) << "point " << start.observations[o].point_idx;
    }
    left_out += !is_wrong && !refined->is_inlier[o] ? 1 : 0;
  }
  EXPECT_LT(left_out, 0.02 * static_cast<double>(start.observations.size()));
}

// Of short tracks few views say nothing.
TEST(RefineRecording, LeavesWrongTracksOutThatAreShort) {
  const RecordedScene scene;
  Recording start = scene.Start();
  Random random(9);
  const std::vector<int> wrong = {60, 100, 140};
  std::erase_if(start.observations, [&](const RecordedObservation& o) {
    return std::find(wrong.begin(), wrong.end(), o.point_idx) != wrong.end() && (o.view_idx < 17 || o.view_idx > 20);
  });
  for (RecordedObservation& o : start.observations)
    if (std::find(wrong.begin(), wrong.end(), o.point_idx) != wrong.end()) o.pixel.x() += random.Uniform(-6, 6);
  const auto refined = Refine(start, {.max_rank = 3, .views_per_track = 12});
  ASSERT_TRUE(refined.ok()) << refined.status().message();
  int views = 0;
  for (std::size_t o = 0; o < start.observations.size(); ++o) {
    if (std::find(wrong.begin(), wrong.end(), start.observations[o].point_idx) == wrong.end()) continue;
    EXPECT_FALSE(refined->is_inlier[o]) << "point " << start.observations[o].point_idx;
    ++views;
  }
  EXPECT_GE(views, 8);
}

TEST(RefineRecording, GivesTheSameAgain) {
  const Recording start = RecordedScene().Start();
  const auto first = Refine(start);
  const auto second = Refine(start);
  ASSERT_TRUE(first.ok() && second.ok());
  for (std::size_t o = 0; o < start.observations.size(); ++o)
    ASSERT_EQ(first->recording.observations[o].position, second->recording.observations[o].position);
}

// What comes before may be further from the truth than the start.
TEST(RefineRecording, IsNothingUntilAllViewsWereSolvedForOnce) {
  const RecordedScene scene;
  const Recording start = scene.Start();
  for (const int after : {1, 4, 12}) {
    int iterations = 0;
    const auto refined = Refine(start, {.model = RefinementModel::kDeforming, .views_per_track = 10},
                                [&](const RefinementProgress& progress) {
                                  EXPECT_EQ(progress.stage, "deforming");
                                  return ++iterations < after;
                                });
    EXPECT_EQ(refined.status().code(), ErrorCode::kInterrupted) << after;
    EXPECT_EQ(iterations, after);
  }
}

TEST(RefineRecording, StopsWithTheSolutionOfFewerShapes) {
  const RecordedScene scene;
  const Recording start = scene.Start();
  const RefineOptions few = {.model = RefinementModel::kDeforming, .rank = 1, .max_rank = 1};
  int iterations = 0;
  const auto count = [&](const RefinementProgress& progress) {
    iterations += progress.stage == "deforming" ? 1 : 0;
    return true;
  };
  const auto with_few = Refine(start, few, count);
  ASSERT_TRUE(with_few.ok()) << with_few.status().message();
  const int in_few = iterations;
  iterations = 0;
  RefineOptions more = few;
  more.max_rank = 3;
  const auto stopped = Refine(start, more, [&](const RefinementProgress&) { return ++iterations < in_few + 3; });
  ASSERT_TRUE(stopped.ok()) << stopped.status().message();
  EXPECT_TRUE(stopped->stopped);
  for (std::size_t o = 0; o < start.observations.size(); ++o)
    ASSERT_EQ(stopped->recording.observations[o].position, with_few->recording.observations[o].position);
}

// With little parallax pixels say little; what was measured in one view holds all, and is the unit.
TEST(RefineRecording, MeasuredDistancesHoldTheSceneAndItsUnit) {
  constexpr int kMeasuredView = 7;
  RecordedScene scene;
  for (Rigid3& pose : scene.poses) pose.translation *= 0.05;
  Recording start = scene.Start();
  for (RecordedObservation& o : start.observations)
    if (o.view_idx == kMeasuredView) o.position = scene.At(o.point_idx, o.view_idx);
  const auto error_in_view = [&](const Recording& recording) {
    std::vector<double> errors;
    for (const RecordedObservation& o : recording.observations)
      if (o.view_idx == kMeasuredView)
        errors.push_back(std::abs(std::log((recording.cams_from_world[kMeasuredView] * o.position).norm() /
                                           (scene.poses[kMeasuredView] * scene.At(o.point_idx, o.view_idx)).norm())));
    return Median(errors);
  };
  start.measured_view_idx = kMeasuredView;
  for (const int views_per_track : {40, 8}) {
    const auto held = Refine(start, {.views_per_track = views_per_track});
    ASSERT_TRUE(held.ok()) << held.status().message();
    EXPECT_LT(error_in_view(held->recording), 0.008) << views_per_track;
  }
  start.measured_view_idx = -1;
  const auto free = Refine(start);
  ASSERT_TRUE(free.ok()) << free.status().message();
  EXPECT_GT(error_in_view(free->recording), 0.01);
}

// Pixels know little of the depths, and the solution goes along with the errors of what was measured.
TEST(RefineRecording, KnowsOfTheErrorsOfMeasuredDistancesThatItHasTakenUp) {
  RecordedScene scene(0);
  for (Rigid3& pose : scene.poses) pose.translation *= 0.02;
  Recording start = scene.Start(0.1);  // off by 4 %
  start.measured_view_idx = 7;
  const auto refined = Refine(start);
  ASSERT_TRUE(refined.ok()) << refined.status().message();
  const std::vector<double> errors = scene.LogDistanceErrors(refined->recording);
  std::vector<double> normalized;
  for (std::size_t o = 0; o < errors.size(); ++o) {
    if (!refined->is_inlier[o]) continue;
    const RecordedObservation& seen = refined->recording.observations[o];
    const Rigid3& pose = refined->recording.cams_from_world[static_cast<std::size_t>(seen.view_idx)];
    normalized.push_back(errors[o] * (pose * seen.position).norm() / refined->sigmas[o]);
  }
  ASSERT_GT(normalized.size(), errors.size() / 2);
  const double ratio = Rms(normalized);
  EXPECT_GT(ratio, 0.6);
  EXPECT_LT(ratio, 1.6);
}

// Wrong ones do not.
TEST(RefineRecording, WronglyMeasuredDistancesGiveWayToPixels) {
  const RecordedScene scene(0);
  Recording start = scene.Start();  // off by 4 % in every view
  start.measured_view_idx = 0;
  const auto refined = Refine(start);
  ASSERT_TRUE(refined.ok()) << refined.status().message();
  EXPECT_LT(scene.DepthError(refined->recording), 2 * kRigidError);
}

TEST(RefineRecording, IsNothingUntilItKnowsWhichModelIsTheScenes) {
  const auto refined = Refine(RecordedScene().Start(), {}, [](const RefinementProgress&) { return false; });
  EXPECT_EQ(refined.status().code(), ErrorCode::kInterrupted);
}

TEST(RefineRecording, SaysHowMuchIsDone) {
  const Recording start = RecordedScene(0).Start();  // rigid
  double share = 0.0;
  std::string_view last;
  const auto refined = Refine(start, {}, [&](const RefinementProgress& progress) {
    EXPECT_GE(progress.share, share);
    EXPECT_LE(progress.share, 1.0);
    share = progress.share;
    last = progress.stage;
    return true;
  });
  ASSERT_TRUE(refined.ok()) << refined.status().message();
  EXPECT_EQ(share, 1.0);
  EXPECT_EQ(last, "uncertainty");
}

TEST(RefineRecording, RefusesWhatIsNone) {
  const Recording start = RecordedScene(0).Start();
  Recording few = start;
  few.times.resize(1);
  few.cams_from_world.resize(1);
  std::erase_if(few.observations, [](const RecordedObservation& o) { return o.view_idx > 0; });
  EXPECT_EQ(Refine(few).status().code(), ErrorCode::kInsufficient);
  Recording unknown = start;
  unknown.observations.front().point_idx = 100000;
  EXPECT_EQ(Refine(unknown).status().code(), ErrorCode::kInvalidArgument);
  Recording nan = start;
  nan.observations.front().pixel.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Refine(nan).status().code(), ErrorCode::kInvalidArgument);
  Recording backwards = start;
  std::swap(backwards.times[3], backwards.times[4]);
  EXPECT_EQ(Refine(backwards).status().code(), ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace pliant
