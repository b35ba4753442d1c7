// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/evaluation.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "evaluation/truth_sequence.h"
#include "pliant/evaluation/report.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

// The tracks' own points leave the wall's material as the camera goes on: far more than a tracker's drift.
constexpr double kDrifted_mm = 10;
constexpr double kDrifted_px = 10;
constexpr double kScaleOfDrift = 0.2;  // of 2; the best scale makes up for some of the drift

EvaluationOptions WithParts(std::vector<EvaluationPart> parts) {
  EvaluationOptions options;
  options.parts = std::move(parts);
  return options;
}

TEST(Evaluate, IsZeroWithoutNoiseWhateverTheScale) {
  const auto evaluation = Evaluate(MakeRun(8, 3, 0), TruthSequence(8), kNoMaterial, {});
  ASSERT_TRUE(evaluation.ok()) << evaluation.status().message();
  ASSERT_TRUE(evaluation->surface && evaluation->trajectory);
  EXPECT_LT(evaluation->surface->plain.estimate.mean_rmse_mm, kLengthRoundOff_mm);
  EXPECT_NEAR(evaluation->surface->plain.estimate.max_scale, 3, kLengthRoundOff_mm);
  EXPECT_LT(evaluation->trajectory->ate_rmse_mm, kLengthRoundOff_mm);
  EXPECT_EQ(evaluation->trajectory->poses, 7);
  EXPECT_EQ(evaluation->surface->plain.frames.size(), 7U);
  EXPECT_EQ(evaluation->survival.frames_read, 8);
  EXPECT_EQ(evaluation->survival.frames_tracked, 7);
  EXPECT_EQ(evaluation->survival.median_track_length, 7);
  EXPECT_EQ(evaluation->survival.mean_track_length, 7);
  ASSERT_TRUE(evaluation->reprojection.has_value());
  EXPECT_EQ(evaluation->reprojection->points, 7 * 40);
  EXPECT_LT(evaluation->reprojection->rmse_px, kLengthRoundOff_mm);
  EXPECT_FALSE(evaluation->run_seconds.has_value());
  EXPECT_THAT(evaluation->notes, testing::ElementsAre(HasSubstr("no material error")));
}

TEST(Evaluate, TellsOfEveryFrameAndEndsOnRequest) {
  std::vector<int> told;
  const auto up_to = [&](int last) {
    told.clear();
    return Evaluate(MakeRun(8, 3, 0), TruthSequence(8), kNoMaterial, {}, nullptr,
                    [&, last](std::string_view task, int done, int total) {
                      EXPECT_EQ(task, "evaluate");
                      EXPECT_EQ(total, 8);
                      told.push_back(done);
                      return done < last;
                    });
  };
  EXPECT_TRUE(up_to(9).ok());
  EXPECT_THAT(told, testing::ElementsAre(1, 2, 3, 4, 5, 6, 7, 8));
  EXPECT_EQ(up_to(3).status().code(), ErrorCode::kInterrupted);
  EXPECT_EQ(told.size(), 3U);
}

TEST(Evaluate, TellsWhatIsMissingAndGoesOnWithTheRest) {
  const auto depth = Evaluate(MakeRun(8, 1, 1), TruthSequence(8, TruthSequence::Truth::kDepthOnly), kNoMaterial, {});
  ASSERT_TRUE(depth.ok());
  EXPECT_TRUE(depth->surface && !depth->trajectory && !depth->material);
  EXPECT_THAT(depth->notes,
              testing::ElementsAre("no material error: there is no simulation.yaml", HasSubstr("no camera error")));
  const auto poses = Evaluate(MakeRun(8, 1, 1), TruthSequence(8, TruthSequence::Truth::kPosesOnly), kNoMaterial, {});
  ASSERT_TRUE(poses.ok());
  EXPECT_TRUE(!poses->surface && poses->trajectory);
  EXPECT_THAT(EvaluationTable(*poses), HasSubstr("no surface error"));
  EXPECT_THAT(poses->notes.back(), HasSubstr("no depth for frame 4, in which it was made"));
  const auto bare = Evaluate(MakeRun(8, 1, 1), TruthSequence(8, TruthSequence::Truth::kNone), kNoMaterial, {});
  ASSERT_TRUE(bare.ok()) << bare.status().message();
  EXPECT_TRUE(bare->reprojection && !bare->surface && !bare->trajectory);
  EXPECT_EQ(bare->survival.tracks, 40);
  EXPECT_THAT(bare->notes, testing::Contains(HasSubstr("no surface error: the sequence has no true surface")));
}

TEST(Evaluate, FailsWhereThereIsNoTruthForAPartOrAProtocolThatWasAskedFor) {
  const EvaluationInput run = MakeRun(8, 1, 1);
  const TruthSequence poses_only(8, TruthSequence::Truth::kPosesOnly);
  const TruthSequence depth_only(8, TruthSequence::Truth::kDepthOnly);
  const auto material = Evaluate(run, depth_only, kNoMaterial, WithParts({EvaluationPart::kMaterial}));
  EXPECT_EQ(material.status().code(), ErrorCode::kNotFound);
  EXPECT_EQ(material.status().message(), "no material error: there is no simulation.yaml");
  const auto surface = Evaluate(run, poses_only, kNoMaterial, WithParts({EvaluationPart::kSurface}));
  EXPECT_EQ(surface.status().code(), ErrorCode::kNotFound);
  EXPECT_EQ(surface.status().message(), "no surface error: the sequence has no true surface for the tracked frames");
  const auto camera = Evaluate(run, depth_only, kNoMaterial, WithParts({EvaluationPart::kCamera}));
  EXPECT_EQ(camera.status().code(), ErrorCode::kNotFound);
  EvaluationOptions lmeds;
  lmeds.points.protocols = {ErrorProtocol::kLmeds};
  const auto protocol = Evaluate(run, poses_only, kNoMaterial, lmeds);
  EXPECT_EQ(protocol.status().code(), ErrorCode::kNotFound);
  EXPECT_THAT(protocol.status().message(), StartsWith("the protocol lmeds compares points"));
}

TEST(Evaluate, ComputesThePartsAskedForAlone) {
  const auto evaluation =
      Evaluate(MakeRun(8, 1, 1), TruthSequence(8), kNoMaterial, WithParts({EvaluationPart::kCamera}));
  ASSERT_TRUE(evaluation.ok());
  EXPECT_TRUE(!evaluation->surface && !evaluation->material && evaluation->trajectory);
  EXPECT_TRUE(evaluation->notes.empty());
}

// MakeRun's points are on the surface, at another point of it in every frame.
TEST(Evaluate, GivesTheMaterialErrorBesideTheSurfaceError) {
  const TruthSequence sequence(8);
  WallMaterial wall(sequence);
  EvaluationOptions options;
  options.points.max_depth_step = 10;
  const auto evaluation = Evaluate(MakeRun(8, 2, 0), sequence, &wall, options);
  ASSERT_TRUE(evaluation.ok()) << evaluation.status().message();
  ASSERT_TRUE(evaluation->surface && evaluation->material);
  EXPECT_LT(evaluation->surface->plain.estimate.mean_rmse_mm, kLengthRoundOff_mm);
  EXPECT_LT(evaluation->material->error.plain.frames.front().estimate.rmse_mm,
            kLengthRoundOff_mm);  // where the tracks start
  EXPECT_GT(evaluation->material->error.plain.estimate.mean_rmse_mm, kDrifted_mm);
  EXPECT_GT(evaluation->material->drift.median_px, kDrifted_px);
  EXPECT_NEAR(evaluation->material->error.plain.estimate.max_scale, 2, kScaleOfDrift);
}

TEST(Evaluate, ScoresTracksInSpaceAtOneScaleUnlessTheRunIsMetric) {
  const TruthSequence sequence(8);
  WallMaterial wall(sequence);
  EvaluationInput run = MakeRun(8, 2, 0);
  const auto scaled = Evaluate(run, sequence, &wall, WithParts({EvaluationPart::kTracks}));
  run.metric = true;
  const auto metric = Evaluate(run, sequence, &wall, WithParts({EvaluationPart::kTracks}));
  ASSERT_TRUE(scaled.ok() && metric.ok());
  ASSERT_TRUE(scaled->tracks && scaled->tracks_3d && metric->tracks_3d);
  EXPECT_EQ(scaled->tracks_3d->tracks, 40);
  EXPECT_GT(scaled->tracks_3d->points, scaled->tracks->points);  // the first frames of the tracks
  EXPECT_NEAR(scaled->tracks_3d->scale, 2, kScaleOfDrift);
  EXPECT_EQ(metric->tracks_3d->scale, 1);
  EXPECT_EQ(metric->tracks_3d->average_within, 0);
}

TEST(Evaluate, RefusesRunsThatDoNotBelongToTheSequence) {
  const auto longer = Evaluate(MakeRun(9, 1, 1), TruthSequence(8), kNoMaterial, {});
  EXPECT_EQ(longer.status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(longer.status().message(), HasSubstr("a frame 8"));
  EvaluationInput shifted = MakeRun(8, 1, 1);
  shifted.frames[5].timestamp_s += 0.04;
  const auto other = Evaluate(shifted, TruthSequence(8), kNoMaterial, {});
  EXPECT_EQ(other.status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(other.status().message(), HasSubstr("frame 5 is at 0.24 s"));
  const auto untracked = Evaluate(MakeRun(1, 1, 1), TruthSequence(8), kNoMaterial, {});
  EXPECT_EQ(untracked.status().code(), ErrorCode::kInsufficient);
}

TEST(Evaluate, RefusesARunOfAnotherCamera) {
  EvaluationInput run = MakeRun(8, 1, 1);
  const std::array<double, 4> wide = {50, 50, 31.5, 23.5};
  run.camera = *Camera::Create(CameraModelId::kPinhole, 64, 48, wide);
  const auto other = Evaluate(run, TruthSequence(8), kNoMaterial, {});
  EXPECT_EQ(other.status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(other.status().message(), HasSubstr("px from where the sequence's camera sees them"));
  EvaluationOptions any;
  any.matching.camera = CameraAgreement::kAny;
  EXPECT_TRUE(Evaluate(run, TruthSequence(8), kNoMaterial, any).ok());
  run.camera = *Camera::Create(CameraModelId::kPinhole, 128, 96, wide);
  const auto larger = Evaluate(run, TruthSequence(8), kNoMaterial, any);
  EXPECT_EQ(larger.status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(larger.status().message(), HasSubstr("images of 128x96 and the sequence has 64x48"));
  // The same lens in another model's words.
  const std::array<double, 8> opencv = {60, 60, 31.5, 23.5, 0, 0, 0, 0};
  run.camera = *Camera::Create(CameraModelId::kOpenCv, 64, 48, opencv);
  EXPECT_TRUE(Evaluate(run, TruthSequence(8), kNoMaterial, {}).ok());
}

TEST(EvaluationReport, TableJsonAndCsvSayTheSame) {
  const TruthSequence sequence(8);
  WallMaterial wall(sequence);
  EvaluationOptions options;
  options.points.protocols = {ErrorProtocol::kPaper, ErrorProtocol::kLmeds};
  const auto evaluation = Evaluate(MakeRun(8, 1, 1), sequence, &wall, options);
  ASSERT_TRUE(evaluation.ok());
  char rmse[32];
  std::snprintf(rmse, sizeof rmse, "%.3f", evaluation->surface->plain.estimate.mean_rmse_mm);
  EXPECT_THAT(EvaluationTable(*evaluation), HasSubstr(rmse));
  const auto json = nlohmann::json::parse(EvaluationJson(*evaluation));
  EXPECT_EQ(json["surface"]["estimate"]["mean_rmse_mm"], evaluation->surface->plain.estimate.mean_rmse_mm);
  EXPECT_EQ(json["surface"]["protocols"]["lmeds"]["null"]["mean_rmse_mm"],
            evaluation->surface->protocols[1].null.mean_rmse_mm);
  EXPECT_EQ(json["surface"]["protocols"]["paper"]["estimate"], json["surface"]["estimate"]);
  EXPECT_EQ(json["material"]["estimate"]["mean_rmse_mm"], evaluation->material->error.plain.estimate.mean_rmse_mm);
  EXPECT_EQ(json["material"]["drift"]["median_px"], evaluation->material->drift.median_px);
  EXPECT_EQ(json["trajectory"]["ate_rmse_mm"], evaluation->trajectory->ate_rmse_mm);
  EXPECT_EQ(json["tracks"]["average_jaccard"], evaluation->tracks->average_jaccard);
  EXPECT_EQ(json["tracks_3d"]["within_16"], evaluation->tracks_3d->within[4]);
  EXPECT_EQ(json["tracks_3d"]["null"]["average_jaccard"], evaluation->tracks_3d->null.average_jaccard);
  EXPECT_EQ(json["survival"]["alive_share_50"], 1);
  const FirstMapError& first_map = *evaluation->first_map;
  EXPECT_EQ(json["first_map"]["declared_frame"], kFirstMap.declared_frame_idx);
  EXPECT_EQ(json["first_map"]["declared"]["estimate"]["median_relative_depth"], first_map.declared.estimate.median);
  EXPECT_EQ(json["first_map"]["declared"]["null"]["p90_relative_depth"], first_map.declared.null.p90);
  EXPECT_EQ(json["first_map"]["reference"]["estimate"]["rmse_relative_depth"], first_map.reference->estimate.rmse);
  EXPECT_EQ(json["first_map"]["motion"]["direction_error_deg"], *first_map.motion->direction_error_deg);
  EXPECT_EQ(json["first_map"]["initializer_ms"]["total"], 15);
  EXPECT_EQ(json["surface"]["frames"].size(), 7U);
  EXPECT_EQ(json["survival"]["frames"][0]["tracked"], false);

  std::istringstream csv(EvaluationCsv(*evaluation));
  std::string line;
  std::getline(csv, line);
  EXPECT_THAT(line, StartsWith("frame,tracked,points,alive_of_first,compared,left_out,scale,rmse_mm,median_mm,"
                               "null_rmse_mm,null_median_mm,ate_mm,material_compared,"));
  EXPECT_THAT(line, HasSubstr(",lmeds_compared,lmeds_rmse_mm,lmeds_null_rmse_mm,material_lmeds_compared,"));
  const auto columns = std::count(line.begin(), line.end(), ',');
  int rows = 0;
  for (; std::getline(csv, line); ++rows) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), columns) << line;
    if (rows == 0) {
      EXPECT_THAT(line, StartsWith("0,0,0,0,,,,,,,,,"));
    }
    if (rows == 1) {
      EXPECT_THAT(line, StartsWith("1,1,40,40,"));
      EXPECT_THAT(line, HasSubstr(FormatDouble(evaluation->surface->plain.frames[0].estimate.rmse_mm)));
    }
  }
  EXPECT_EQ(rows, 8);
}

TEST(ComparisonReport, HasARowARunAndEmptyCellsWhereARunHasNoFigure) {
  std::vector<Evaluation> evaluations;
  EvaluationOptions options;
  options.points.protocols = {ErrorProtocol::kDepthTrimmed};
  evaluations.push_back(*Evaluate(MakeRun(8, 1, 1), TruthSequence(8), kNoMaterial, options));
  evaluations.push_back(
      *Evaluate(MakeRun(8, 1, 2), TruthSequence(8, TruthSequence::Truth::kDepthOnly), kNoMaterial, {}));
  evaluations[1].run = "a, b";
  const auto json = nlohmann::json::parse(ComparisonJson(evaluations));
  ASSERT_EQ(json["runs"].size(), 2U);
  EXPECT_EQ(json["runs"][0]["surface"]["estimate"]["mean_rmse_mm"],
            evaluations[0].surface->plain.estimate.mean_rmse_mm);
  EXPECT_TRUE(json["runs"][1]["trajectory"].is_null());
  EXPECT_THAT(ComparisonJson(evaluations), testing::Not(HasSubstr("\"frames\"")));

  std::istringstream csv(ComparisonCsv(evaluations));
  std::string header;
  std::string first;
  std::string second;
  std::getline(csv, header);
  std::getline(csv, first);
  std::getline(csv, second);
  EXPECT_THAT(header, StartsWith("run,sequence,frames_read,frames_tracked,"));
  EXPECT_THAT(header, HasSubstr(",surface_mean_rmse_mm,surface_null_mean_rmse_mm,"));
  EXPECT_THAT(header, HasSubstr(",surface_depth_trimmed_mean_rmse_mm,"));
  EXPECT_THAT(header, HasSubstr(",rpe_rotation_rmse_deg,first_map_frames_waited,first_map_median_relative_depth,"));
  EXPECT_THAT(first, HasSubstr(FormatDouble(evaluations[0].trajectory->ate_rmse_mm)));
  EXPECT_THAT(second, StartsWith("\"a, b\",,8,7,"));
  EXPECT_THAT(second, HasSubstr(",,,,3,"));  // no camera error, then the first map's three frames of waiting
  EXPECT_EQ(std::count(first.begin(), first.end(), ','), std::count(header.begin(), header.end(), ','));

  const std::string table = ComparisonTable(evaluations);
  EXPECT_THAT(table, HasSubstr("depth_trimmed, RMSE mm (null)"));
  char cell[64];
  std::snprintf(cell, sizeof cell, "%.2f (%.2f)", evaluations[1].surface->plain.estimate.mean_rmse_mm,
                evaluations[1].surface->plain.null.mean_rmse_mm);
  EXPECT_THAT(table, HasSubstr(cell));
}

TEST(Evaluate, TakesFrameReportsAsTheyAre) {
  EvaluationInput run = MakeRun(8, 1, 1);
  const auto expected = Evaluate(run, TruthSequence(8), kNoMaterial, {});
  for (EvaluationFrame& frame : run.frames) {
    FrameReport report;
    report.frame_idx = frame.frame_idx;
    report.timestamp_s = frame.timestamp_s;
    report.cam_from_world = frame.cam_from_world;
    report.observations = frame.observations;
    report.first_map = frame.first_map;
    report.stage_ms = {{"initialize", frame.initialize_ms}};
    frame = FrameFromReport(report);
  }
  const auto evaluation = Evaluate(run, TruthSequence(8), kNoMaterial, {});
  ASSERT_TRUE(expected.ok() && evaluation.ok());
  EXPECT_EQ(EvaluationJson(*evaluation), EvaluationJson(*expected));
}

TEST(EvaluationReport, JsonTakesARunWhoseNameIsNotUtf8) {
  EvaluationInput run = MakeRun(8, 1, 1);
  run.name = "run_\xff";
  const auto evaluation = Evaluate(run, TruthSequence(8), kNoMaterial, {});
  ASSERT_TRUE(evaluation.ok());
  EXPECT_THAT(nlohmann::json::parse(EvaluationJson(*evaluation))["run"].get<std::string>(), StartsWith("run_"));
}

TEST(EvaluationOptions, AreSetByName) {
  EvaluationOptions options;
  OptionTable table;
  options.List(table);
  EXPECT_TRUE(table.Set("PointError.scale", "none").ok());
  EXPECT_TRUE(table.Set("TrajectoryError.alignment", "se3").ok());
  EXPECT_EQ(options.points.scale, ErrorScale::kNone);
  EXPECT_EQ(options.trajectory.alignment, TrajectoryAlignment::kSe3);
  EXPECT_FALSE(table.Set("PointError.scale", "median").ok());
  EXPECT_TRUE(table.Set("PointError.protocol", "lmeds,paper").ok());
  EXPECT_THAT(options.points.protocols, testing::ElementsAre(ErrorProtocol::kPaper, ErrorProtocol::kLmeds));
  EXPECT_TRUE(table.Set("PointError.protocol", "all").ok());
  EXPECT_EQ(options.points.protocols.size(), 3U);
  const Status unknown = table.Set("PointError.protocol", "paper,trimmed");
  EXPECT_EQ(unknown.message(),
            "PointError.protocol is 'paper,trimmed'; give paper, depth_trimmed, lmeds, several with commas, or all");
  EXPECT_TRUE(options.Wants(EvaluationPart::kMaterial));
  EXPECT_TRUE(table.Set("Evaluation.parts", "surface,camera").ok());
  EXPECT_FALSE(options.Wants(EvaluationPart::kMaterial));
}

}  // namespace
}  // namespace pliant
