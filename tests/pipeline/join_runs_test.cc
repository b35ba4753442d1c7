// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/pipeline/join_runs.h"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/geometry/sim3.h"
#include "pliant/io/run_reader.h"
#include "support/small_files.h"
#include "support/small_run.h"
#include "support/test_folder.h"

namespace pliant {
namespace {

using testing::HasSubstr;

constexpr int kPoints = 40;
constexpr double kAsWritten = 5e-5;  // mm: a run's files hold micrometers, which a change of the unit makes larger

// A surface that swells, and the camera's path along it, mm.
Eigen::Vector3d TruePosition(int point, int frame) {
  const double x = 3.0 * (point % 8) - 10.0;
  const double y = 3.0 * (point / 8) - 6.0;  // NOLINT(bugprone-integer-division): the row
  return {x, y, 50.0 + 6.0 * std::sin(0.7 * x + 0.4 * y) + 0.05 * frame};
}
Rigid3 TruePose(int frame) {
  return {RotationExp({0.002 * frame, -0.004 * frame, 0.001 * frame}),
          Eigen::Vector3d(-0.2 * frame, 0.1, 0.05 * frame)};
}

// A run of a part of the recording, in a world of its own.
struct PartOfTruth {
  std::string name;
  int first = 0;
  int end = 0;
  Sim3 world_from_truth = {};
  std::int64_t first_id = 0;
  double shift_px = 0;  // of its points, which are others then
  bool wrong = false;   // of every second point the depth is half of what it is
  std::set<int> lost = {};
  std::string input = "film";
  std::optional<bool> metric = {};
  std::optional<int> declared = {};  // the frame in which its map was made
  double latency_ms = 0;             // of each frame
};

const Sim3 kOther = {2.0, Eigen::Quaterniond(RotationExp({0.3, -0.8, 0.4})), Eigen::Vector3d(5, -7, 11)};

class JoinRunsTest : public testing::Test {
 protected:
  void Write(const PartOfTruth& part) {
    RunDescription description{.program_version = "0.1.0", .command_line = {"pliant"}, .input = part.input};
    description.metric = part.metric;
    description.refined_from = "refined part";
    description.range = {part.first, part.end, 1};
    auto writer = RunWriter::Create(folder_.Path(part.name), TestCamera(), description, "Track:\n", {});
    ASSERT_TRUE(writer.ok()) << writer.status().message();
    for (int frame = part.first; frame < part.end; ++frame)
      ASSERT_TRUE(writer->Write(ReportOf(part, frame)).ok()) << frame;
    ASSERT_TRUE(writer->Finish(RunStatus::kCompleted, "").ok());
    names_.push_back(part.name);
  }

  Result<JoinSummary> Join(const JoinOptions& options = {}) const {
    JoinRequest request;
    for (const std::string& name : names_) request.run_paths.push_back(folder_.Path(name));
    request.output_path = folder_.Path("joined");
    request.command_line = {"pliant", "join"};
    return JoinRuns(request, options, {});
  }

  // That the joined run is the truth in each frame, from `first` to `end`, without one missing.
  void ExpectTruth(int first, int end) const {
    const auto run = ReadRun(folder_.Path("joined"));
    ASSERT_TRUE(run.ok()) << run.status().message();
    ASSERT_EQ(run->poses.size(), static_cast<std::size_t>(end - first));
    for (std::size_t k = 0; k < run->poses.size(); ++k) {
      const int frame = first + static_cast<int>(k);
      ASSERT_EQ(run->poses[k].frame_idx, frame);
      EXPECT_LT((run->poses[k].world_from_cam.translation - TruePose(frame).Inverse().translation).norm(), kAsWritten);
      EXPECT_LT(run->poses[k].world_from_cam.rotation.angularDistance(TruePose(frame).Inverse().rotation), 1e-7);
    }
    auto reader = ObservationReader::Open(folder_.Path("joined"));
    ASSERT_TRUE(reader.ok());
    int frames = 0;
    for (auto rows = reader->Next(); rows.ok() && rows->has_value(); rows = reader->Next(), ++frames) {
      ASSERT_EQ((*rows)->observations.size(), static_cast<std::size_t>(kPoints));
      for (int i = 0; i < kPoints; ++i) {
        const PointObservation& seen = (*rows)->observations[static_cast<std::size_t>(i)];
        EXPECT_LT((seen.position - TruePosition(i, (*rows)->frame_idx)).norm(), kAsWritten);
        EXPECT_NEAR(seen.sigma, 0.2, 1e-5);
      }
    }
    EXPECT_EQ(frames, end - first);
  }

  TestFolder folder_;

 private:
  static FrameReport ReportOf(const PartOfTruth& part, int frame) {
    FrameReport report;
    report.frame_idx = frame;
    report.name = std::to_string(frame) + ".png";
    report.timestamp_s = frame / 25.0;
    report.latency_ms = part.latency_ms;
    report.state = TrackingState::kLost;
    if (part.lost.contains(frame)) return report;
    report.state = TrackingState::kTracking;
    if (part.declared == frame) report.first_map = FirstMapFrames{part.first, frame, {}};
    report.cam_from_world = PoseInWorld(part.world_from_truth, TruePose(frame));
    for (int i = 0; i < kPoints; ++i) {
      const PointId id{part.first_id + i};
      if (frame == part.first)
        report.new_points.push_back({id, part.world_from_truth * TruePosition(i, part.first), {1, 2, 3}});
      Eigen::Vector2d pixel = *TestCamera().Project(TruePose(frame) * TruePosition(i, frame));
      pixel.x() += part.shift_px;
      const double share = part.wrong && i % 2 == 1 ? 0.5 : 1.0;
      const Eigen::Vector3d position = TruePose(frame).Inverse() * (share * (TruePose(frame) * TruePosition(i, frame)));
      report.observations.push_back(
          {id, pixel, part.world_from_truth * position, 0.9, 0.2 * part.world_from_truth.scale});
    }
    return report;
  }

  std::vector<std::string> names_;
};

TEST_F(JoinRunsTest, OfTwoPartsIsTheWhole) {
  Write({.name = "first", .first = 0, .end = 12});
  Write({.name = "second", .first = 8, .end = 20, .world_from_truth = kOther, .first_id = 1000});
  const auto joined = Join();
  ASSERT_TRUE(joined.ok()) << joined.status().message();
  ASSERT_EQ(joined->joints.size(), 1U);
  const RunJoint& joint = joined->joints.front();
  EXPECT_EQ(joint.failure, "");
  EXPECT_EQ(joint.frames, 4);
  EXPECT_EQ(joint.points, 4 * kPoints);
  EXPECT_EQ(joint.same_points, kPoints);
  EXPECT_NEAR(joint.scale, 0.5, 1e-6);
  EXPECT_LT(joint.depth_difference, 1e-5);
  EXPECT_GT(joint.depth_spread, 0.02);
  EXPECT_EQ(joined->run.points, kPoints);  // each is one point over both parts
  EXPECT_EQ(joined->run.submaps, 1);
  ExpectTruth(0, 20);
  const auto description = ReadRunSummary(folder_.Path("joined/run.json"))->description;
  EXPECT_THAT(description.joined_from, testing::ElementsAre(folder_.Path("first"), folder_.Path("second")));
  EXPECT_EQ(description.range, (FrameSelection{0, 20, 1}));
  EXPECT_EQ(description.refined_from, "");  // it is of several
}

TEST_F(JoinRunsTest, OnAFullDiskTheFormerOneStays) {
  Write({.name = "first", .first = 0, .end = 12});
  Write({.name = "second", .first = 8, .end = 20, .world_from_truth = kOther, .first_id = 1000});
  ASSERT_TRUE(Join().ok());
  const std::string rows = folder_.Read("joined/observations.csv");
  {
    const SmallFiles full_disk(rows.size() / 2);
    EXPECT_EQ(Join().status().code(), ErrorCode::kUnwritable);
  }
  EXPECT_EQ(folder_.Read("joined/observations.csv"), rows);
  EXPECT_FALSE(std::filesystem::exists(folder_.Path("joined/.unfinished")));
  ExpectTruth(0, 20);
}

TEST_F(JoinRunsTest, PartsMayBeManyAndInAnyOrder) {
  Write({.name = "third", .first = 15, .end = 25, .world_from_truth = kOther * kOther, .first_id = 7});
  Write({.name = "first", .first = 0, .end = 9});
  Write({.name = "second", .first = 5, .end = 19, .world_from_truth = kOther, .first_id = 3});
  const auto joined = Join();
  ASSERT_TRUE(joined.ok()) << joined.status().message();
  EXPECT_EQ(joined->joints.size(), 2U);
  EXPECT_EQ(joined->run.points, kPoints);
  ExpectTruth(0, 25);
}

TEST_F(JoinRunsTest, AFrameThatOnePartHasLostIsTheOtherOnes) {
  Write({.name = "first", .first = 0, .end = 12, .lost = {8, 9}});
  Write({.name = "second", .first = 6, .end = 20, .world_from_truth = kOther, .lost = {10, 11}});
  const auto joined = Join();
  ASSERT_TRUE(joined.ok()) << joined.status().message();
  EXPECT_EQ(joined->joints.front().frames, 2);
  EXPECT_EQ(joined->joints.front().same_points, 0);  // in two frames: that may be by chance
  EXPECT_EQ(joined->run.points, 2 * kPoints);
  ExpectTruth(0, 20);
}

TEST_F(JoinRunsTest, OtherPointsAtNearlyTheSamePixelsTellTheScale) {
  Write({.name = "first", .first = 0, .end = 12});
  Write({.name = "second", .first = 6, .end = 20, .world_from_truth = kOther, .first_id = 50, .shift_px = 3});
  const auto joined = Join();
  ASSERT_TRUE(joined.ok()) << joined.status().message();
  EXPECT_EQ(joined->joints.front().same_points, 0);
  EXPECT_EQ(joined->run.points, 2 * kPoints);
  ExpectTruth(0, 20);
}

TEST_F(JoinRunsTest, WhatHasNoFrameInCommonStaysASubmap) {
  Write({.name = "first", .first = 0, .end = 10});
  Write({.name = "second", .first = 10, .end = 20, .world_from_truth = kOther});
  const auto joined = Join();
  ASSERT_TRUE(joined.ok()) << joined.status().message();
  EXPECT_EQ(joined->joints.front().failure, "no frame has a pose in both");
  EXPECT_EQ(joined->run.submaps, 2);
  const auto run = ReadRun(folder_.Path("joined"));
  EXPECT_EQ(run->poses[9].submap, 0);
  EXPECT_EQ(run->poses[10].submap, 1);
}

TEST_F(JoinRunsTest, TooFewPointsAtTheSamePixelsJoinNothing) {
  Write({.name = "first", .first = 0, .end = 12});
  Write({.name = "second", .first = 8, .end = 20, .world_from_truth = kOther, .shift_px = 30});
  JoinOptions options;
  options.min_points = 2 * kPoints;
  const auto joined = Join(options);
  ASSERT_TRUE(joined.ok()) << joined.status().message();
  EXPECT_THAT(joined->joints.front().failure, HasSubstr("at least 80 are needed"));
  EXPECT_EQ(joined->run.submaps, 2);
}

TEST_F(JoinRunsTest, DepthsThatDifferTooMuchJoinNothing) {
  Write({.name = "first", .first = 0, .end = 12});
  Write({.name = "second", .first = 8, .end = 20, .wrong = true});
  const auto joined = Join();
  ASSERT_TRUE(joined.ok()) << joined.status().message();
  EXPECT_THAT(joined->joints.front().failure, HasSubstr("one of the maps is wrong"));
  EXPECT_EQ(joined->run.submaps, 2);
}

// The first frames that both parts have are the earlier one's.
TEST_F(JoinRunsTest, EveryMapIsDeclared) {
  Write({.name = "first", .first = 0, .end = 12, .declared = 3});
  Write({.name = "second", .first = 8, .end = 20, .wrong = true, .declared = 9});
  const auto joined = Join();
  ASSERT_TRUE(joined.ok()) << joined.status().message();
  ASSERT_EQ(joined->run.submaps, 2);
  std::vector<int> declared;
  for (const FirstMapFrames& map : joined->run.first_maps) declared.push_back(map.declared_frame_idx);
  EXPECT_THAT(declared, testing::ElementsAre(3, 9));
}

TEST_F(JoinRunsTest, AMapThatWasJoinedIsDeclaredOnce) {
  Write({.name = "first", .first = 0, .end = 12, .declared = 3});
  Write({.name = "second", .first = 8, .end = 20, .declared = 9});
  const auto joined = Join();
  ASSERT_TRUE(joined.ok()) << joined.status().message();
  EXPECT_EQ(joined->run.first_maps.size(), 1U);
}

TEST_F(JoinRunsTest, FramesKeepTheirLatencyAlsoWithoutAPose) {
  Write({.name = "first", .first = 0, .end = 12, .lost = {2}, .latency_ms = 20});
  Write({.name = "second", .first = 8, .end = 20, .world_from_truth = kOther, .first_id = 1000, .latency_ms = 30});
  const auto joined = Join();
  ASSERT_TRUE(joined.ok()) << joined.status().message();
  const auto run = ReadRun(folder_.Path("joined"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  ASSERT_EQ(run->frames.size(), 20U);
  for (const int frame : {0, 2}) EXPECT_EQ(run->frames[static_cast<std::size_t>(frame)].latency_ms, 20) << frame;
  EXPECT_EQ(run->frames[19].latency_ms, 30);
  ASSERT_TRUE(joined->run.latency.has_value());
  EXPECT_EQ(joined->run.latency->max, 30);
  EXPECT_EQ(joined->run.latency->p50, 25);  // the middle of the overlap is that of the frames
}

TEST_F(JoinRunsTest, MillimetersStayMillimeters) {
  Sim3 slightly_larger;
  slightly_larger.scale = 1.02;
  Write({.name = "first", .first = 0, .end = 12, .metric = true});
  Write({.name = "second", .first = 8, .end = 20, .world_from_truth = slightly_larger, .metric = true});
  const auto joined = Join();
  ASSERT_TRUE(joined.ok()) << joined.status().message();
  EXPECT_EQ(joined->joints.front().scale, 1.0);
  EXPECT_NEAR(joined->joints.front().depth_difference, std::log(1.02), 1e-4);
}

TEST_F(JoinRunsTest, RefusesWhatIsNotOfOneRecording) {
  Write({.name = "first", .first = 0, .end = 12});
  Write({.name = "second", .first = 8, .end = 20, .input = "another film"});
  const auto joined = Join();
  EXPECT_EQ(joined.status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(joined.status().message(), HasSubstr("of different images; join parts of one recording"));
  EXPECT_FALSE(std::filesystem::exists(folder_.Path("joined")));
}

TEST_F(JoinRunsTest, RefusesARunAloneOrTwiceOrAsItsOutput) {
  Write({.name = "first", .first = 0, .end = 12});
  EXPECT_EQ(Join().status().code(), ErrorCode::kInvalidArgument);
  JoinRequest request;
  request.run_paths = {folder_.Path("first"), folder_.Path("first/../first")};
  request.output_path = folder_.Path("joined");
  EXPECT_THAT(JoinRuns(request, {}, {}).status().message(), HasSubstr("was given twice"));
  request.output_path = folder_.Path("first");
  EXPECT_THAT(JoinRuns(request, {}, {}).status().message(), HasSubstr("would overwrite the run"));
}

TEST_F(JoinRunsTest, StoppedOnRequestItWritesNothing) {
  Write({.name = "first", .first = 0, .end = 12});
  Write({.name = "second", .first = 8, .end = 20});
  JoinRequest request;
  request.run_paths = {folder_.Path("first"), folder_.Path("second")};
  request.output_path = folder_.Path("joined");
  for (const std::string last : {"read", "join", "write"}) {
    const auto joined = JoinRuns(request, {}, [&](std::string_view task, int, int) { return task != last; });
    EXPECT_EQ(joined.status().code(), ErrorCode::kInterrupted) << last;
    EXPECT_FALSE(std::filesystem::exists(folder_.Path("joined"))) << last;
  }
}

}  // namespace
}  // namespace pliant
