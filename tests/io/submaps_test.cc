// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Runs of several maps, and of maps that became one.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include <gmock/gmock.h>

#include "io/run_reports.h"
#include "pliant/io/run_reader.h"
#include "support/test_folder.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using namespace run_reports;
using testing::HasSubstr;

constexpr double kFileAngle_rad = 1e-8;  // quaternions have nine decimals
constexpr double kFileTime_s = 1e-6;     // times have six

// A frame of another map: other ids, all of them new.
FrameReport ReportOf(int frame, int submap) {
  FrameReport report = Report(frame);
  report.submap = submap;
  report.new_points = Report(1).new_points;
  for (NewPoint& point : report.new_points) point.id.value += 50 * submap;
  for (PointObservation& seen : report.observations) seen.id.value += 50 * submap;
  return report;
}

TEST(RunWriter, EverySubmapHasItsOwnMapAndModel) {
  const TestFolder folder;
  {
    RunWriter writer = Writer(folder.Path("run"));
    ASSERT_TRUE(writer.Write(Report(1)).ok());
    FrameReport second = Report(2);
    second.submap = 1;
    EXPECT_THAT(writer.Write(second).message(), HasSubstr("is of submap 0"));
    ASSERT_TRUE(writer.Write(ReportOf(2, 1)).ok());
    FrameReport back = Report(3);  // the first one again
    ASSERT_TRUE(writer.Write(back).ok());
    ASSERT_TRUE(writer.Finish(RunStatus::kCompleted, "").ok());
  }
  for (const char* name : {"map.ply", "map_1.ply", "sparse/0/points3D.txt", "sparse/1/points3D.bin"})
    EXPECT_TRUE(std::filesystem::exists(folder.Path("run/" + std::string(name)))) << name;
  EXPECT_FALSE(std::filesystem::exists(folder.Path("run/sparse/points3D.txt")));
  EXPECT_THAT(folder.Read("run/sparse/1/points3D.txt"), testing::Not(HasSubstr("\n0 ")));
  const auto run = ReadRun(folder.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  EXPECT_EQ(run->summary->submaps, 2);
  ASSERT_EQ(run->poses.size(), 3U);
  for (const std::size_t i : {0, 1, 2}) {
    EXPECT_EQ(run->poses[i].submap, i == 1 ? 1 : 0);
    EXPECT_EQ(run->frames[i].submap, i == 1 ? 1 : 0);
  }
  WriteRun(folder.Path("run"), 5);  // one map again
  EXPECT_FALSE(std::filesystem::exists(folder.Path("run/map_1.ply")));
  EXPECT_FALSE(std::filesystem::exists(folder.Path("run/sparse/1")));
}

// Of three maps the second goes into the first.
class MergedSubmaps : public testing::Test {
 protected:
  MergedSubmaps() : writer_(Writer(folder_.Path("run"))) {
    FrameReport second = ReportOf(2, 1);
    second.merge = {1, 0, into_from_submap_};
    FrameReport after = Report(3);
    after.observations.push_back(ReportOf(3, 1).observations[0]);
    for (const FrameReport& report : {Report(1), second, after, ReportOf(4, 2)})
      EXPECT_TRUE(writer_.Write(report).ok()) << report.frame_idx;
  }

  const Sim3 into_from_submap_{2, RotationExp({0, 0, EIGEN_PI / 2}), {10, 0, 0}};
  const TestFolder folder_;
  RunWriter writer_;
};

TEST_F(MergedSubmaps, AreOneInTheEnd) {
  ASSERT_TRUE(writer_.Finish(RunStatus::kCompleted, "").ok());
  const auto run = ReadRun(folder_.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  EXPECT_EQ(run->summary->submaps, 2);
  ASSERT_EQ(run->poses.size(), 4U);
  for (const std::size_t i : {0, 1, 2, 3}) {
    EXPECT_EQ(run->poses[i].submap, i == 3 ? 1 : 0) << i;
    const Rigid3 reported = *Report(static_cast<int>(i) + 1).cam_from_world;
    const Rigid3 expected = (i == 1 ? PoseInWorld(into_from_submap_, reported) : reported).Inverse();
    EXPECT_LT((run->poses[i].world_from_cam.translation - expected.translation).norm(), kFileLength_mm) << i;
    EXPECT_LT(run->poses[i].world_from_cam.rotation.angularDistance(expected.rotation), kFileAngle_rad) << i;
    EXPECT_NEAR(run->poses[i].timestamp_s, (static_cast<double>(i) + 1) / 25.0, kFileTime_s);
    EXPECT_EQ(run->frames[i].stage_ms, (std::vector<double>{1.5, 2.25})) << "the other columns stay";
  }
  std::vector<int> frames_idx;
  for (const RunFrame& frame : run->frames) frames_idx.push_back(frame.frame_idx);
  const Status status = ForEachFrame(folder_.Path("run"), frames_idx, [&](std::size_t i, const auto& observations) {
    const FrameReport reported = i == 3 ? ReportOf(4, 2) : i == 1 ? ReportOf(2, 1) : Report(static_cast<int>(i) + 1);
    for (std::size_t k = 0; k < reported.observations.size(); ++k) {
      const Eigen::Vector3d& position = reported.observations[k].position;
      EXPECT_EQ(observations[k].id, reported.observations[k].id);
      EXPECT_LT((observations[k].position - (i == 1 ? into_from_submap_ * position : position)).norm(), kFileLength_mm);
      EXPECT_LT((observations[k].pixel - reported.observations[k].pixel).norm(), kFilePixel_px);
      EXPECT_NEAR(observations[k].sigma, (i == 1 ? into_from_submap_.scale : 1) * reported.observations[k].sigma,
                  kFileLength_mm);
    }
    return Status::Ok();
  });
  EXPECT_TRUE(status.ok()) << status.message();
}

TEST_F(MergedSubmaps, HaveOneModel) {
  ASSERT_TRUE(writer_.Finish(RunStatus::kCompleted, "").ok());
  // (-2, 0, 50.25) of the second map.
  EXPECT_THAT(folder_.Read("run/sparse/0/points3D.txt"), HasSubstr("\n50 10.000000 -4.000000 100.500000 "));
  EXPECT_TRUE(std::filesystem::exists(folder_.Path("run/sparse/1/images.txt")));
  EXPECT_FALSE(std::filesystem::exists(folder_.Path("run/sparse/2")));
  EXPECT_THAT(folder_.Read("run/map.ply"), HasSubstr("element vertex 12\n"));
  for (const char* name : {"frames.csv", "observations.csv", "trajectory.txt"})
    EXPECT_FALSE(std::filesystem::exists(folder_.Path("run/" + std::string(name) + ".tmp"))) << name;
}

TEST_F(MergedSubmaps, OfARunThatWasKilledAreSeveral) {
  const auto run = ReadRun(folder_.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  for (const std::size_t i : {0, 1, 2, 3}) {
    EXPECT_EQ(run->frames[i].submap, (std::vector<int>{0, 1, 0, 2})[i]);
    const Rigid3 reported = Report(static_cast<int>(i) + 1).cam_from_world->Inverse();
    EXPECT_LT((run->poses[i].world_from_cam.translation - reported.translation).norm(), kFileLength_mm);
  }
}

// The third goes into the second, and that into the first.
TEST(RunWriter, AWorldIsMovedAsOftenAsItIsMerged) {
  const TestFolder folder;
  const Sim3 first_from_second{2, RotationExp({0, 0, EIGEN_PI / 2}), {10, 0, 0}};
  const Sim3 second_from_third{0.5, RotationExp({0.3, 0, 0}), {0, 1, 0}};
  {
    RunWriter writer = Writer(folder.Path("run"));
    FrameReport third = ReportOf(3, 2);
    third.merge = {2, 1, second_from_third};
    FrameReport again = Report(4);
    again.merge = {1, 0, first_from_second};
    for (const FrameReport& report : {Report(1), ReportOf(2, 1), third, again})
      ASSERT_TRUE(writer.Write(report).ok()) << report.frame_idx;
    ASSERT_TRUE(writer.Finish(RunStatus::kCompleted, "").ok());
  }
  const auto run = ReadRun(folder.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  EXPECT_EQ(run->summary->submaps, 1);
  const Rigid3 expected = PoseInWorld(first_from_second * second_from_third, *Report(3).cam_from_world).Inverse();
  EXPECT_LT((run->poses[2].world_from_cam.translation - expected.translation).norm(), kFileLength_mm);
  EXPECT_LT(run->poses[2].world_from_cam.rotation.angularDistance(expected.rotation), kFileAngle_rad);
  EXPECT_TRUE(std::filesystem::exists(folder.Path("run/sparse/images.txt")));
}

TEST(RunWriter, RefusesAMergeThatCannotBe) {
  const TestFolder folder;
  RunWriter writer = Writer(folder.Path("run"));
  FrameReport report = Report(1);
  report.merge = {1, 0, Sim3{0}};
  EXPECT_THAT(writer.Write(report).message(), HasSubstr("a merge that is not possible"));
  report.merge = {0, 0, Sim3()};
  EXPECT_THAT(writer.Write(report).message(), HasSubstr("a merge that is not possible"));
  report.merge = {1, 0, Sim3{1, Eigen::Quaterniond::Identity(), {0, std::nan(""), 0}}};
  EXPECT_THAT(writer.Write(report).message(), HasSubstr("not finite"));
}

TEST(RunWriter, ARunThatFailsAtItsEndHasItsMapsAsReported) {
  const TestFolder folder;
  {
    RunWriter writer = Writer(folder.Path("run"));
    FrameReport second = ReportOf(2, 1);
    second.merge = {1, 0, Sim3()};
    for (const FrameReport& report : {Report(1), second}) ASSERT_TRUE(writer.Write(report).ok());
    std::filesystem::create_directory(folder.Path("run/frames.csv.tmp"));  // in the way
    EXPECT_FALSE(writer.Finish(RunStatus::kCompleted, "").ok());
  }
  std::filesystem::remove(folder.Path("run/frames.csv.tmp"));
  const auto run = ReadRun(folder.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  EXPECT_EQ(run->summary->status, RunStatus::kFailed);
  EXPECT_EQ(run->summary->submaps, 2);
  EXPECT_EQ(run->frames[1].submap, 1);
}

TEST(RunFolder, OfBeforeThereWereSubmapsIsRead) {
  const TestFolder folder;
  WriteRun(folder.Path("run"), 5);
  const std::string written = folder.Read("run/frames.csv");
  const std::string before_submap = written.substr(0, written.find("submap,"));
  ASSERT_LT(before_submap.size(), written.find('\n'));
  std::string frames;
  std::istringstream lines(written);
  for (std::string line; std::getline(lines, line);) {
    std::size_t at = 0;
    for (auto columns = std::ranges::count(before_submap, ','); columns > 0; --columns) at = line.find(',', at) + 1;
    frames += line.substr(0, at) + line.substr(line.find(',', at) + 1) + "\n";
  }
  folder.Write("run/frames.csv", frames);
  const auto run = ReadRun(folder.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  EXPECT_EQ(run->frames.size(), 5U);
  EXPECT_EQ(run->frames[2].submap, 0);
  EXPECT_EQ(run->stage_names, kStages);
}

}  // namespace
}  // namespace pliant
