// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Runs made by hand with known differences of depth, against each other and against points of structure from motion.
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pliant/evaluation/evaluate_run.h"
#include "pliant/evaluation/report.h"
#include "pliant/evaluation/run_consistency.h"
#include "pliant/evaluation/sfm_error.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using testing::HasSubstr;

constexpr int kWidth_px = 1000;
constexpr int kPoints = 11;

// Point i of a frame is at pixel (20 i, 50), at this depth: 10, 11, ... 20.
double DepthOf(int i) { return 10 + i; }

// Frames from `first` on, seen by cameras that turn and move.
EvaluationInput MadeRun(const std::string& name, int first, int frames, double (*depth)(int point)) {
  EvaluationInput run;
  run.name = name;
  for (int k = 0; k < frames; ++k) {
    EvaluationFrame& frame = run.frames.emplace_back();
    frame.frame_idx = first + k;
    frame.cam_from_world = Rigid3(RotationExp({0.1 * k, 0.2, -0.1 * k}), Eigen::Vector3d(k, 2, -k));
    for (int i = 0; i < kPoints; ++i) {
      const Eigen::Vector3d in_cam(0.01 * i * depth(i), 0, depth(i));
      frame.observations.push_back({PointId{i}, {20.0 * i, 50}, frame.cam_from_world->Inverse() * in_cam, 1});
    }
  }
  return run;
}

double MedianDeviation(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const double center = values[values.size() / 2];
  for (double& value : values) value = std::abs(value - center);
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

std::vector<double> LogDepths() {
  std::vector<double> logs;
  for (int i = 0; i < kPoints; ++i) logs.push_back(std::log(DepthOf(i)));
  return logs;
}

TEST(CompareRuns, IsZeroForRunsThatDifferInScaleAlone) {
  const EvaluationInput run = MadeRun("a", 0, 5, DepthOf);
  const EvaluationInput other = MadeRun("b", 2, 5, [](int i) { return 7 * DepthOf(i); });
  const auto error = CompareRuns(run, other, kWidth_px, {});
  ASSERT_TRUE(error.ok()) << error.status().message();
  EXPECT_EQ(error->frames.size(), 3U);  // 2, 3, 4
  EXPECT_EQ(error->frames.front().frame_idx, 2);
  EXPECT_EQ(error->points, 3 * kPoints);
  EXPECT_NEAR(error->difference, 0, kRoundOff);
  EXPECT_NEAR(error->null, MedianDeviation(LogDepths()), kRoundOff);
}

// Three of eleven points that differ move no median; where all points differ, it is their median difference.
TEST(CompareRuns, MeasuresTheDifferenceOfMoreThanHalfOfThePoints) {
  const EvaluationInput run = MadeRun("a", 0, 3, DepthOf);
  const auto three = MadeRun("b", 0, 3, [](int i) { return DepthOf(i) * (i < 3 ? 1.1 : 1.0); });
  EXPECT_NEAR(CompareRuns(run, three, kWidth_px, {})->difference, 0, kRoundOff);
  // Deviations of -2, -1, 0, 1 and 2 tenths, two points or three each.
  const auto spread = MadeRun("b", 0, 3, [](int i) { return DepthOf(i) * std::exp(0.1 * ((i % 5) - 2)); });
  const auto error = CompareRuns(run, spread, kWidth_px, {});
  EXPECT_NEAR(error->difference, 0.1, kRoundOff);
  const auto exchanged = CompareRuns(spread, run, kWidth_px, {});
  EXPECT_NEAR(exchanged->difference, error->difference, kRoundOff) << "which run is the other one does not matter";
}

// What another program leaves is often a camera path alone.
TEST(AddConsistency, ComparesTheCameraPathsOfRunsWithoutCommonPoints) {
  const EvaluationInput run = MadeRun("a", 0, 5, DepthOf);
  EvaluationInput path = MadeRun("b", 0, 5, DepthOf);
  for (EvaluationFrame& frame : path.frames) frame.observations.clear();
  Evaluation evaluation;
  ASSERT_TRUE(AddConsistency(run, path, kWidth_px, {}, &evaluation).ok());
  const RunConsistency& compared = evaluation.consistency.at(0);
  EXPECT_FALSE(compared.depths.has_value());
  ASSERT_TRUE(compared.path.has_value());
  EXPECT_EQ(compared.path->poses, 5);
  EXPECT_NEAR(compared.path->AteShare(), 0, kRoundOff);
  const auto json = nlohmann::json::parse(EvaluationJson(evaluation));
  EXPECT_EQ(json["consistency"][0]["frames_compared"], 0);
  EXPECT_FALSE(json["consistency"][0].contains("estimate"));
  EXPECT_THAT(EvaluationTable(evaluation), HasSubstr("camera path: 0.00 %"));
  for (EvaluationFrame& frame : path.frames) frame.cam_from_world = Rigid3();  // a camera that never moves
  EXPECT_EQ(AddConsistency(run, path, kWidth_px, {}, &evaluation).code(), ErrorCode::kInsufficient);
}

TEST(CompareRuns, FindsTheFramesOfARunThatWentBackwards) {
  const EvaluationInput run = MadeRun("a", 0, 4, DepthOf);
  EvaluationInput other = MadeRun("b", 0, 4, DepthOf);
  for (EvaluationFrame& frame : other.frames)  // as if the depths grew with the frame
    for (PointObservation& seen : frame.observations)
      if (seen.id.value % 2 == frame.frame_idx / 2) seen.pixel.x() += 100000;
  const auto same = CompareRuns(run, other, kWidth_px, {.min_points = 1});
  const auto reversed = CompareRuns(run, other, kWidth_px, {.min_points = 1, .order = FrameOrder::kReversed});
  ASSERT_TRUE(same.ok() && reversed.ok());
  EXPECT_EQ(same->frames.front().points, 5);  // the odd ones
  EXPECT_EQ(reversed->frames.front().points, 6);
}

TEST(CompareRuns, ComparesOnlyWhatIsAtTheSamePixelsAndBeforeTheCamera) {
  const EvaluationInput run = MadeRun("a", 0, 3, DepthOf);
  EvaluationInput moved = MadeRun("b", 0, 3, DepthOf);
  for (EvaluationFrame& frame : moved.frames)
    for (PointObservation& seen : frame.observations) seen.pixel.y() += 0.011 * kWidth_px;
  const auto far = CompareRuns(run, moved, kWidth_px, {});
  EXPECT_EQ(far.status().code(), ErrorCode::kInsufficient);
  EXPECT_THAT(far.status().message(), HasSubstr("the runs a and b have 3 tracked frames in common"));
  EXPECT_EQ(CompareRuns(run, moved, kWidth_px, {.max_distance = 0.012})->points, 3 * kPoints);
  const auto behind = MadeRun("b", 0, 3, [](int i) { return i == 4 ? -1.0 : DepthOf(i); });
  EXPECT_EQ(CompareRuns(run, behind, kWidth_px, {})->points, 3 * (kPoints - 1));
}

// The run's cameras go along a parabola.
void MoveCameras(double scale, double last_step, EvaluationInput* run) {
  for (std::size_t k = 0; k < run->frames.size(); ++k) {
    const double x = static_cast<double>(k) + (k + 1 == run->frames.size() ? last_step : 0.0);
    const Rigid3 world_from_cam(Eigen::Quaterniond::Identity(), scale * Eigen::Vector3d(x, 0.1 * x * x, 0));
    run->frames[k].cam_from_world = world_from_cam.Inverse();
  }
}

TEST(CompareCameraPaths, IsTheErrorAfterASimilarityOfFramesOfTheSameSubmaps) {
  EvaluationInput run = MadeRun("a", 0, 10, DepthOf);
  EvaluationInput other = MadeRun("b", 0, 10, DepthOf);
  MoveCameras(1, 0, &run);
  MoveCameras(3, 0, &other);
  const auto same = CompareCameraPaths(run, other, {}, {});
  ASSERT_TRUE(same.ok()) << same.status().message();
  EXPECT_EQ(same->poses, 10);
  EXPECT_NEAR(same->AteShare(), 0, kRoundOff);
  EXPECT_NEAR(same->RpeShare(), 0, kRoundOff);
  MoveCameras(3, 0.5, &other);
  const auto apart = CompareCameraPaths(run, other, {}, {});
  ASSERT_TRUE(apart.ok());
  EXPECT_GT(apart->AteShare(), 0.005);
  EXPECT_GT(apart->RpeShare(), 0.05);
  for (std::size_t k = 5; k < 10; ++k) other.frames[k].submap = 1;
  EXPECT_EQ(CompareCameraPaths(run, other, {}, {})->submaps, 2);
  EXPECT_EQ(CompareCameraPaths(run, MadeRun("c", 0, 2, DepthOf), {}, {}).status().code(), ErrorCode::kInsufficient);
}

// Reconstructed points at the run's pixels, and one far from all of them.
SfmPoints Reconstructed(int frames, double (*depth)(int point)) {
  SfmPoints sfm;
  for (int k = 0; k < frames; ++k) {
    for (int i = 0; i < kPoints; ++i) sfm[k].push_back({{20.0 * i, 50}, depth(i)});
    sfm[k].push_back({{20, 500}, 1});
  }
  return sfm;
}

TEST(ComputeSfmError, IsZeroForThePointsThemselvesAndHasTheNullOfTheTruth) {
  const EvaluationInput run = MadeRun("a", 0, 4, [](int i) { return 3 * DepthOf(i); });
  SfmErrorOptions options;
  options.max_third_distance = 0.015;  // points are 20 px apart: none is averaged with its neighbors
  const auto error = ComputeSfmError(run, Reconstructed(3, DepthOf), kWidth_px, options);
  ASSERT_TRUE(error.ok()) << error.status().message();
  EXPECT_EQ(error->frames.size(), 3U);
  EXPECT_EQ(error->points, 3 * kPoints);
  EXPECT_NEAR(error->difference, 0, kRoundOff);
  EXPECT_NEAR(error->null, MedianDeviation(LogDepths()), kRoundOff);
  const auto wrong = MadeRun("a", 0, 4, [](int i) { return DepthOf(i) * std::exp(0.1 * ((i % 5) - 2)); });
  EXPECT_NEAR(ComputeSfmError(wrong, Reconstructed(3, DepthOf), kWidth_px, options)->difference, 0.1, kRoundOff);
}

TEST(ComputeSfmError, AveragesThreePointsByTheirDistanceAndLeavesOutEdges) {
  EvaluationInput run = MadeRun("a", 0, 1, DepthOf);
  const SfmErrorOptions options{.min_points = 2};
  run.frames[0].observations.resize(3);  // of depth 10, 11 and 12
  run.frames[0].observations[1].pixel = {600, 50};
  run.frames[0].observations[2].pixel = {600, 500};  // where nothing is reconstructed
  SfmPoints sfm;
  sfm[0] = {{{0, 58}, 1.0}, {{3, 50}, 1.1}, {{0, 42}, 1.0}, {{0, 90}, 50.0}, {{605, 50}, 1.0}};
  const auto smooth = ComputeSfmError(run, sfm, kWidth_px, options);
  ASSERT_TRUE(smooth.ok()) << smooth.status().message();
  EXPECT_EQ(smooth->points, 2);
  const double mean = (0.1 * 1.0 + 0.2 * 1.1 + 0.1 * 1.0) / 0.4;  // by 1 / (distance + 2)
  EXPECT_NEAR(smooth->difference, std::log(11 / (10 / mean)) / 2, kRoundOff);
  EXPECT_NEAR(smooth->null, std::log(mean) / 2, kRoundOff);
  sfm[0][0].depth = 1.2;
  const auto edge = ComputeSfmError(run, sfm, kWidth_px, options);
  EXPECT_EQ(edge.status().code(), ErrorCode::kInsufficient);
  EXPECT_THAT(edge.status().message(), HasSubstr("of the 1 tracked frames with points of structure from motion none"));
}

TEST(EvaluateWithoutTruth, HasWhatNeedsNoSequenceAndTheComparisonInJsonAndTable) {
  const EvaluationInput run = MadeRun("a", 0, 3, DepthOf);
  const auto spread = MadeRun("b", 0, 3, [](int i) { return DepthOf(i) * std::exp(0.1 * ((i % 5) - 2)); });
  auto evaluation = EvaluateWithoutTruth(run, {});
  ASSERT_TRUE(evaluation.ok()) << evaluation.status().message();
  ASSERT_TRUE(AddConsistency(run, spread, kWidth_px, {}, &*evaluation).ok());
  ASSERT_TRUE(AddSfmError(run, Reconstructed(3, DepthOf), kWidth_px, {}, &*evaluation).ok());
  EXPECT_EQ(evaluation->survival.frames_tracked, 3);
  const auto json = nlohmann::json::parse(EvaluationJson(*evaluation));
  ASSERT_EQ(json["consistency"].size(), 1U);
  const auto& other = json["consistency"][0];
  EXPECT_EQ(other["other_run"], "b");
  EXPECT_EQ(other["frames_compared"], 3);
  EXPECT_EQ(other["points"], 3 * kPoints);
  EXPECT_NEAR(other["estimate"]["median_relative_depth"].get<double>(), 0.1, kRoundOff);
  EXPECT_NEAR(other["null"]["median_relative_depth"].get<double>(), MedianDeviation(LogDepths()), kRoundOff);
  EXPECT_EQ(other["frames"][2]["frame"], 2);
  EXPECT_EQ(json["sfm"]["frames_compared"], 3);
  EXPECT_TRUE(json["surface"].is_null());
  const std::string table = EvaluationTable(*evaluation);
  EXPECT_THAT(table, HasSubstr("against another run"));
  EXPECT_THAT(table, HasSubstr("against structure from motion"));

  EvaluationOptions surface;
  surface.parts = {EvaluationPart::kSurface};
  EXPECT_THAT(EvaluateWithoutTruth(run, surface).status().message(), HasSubstr("no surface error"));
  EXPECT_EQ(EvaluateWithoutTruth({}, {}).status().code(), ErrorCode::kInsufficient);
}

}  // namespace
}  // namespace pliant
