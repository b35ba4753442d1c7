// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/first_map_error.h"

#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluation/truth_sequence.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using testing::HasSubstr;

constexpr double kNotFlat = 0.01;  // the truth is no plane before the camera, so the null has an error

// A frame with points at given depths before true ones, mm.
PairedFrame Depths(int frame_idx, const std::vector<std::pair<double, double>>& estimate_and_truth) {
  PairedFrame frame;
  frame.frame_idx = frame_idx;
  for (const auto& [estimate, truth] : estimate_and_truth)
    frame.pairs.push_back({{1, 2, estimate}, {3, 4, truth}, {0.1, 0.2, 1}});
  return frame;
}

std::vector<EvaluationFrame> Frames(FirstMapFrames first_map, int count = 10) {
  std::vector<EvaluationFrame> frames(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    EvaluationFrame& frame = frames[static_cast<std::size_t>(i)];
    frame.frame_idx = 5 + 2 * i;  // a run that began late and read every second frame
    frame.initialize_ms = frame.frame_idx <= first_map.declared_frame_idx ? 1 + i % 3 : 0;
    if (first_map.reference_frame_idx <= frame.frame_idx && frame.frame_idx <= first_map.declared_frame_idx)
      frame.first_map = first_map;
  }
  return frames;
}

FirstMapTruth Surface(const PairedFrame& frame) { return {frame, std::nullopt}; }

TEST(FirstMapError, GivesTheFiguresThatOneFindsByHand) {
  // Ratios 0.5, 1, 1, 1, 1.5 of half a millimeter a unit; the null's are 1 / 100, 1 / 100, 1 / 100, 1 / 100, 1 / 200.
  const PairedFrame declared = Depths(11, {{25, 100}, {50, 100}, {50, 100}, {50, 100}, {150, 200}});
  const auto error = ComputeFirstMapError(Frames({9, 11}), {}, Surface(declared));
  ASSERT_TRUE(error.ok()) << error.status().message();
  EXPECT_EQ(error->declared.frame_idx, 11);
  EXPECT_EQ(error->declared.points, 5);
  EXPECT_NEAR(error->declared.estimate.scale, 2, kRoundOff);
  EXPECT_NEAR(error->declared.estimate.median, 0, kRoundOff);
  EXPECT_NEAR(error->declared.estimate.rmse, std::sqrt((0.25 + 0.25) / 5), kRoundOff);
  EXPECT_NEAR(error->declared.estimate.p90, 0.5, kRoundOff);
  EXPECT_NEAR(error->declared.null.scale, 100, 100 * kRoundOff);
  EXPECT_NEAR(error->declared.null.rmse, std::sqrt(0.25 / 5), kRoundOff);
  // The errors are 0, 0, 0, 0, 0.5; 90 % are below what lies 0.6 of the way from the fourth to the fifth.
  EXPECT_NEAR(error->declared.null.p90, 0.6 * 0.5, kRoundOff);
  EXPECT_FALSE(error->reference);
  EXPECT_FALSE(error->motion);
}

TEST(FirstMapError, IsTheKnownErrorOfAWrongDepthWhateverTheScale) {
  for (const double scale : {1.0, 0.02, 700.0}) {
    std::vector<std::pair<double, double>> depths;
    for (int i = 0; i < 100; ++i) {
      const double truth = 30 + i;
      depths.emplace_back(scale * truth * (i % 2 == 0 ? 1.1 : 0.9), truth);
    }
    const auto error = ComputeFirstMapError(Frames({9, 11}), {}, Surface(Depths(11, depths)));
    ASSERT_TRUE(error.ok());
    EXPECT_NEAR(error->declared.estimate.median, 0.1, kRoundOff);  // the median ratio lies between the two: 1
    EXPECT_NEAR(error->declared.estimate.rmse, 0.1, kRoundOff);
    EXPECT_NEAR(error->declared.estimate.p90, 0.1, kRoundOff);
  }
}

TEST(FirstMapError, HasNoScaleWhereMostPointsLieBehindTheCamera) {
  const auto error = ComputeFirstMapError(Frames({9, 11}), {}, Surface(Depths(11, {{-50, 50}, {-50, 50}, {50, 50}})));
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->declared.estimate.scale, 1);
  EXPECT_NEAR(error->declared.estimate.median, 2, kRoundOff);
}

TEST(FirstMapError, CountsFramesAndTimeUpToTheDeclaration) {
  // Frames 5, 7, 9, 11, ...: one reference was given up, the next was frame 9; 1, 2, 3, 1, 2 ms until frame 13.
  const auto error =
      ComputeFirstMapError(Frames({9, 13}), Surface(Depths(9, {{50, 50}})), Surface(Depths(13, {{50, 50}})));
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->frames_waited, 2);
  EXPECT_EQ(error->frames_before, 4);
  EXPECT_EQ(error->initialize_total_ms, 9);
  EXPECT_EQ(error->initialize_largest_ms, 3);
  EXPECT_EQ(error->reference->frame_idx, 9);
}

TEST(FirstMapError, ComparesTheCamerasMotionByAngles) {
  PosePair reference;
  reference.true_world_from_cam = Rigid3(RotationExp({0.3, -0.2, 0.1}), Eigen::Vector3d(7, 8, 9));
  PosePair declared;
  // The true camera goes 4 mm along the reference's z and turns by 10 degrees about its x; the estimate turns by 12
  // degrees and goes 30 degrees off the z axis, in units of its own.
  declared.true_world_from_cam =
      reference.true_world_from_cam * Rigid3(RotationExp({10 * kDeg, 0, 0}), Eigen::Vector3d(0, 0, 4));
  declared.world_from_cam =
      Rigid3(RotationExp({12 * kDeg, 0, 0}), 0.1 * Eigen::Vector3d(std::sin(30 * kDeg), 0, std::cos(30 * kDeg)));
  const PairedFrame surface = Depths(11, {{50, 50}});
  const auto error = ComputeFirstMapError(Frames({9, 11}), {surface, reference}, {surface, declared});
  ASSERT_TRUE(error.ok() && error->motion);
  EXPECT_NEAR(error->motion->rotation_error_deg, 2, kAngleRoundOff_deg);
  EXPECT_NEAR(error->motion->true_rotation_deg, 10, kAngleRoundOff_deg);
  EXPECT_NEAR(*error->motion->direction_error_deg, 30, kAngleRoundOff_deg);
  EXPECT_NEAR(error->motion->true_translation_mm, 4, kAngleRoundOff_deg);

  declared.true_world_from_cam = reference.true_world_from_cam;  // the camera stood still: no direction
  const auto still = ComputeFirstMapError(Frames({9, 11}), {surface, reference}, {surface, declared});
  EXPECT_FALSE(still->motion->direction_error_deg);
  EXPECT_NEAR(still->motion->rotation_error_deg, 12, kAngleRoundOff_deg);
}

TEST(FirstMapError, OfAMapInItsFirstFrameHasNoWaitAndNoMotion) {
  const FirstMapTruth truth = {Depths(5, {{50, 50}, {60, 60}}), PosePair{}};
  const auto error = ComputeFirstMapError(Frames({5, 5}), truth, truth);
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->frames_waited, 0);
  EXPECT_EQ(error->frames_before, 0);
  EXPECT_FALSE(error->motion);
  EXPECT_EQ(error->reference->points, 2);
}

TEST(FirstMapError, SaysWhyThereIsNone) {
  const auto unknown = ComputeFirstMapError(std::vector<EvaluationFrame>(3), {}, {});
  EXPECT_EQ(unknown.status().code(), ErrorCode::kNotFound);
  EXPECT_THAT(unknown.status().message(), HasSubstr("does not say in which frame"));
  const auto no_depth = ComputeFirstMapError(Frames({9, 11}), {}, {});
  EXPECT_EQ(no_depth.status().code(), ErrorCode::kNotFound);
  PairedFrame empty;
  empty.left_out.depth_step = 7;
  const auto no_pair = ComputeFirstMapError(Frames({9, 11}), {}, Surface(empty));
  EXPECT_EQ(no_pair.status().code(), ErrorCode::kInsufficient);
  EXPECT_THAT(no_pair.status().message(),
              HasSubstr("in frame 11, in which it was made: of 7 observations 7 on a depth"));
}

TEST(FirstMapError, OfAnExactRunIsZeroInBothFramesWhateverTheScale) {
  const auto evaluation = Evaluate(MakeRun(8, 3, 0), TruthSequence(8), kNoMaterial, {});
  ASSERT_TRUE(evaluation.ok() && evaluation->first_map);
  const FirstMapError& error = *evaluation->first_map;
  EXPECT_EQ(error.declared.frame_idx, kFirstMap.declared_frame_idx);
  EXPECT_EQ(error.reference->frame_idx, kFirstMap.reference_frame_idx);
  EXPECT_EQ(error.declared.points + error.declared.left_out.Total(), 40);
  for (const FirstMapDepth& depth : {error.declared, *error.reference}) {
    EXPECT_LT(depth.estimate.p90, kRoundOff);
    EXPECT_LT(depth.estimate.rmse, kRoundOff);
    EXPECT_GT(depth.null.median, kNotFlat);
    EXPECT_NEAR(depth.estimate.scale, 3, 3 * kRoundOff);
  }
  EXPECT_LT(error.motion->rotation_error_deg, kAngleRoundOff_deg);
  EXPECT_LT(*error.motion->direction_error_deg, kAngleRoundOff_deg);
  EXPECT_EQ(error.frames_waited, 3);
  EXPECT_EQ(error.frames_before, 4);
}

TEST(FirstMapError, IsComputedAloneWhereItIsAskedForAlone) {
  EvaluationOptions options;
  options.parts = {EvaluationPart::kFirstMap};
  const auto evaluation = Evaluate(MakeRun(8, 1, 1), TruthSequence(8), kNoMaterial, options);
  ASSERT_TRUE(evaluation.ok()) << evaluation.status().message();
  EXPECT_TRUE(evaluation->first_map && !evaluation->surface && !evaluation->trajectory);
  const auto all = Evaluate(MakeRun(8, 1, 1), TruthSequence(8), kNoMaterial, {});
  EXPECT_EQ(evaluation->first_map->declared.estimate.rmse, all->first_map->declared.estimate.rmse);
  options.parts = {EvaluationPart::kSurface};
  EXPECT_FALSE(Evaluate(MakeRun(8, 1, 1), TruthSequence(8), kNoMaterial, options)->first_map);
  options.parts = {EvaluationPart::kFirstMap};
  const auto none =
      Evaluate(MakeRun(8, 1, 1), TruthSequence(8, TruthSequence::Truth::kPosesOnly), kNoMaterial, options);
  EXPECT_EQ(none.status().code(), ErrorCode::kNotFound);
  EXPECT_THAT(none.status().message(), HasSubstr("no first_map error: the sequence has no depth"));
}

}  // namespace
}  // namespace pliant
