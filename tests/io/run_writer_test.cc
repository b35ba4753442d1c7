// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/run_writer.h"

#include <cmath>
#include <csignal>
#include <filesystem>
#include <map>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "io/run_reports.h"
#include "pliant/io/run_reader.h"
#include "support/test_folder.h"

namespace pliant {
namespace {

using namespace run_reports;
using testing::HasSubstr;

TEST(RunWriter, ReplacesAFormerRunAndNothingElse) {
  const TestFolder folder;
  WriteRun(folder.Path("run"), 5);
  folder.Write("run/notes.txt", "mine");
  RunWriter writer = Writer(folder.Path("run"));
  EXPECT_FALSE(std::filesystem::exists(folder.Path("run/sparse/images.bin")));
  EXPECT_FALSE(std::filesystem::exists(folder.Path("run/map.ply")));
  EXPECT_EQ(folder.Read("run/notes.txt"), "mine");
  folder.Write("other.txt", "x");
  const auto refused = RunWriter::Create(folder.Path(""), TestCamera(), {}, "", {kCosts, kStages});
  EXPECT_EQ(refused.status().code(), ErrorCode::kInvalidArgument);
  const auto no_folder = RunWriter::Create(folder.Path("other.txt/run"), TestCamera(), {}, "", {kCosts, kStages});
  EXPECT_EQ(no_folder.status().code(), ErrorCode::kUnwritable);
}

// The bytes of all files of a folder, by their names.
std::map<std::string, std::string> ContentOf(const TestFolder& folder, const std::string& name) {
  std::map<std::string, std::string> content;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.Path(name)))
    if (entry.is_regular_file()) {
      const std::string path = std::filesystem::relative(entry.path(), folder.Path("")).string();
      content[path] = folder.Read(path);
    }
  return content;
}

TEST(RunWriter, ARunThatFailsBeforeItHasAPoseLeavesTheFormerOne) {
  const TestFolder folder;
  WriteRun(folder.Path("run"), 5);
  const auto former = ContentOf(folder, "run");
  for (const RunStatus status : {RunStatus::kFailed, RunStatus::kInterrupted}) {
    RunWriter writer = Writer(folder.Path("run"));
    ASSERT_TRUE(writer.Write(Report(0)).ok());
    EXPECT_TRUE(writer.Finish(status, "the image is damaged").ok());
    EXPECT_EQ(writer.summary().note, "the image is damaged; the run that was in the folder before is still there");
    EXPECT_EQ(ContentOf(folder, "run"), former);
  }
  { const RunWriter without_finish = Writer(folder.Path("run")); }
  EXPECT_EQ(ContentOf(folder, "run"), former);
}

TEST(RunWriter, ARunWithAPoseOrAnEndTakesThePlaceOfTheFormerOne) {
  for (const bool has_pose : {true, false}) {
    const TestFolder folder;
    WriteRun(folder.Path("run"), 5);
    RunWriter writer = Writer(folder.Path("run"));
    ASSERT_TRUE(writer.Write(Report(has_pose ? 1 : 0)).ok());
    EXPECT_EQ(std::filesystem::exists(folder.Path("run/.former_run")), !has_pose);
    ASSERT_TRUE(writer.Finish(has_pose ? RunStatus::kInterrupted : RunStatus::kCompleted, "it is so").ok());
    EXPECT_FALSE(std::filesystem::exists(folder.Path("run/.former_run")));
    const auto run = ReadRun(folder.Path("run"));
    ASSERT_TRUE(run.ok()) << run.status().message();
    EXPECT_EQ(run->frames.size(), 1U);
    EXPECT_EQ(run->summary->note, "it is so");
  }
}

// A killed run restores nothing; the next one in the folder still can.
TEST(RunWriter, WhatAKilledRunHadSetAsideIsRestoredByTheNextThatFails) {
  const TestFolder folder;
  WriteRun(folder.Path("run"), 5);
  const auto former = ContentOf(folder, "run");
  {
    RunWriter killed = Writer(folder.Path("run"));
    std::filesystem::copy(folder.Path("run"), folder.Path("copy"), std::filesystem::copy_options::recursive);
  }
  std::filesystem::remove_all(folder.Path("run"));
  std::filesystem::rename(folder.Path("copy"), folder.Path("run"));
  ASSERT_TRUE(std::filesystem::exists(folder.Path("run/.former_run/trajectory.txt")));
  ASSERT_TRUE(Writer(folder.Path("run")).Finish(RunStatus::kFailed, "").ok());
  EXPECT_EQ(ContentOf(folder, "run"), former);
}

TEST(RunWriter, LeavesARunAloneThatIsBeingWritten) {
  const TestFolder folder;
  {
    RunWriter writer = Writer(folder.Path("run"));
    ASSERT_TRUE(writer.Write(Report(0)).ok());
    const auto second = RunWriter::Create(folder.Path("run"), TestCamera(), {}, "", {kCosts, kStages});
    ASSERT_FALSE(second.ok());
    EXPECT_EQ(second.status().code(), ErrorCode::kUnwritable);
    EXPECT_THAT(second.status().message(), HasSubstr("another program is writing into"));
    ASSERT_TRUE(writer.Finish(RunStatus::kCompleted, "").ok());
  }
  EXPECT_TRUE(std::filesystem::exists(folder.Path("run/map.ply")));
  EXPECT_TRUE(RunWriter::Create(folder.Path("run"), TestCamera(), {}, "", {kCosts, kStages}).ok());
}

// One that has ended since its user was asked.
TEST(RunWriter, ReplacesNoRunWhereItMustNot) {
  const TestFolder folder;
  WriteRun(folder.Path("run"), 5);
  const auto former = ContentOf(folder, "run");
  const auto second =
      RunWriter::Create(folder.Path("run"), TestCamera(), {}, "", {kCosts, kStages}, {.replaces_run = false});
  EXPECT_EQ(second.status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(second.status().message(), HasSubstr("another process has made a run in"));
  EXPECT_EQ(ContentOf(folder, "run"), former);
  EXPECT_TRUE(
      RunWriter::Create(folder.Path("new"), TestCamera(), {}, "", {kCosts, kStages}, {.replaces_run = false}).ok());
}

TEST(RunWriter, GivesTheSameBytesTwiceWithoutTimings) {
  const TestFolder folder;
  for (const char* run : {"a", "b"}) WriteRun(folder.Path(run), 5, {.timings = RunTimings::kNone});
  constexpr int kMinFiles = 8;  // of docs/formats.md
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.Path("a"))) {
    if (!entry.is_regular_file()) continue;
    const std::string name = std::filesystem::relative(entry.path(), folder.Path("a")).string();
    EXPECT_EQ(folder.Read("a/" + name), folder.Read("b/" + name)) << name;
    ++files;
  }
  EXPECT_GT(files, kMinFiles);
}

TEST(RunWriter, TellsHowLongEveryFrameTook) {
  const TestFolder folder;
  for (const RunTimings timings : {RunTimings::kWritten, RunTimings::kNone}) {
    const bool written = timings == RunTimings::kWritten;
    RunWriter writer = Writer(folder.Path("run"), {.timings = timings});
    for (int i = 0; i < 5; ++i) {
      FrameReport report = Report(i);
      report.latency_ms = i == 0 ? 0 : 10.0 * i;  // that of the first is not known
      ASSERT_TRUE(writer.Write(report).ok());
    }
    ASSERT_TRUE(writer.Finish(RunStatus::kCompleted, "done").ok());
    const auto run = ReadRun(folder.Path("run"));
    ASSERT_TRUE(run.ok() && run->summary) << run.status().message();
    for (std::size_t i = 0; i < 5; ++i)
      EXPECT_EQ(run->frames[i].latency_ms, written ? 10.0 * static_cast<double>(i) : 0);
    ASSERT_EQ(run->summary->latency.has_value(), written);
    if (!written) continue;
    EXPECT_EQ(run->summary->latency->p50, 25);
    EXPECT_GT(run->summary->latency->p99, 39);
    EXPECT_EQ(run->summary->latency->max, 40);
  }
}

TEST(RunWriter, RefusesReportsThatCannotBeMeant) {
  const TestFolder folder;
  RunWriter writer = Writer(folder.Path("run"));
  FrameReport report = Report(1);
  report.observations[0].position.x() = std::nan("");
  EXPECT_THAT(writer.Write(report).message(), HasSubstr("not finite"));
  report = Report(1);
  report.stage_ms = {{"other", 1.0}};
  EXPECT_THAT(writer.Write(report).message(), HasSubstr("no column for the stage 'other'"));
  report = Report(1);
  report.latency_ms = std::nan("");
  EXPECT_THAT(writer.Write(report).message(), HasSubstr("not finite"));
  report = Report(1);
  report.costs = {{"other", 1.0}};
  EXPECT_THAT(writer.Write(report).message(), HasSubstr("no column for the cost term 'other'"));
  report = Report(1);
  report.new_points.clear();
  EXPECT_THAT(writer.Write(report).message(), HasSubstr("observed but was never new"));
  report = Report(1);
  report.refined_points = {{PointId{1}, Eigen::Vector3d(1, 2, 3)}};
  EXPECT_THAT(writer.Write(report).message(), HasSubstr("refined but was never new"));
  report.refined_points = {{report.observations[0].id, Eigen::Vector3d(1, std::nan(""), 3)}};
  EXPECT_THAT(writer.Write(report).message(), HasSubstr("not finite"));
}

TEST(RunWriter, TheMapHasPointsWhereTheyWereLastRefinedTo) {
  const TestFolder folder;
  RunWriter writer = Writer(folder.Path("run"));
  for (int frame = 1; frame <= 3; ++frame) {
    FrameReport report = Report(frame);
    if (frame > 1) report.refined_points = {{PointId{0}, Eigen::Vector3d(0.125, 0.25, 70.5 + frame)}};
    ASSERT_TRUE(writer.Write(report).ok());
  }
  ASSERT_TRUE(writer.Finish(RunStatus::kCompleted, "").ok());
  const std::string points = folder.Read("run/sparse/points3D.txt");
  EXPECT_THAT(points, HasSubstr("\n0 0.125000 0.250000 73.500000 "));
  EXPECT_THAT(points, HasSubstr("\n3 -1.000000 0.500000 50.250000 ")) << "the others stay";
}

TEST(RunWriter, ReportsAFullDiskAndKeepsWhatItWrote) {
  const TestFolder folder;
  RunWriter writer = Writer(folder.Path("run"));
  // A limit on the size of files stands in for a full disk: writing fails in the middle of a row.
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{4000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  Status status;
  int frames = 0;
  for (; frames < 1000 && status.ok(); ++frames) status = writer.Write(Report(frames));
  const Status finished = writer.Finish(RunStatus::kCompleted, "");
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(status.code(), ErrorCode::kUnwritable);
  EXPECT_THAT(status.message(), HasSubstr("observations.csv"));
  EXPECT_EQ(finished.code(), ErrorCode::kUnwritable);
  const auto run = ReadRun(folder.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  EXPECT_EQ(run->summary->status, RunStatus::kFailed);
  EXPECT_EQ(static_cast<int>(run->frames.size()), frames - 1);
}

TEST(RunWriter, TellsHowTheRunEndedWhereNoNewFileCanBeMade) {
  const TestFolder folder;
  RunWriter writer = Writer(folder.Path("run"));
  for (int frame = 0; frame < 2; ++frame) ASSERT_TRUE(writer.Write(Report(frame)).ok());
  // Folders in the way of the files stand in for a disk without room for new ones.
  std::filesystem::create_directories(folder.Path("run/run.json.tmp"));
  std::filesystem::create_directories(folder.Path("run/sparse/cameras.txt"));
  std::filesystem::create_directories(folder.Path("run/sparse/cameras.bin"));
  EXPECT_EQ(writer.Finish(RunStatus::kCompleted, "").code(), ErrorCode::kUnwritable);
  const auto run = ReadRun(folder.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  EXPECT_EQ(run->summary->status, RunStatus::kFailed);
  EXPECT_THAT(run->summary->note, HasSubstr("cannot write"));
  EXPECT_FALSE(std::filesystem::exists(folder.Path("run/sparse")));
}

}  // namespace
}  // namespace pliant
