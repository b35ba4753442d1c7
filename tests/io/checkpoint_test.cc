// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Checkpoints, and run folders that are gone on with.
#include "pliant/io/checkpoint.h"

#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include "io/run_reports.h"
#include "io/run_rows.h"
#include "pliant/base/state_archive.h"
#include "support/test_folder.h"

namespace pliant {
namespace {

using namespace run_reports;
using testing::HasSubstr;

constexpr int kBefore = 5;  // frames until the checkpoint
constexpr int kFrames = 9;

TEST(Checkpoint, IsReadAsItWasWritten) {
  const TestFolder folder;
  EXPECT_FALSE(HasCheckpoint(folder.Path("run")));
  EXPECT_EQ(ReadCheckpoint(folder.Path("run")).status().code(), ErrorCode::kNotFound);
  const std::string state("a\0b", 3);
  ASSERT_TRUE(WriteCheckpoint(folder.Path("run"), "before").ok());
  ASSERT_TRUE(WriteCheckpoint(folder.Path("run"), state).ok());
  const auto read = ReadCheckpoint(folder.Path("run"));
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(*read, state);
}

// In another file system, to which there are no hard links, rows are copied.
TEST(Checkpoint, RowsThatCouldNotBeCopiedToTheirEndAreNotTakenBack) {
  const TestFolder folder;
  const std::string memory = "/dev/shm/pliant_checkpoint_" + std::to_string(getpid());
  std::error_code error;
  if (!std::filesystem::create_directories(memory, error)) GTEST_SKIP() << "there is no /dev/shm";
  std::filesystem::create_directory_symlink(memory, folder.Path("checkpoint"));
  const std::string rows(100'000, '1');
  for (const char* name : {"trajectory.txt", "frames.csv", "observations.csv"}) folder.Write(name, rows);
  std::filesystem::create_hard_link(folder.Path("frames.csv"), memory + "/link", error);
  const bool is_other_file_system = static_cast<bool>(error);
  rlimit before = {};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto ignored = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small = {.rlim_cur = rows.size() / 2, .rlim_max = before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  const Status kept = KeepRows(folder.Path(""));
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, ignored);
  const bool is_left = !std::filesystem::is_empty(memory);
  const bool copied =
      KeepRows(folder.Path("")).ok() && std::filesystem::file_size(memory + "/frames.csv") == rows.size();
  std::filesystem::remove_all(memory);
  if (!is_other_file_system) GTEST_SKIP() << "/dev/shm is no other file system";
  EXPECT_EQ(kept.code(), ErrorCode::kUnwritable);
  EXPECT_FALSE(is_left);
  EXPECT_TRUE(copied);
}

TEST(Checkpoint, IsRefusedWhereItIsDamagedOrOfAnotherVersion) {
  const TestFolder folder;
  ASSERT_TRUE(WriteCheckpoint(folder.Path("run"), "state of a run").ok());
  const std::string whole = folder.Read("run/checkpoint/state");
  for (std::size_t size = 0; size < whole.size(); ++size) {
    folder.Write("run/checkpoint/state", whole.substr(0, size));
    EXPECT_EQ(ReadCheckpoint(folder.Path("run")).status().code(), ErrorCode::kUnreadable) << size;
  }
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x40);
    folder.Write("run/checkpoint/state", flipped);
    EXPECT_FALSE(ReadCheckpoint(folder.Path("run")).ok()) << at;
  }
  std::string other = whole;
  other.replace(other.find("0."), 2, "9.");
  folder.Write("run/checkpoint/state", other);
  EXPECT_EQ(ReadCheckpoint(folder.Path("run")).status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(ReadCheckpoint(folder.Path("run")).status().message(), HasSubstr("of version '9."));
  other = whole;
  other.replace(other.find('('), 1, "<");
  folder.Write("run/checkpoint/state", other);
  EXPECT_EQ(ReadCheckpoint(folder.Path("run")).status().code(), ErrorCode::kMismatch) << "another build";
}

class ResumedWriter : public testing::Test {
 protected:
  // Frames of the second submap, which joins the first one in frame 4, before the checkpoint.
  static FrameReport ReportOf(int frame) {
    FrameReport report = Report(frame);
    if (frame < 3 || frame > 4) return report;
    report.submap = 1;
    report.new_points = frame == 3 ? Report(1).new_points : std::vector<NewPoint>();
    for (NewPoint& point : report.new_points) point.id.value += 50;
    for (PointObservation& seen : report.observations) seen.id.value += 50;
    if (frame == 4) report.merge = {1, 0, {2, RotationExp({0, 0, 1}), {10, 0, 0}}};
    return report;
  }
  static void WriteFrames(int first, int end, RunWriter* writer) {
    for (int i = first; i < end; ++i) ASSERT_TRUE(writer->Write(ReportOf(i)).ok()) << i;
  }
  // Up to the checkpoint, whose state this returns; and some frames more.
  std::string Begin(const std::string& run, RunWriter* writer) const {
    WriteFrames(0, kBefore, writer);
    StateArchive archive;
    EXPECT_TRUE(writer->Serialize(archive).ok());
    EXPECT_TRUE(WriteCheckpoint(folder_.Path(run), archive.bytes()).ok());
    WriteFrames(kBefore, kFrames - 1, writer);
    return archive.bytes();
  }
  Result<RunWriter> Resume(const std::string& run, const std::string& state) const {
    StateArchive archive = StateArchive::Reading(state);
    return RunWriter::Resume(
        folder_.Path(run), TestCamera(),
        {"0.1.0", {"pliant", "track"}, 7, "clip.mp4", "stereo.yaml", "masks", {"tracks"}, 0.75, 0.7, 21}, "Track:\n",
        {kCosts, kStages}, {.timings = RunTimings::kNone}, archive);
  }
  void ExpectSameFiles(const std::string& run) const {
    RunWriter whole = Writer(folder_.Path("whole"), {.timings = RunTimings::kNone});
    WriteFrames(0, kFrames, &whole);
    ASSERT_TRUE(whole.Finish(RunStatus::kCompleted, "the end").ok());
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.Path("whole"))) {
      if (!entry.is_regular_file()) continue;
      const std::string name = std::filesystem::relative(entry.path(), folder_.Path("whole")).string();
      EXPECT_EQ(folder_.Read(run + "/" + name), folder_.Read("whole/" + name)) << name;
      ++files;
    }
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.Path(run)))
      if (entry.is_regular_file()) --files;
    EXPECT_EQ(files, 0U) << "as many here as there";
  }
  void GoOn(const std::string& run, const std::string& state) const {
    auto writer = Resume(run, state);
    ASSERT_TRUE(writer.ok()) << writer.status().message();
    WriteFrames(kBefore, kFrames, &*writer);
    ASSERT_TRUE(writer->Finish(RunStatus::kCompleted, "the end").ok());
  }

  const TestFolder folder_;
};

TEST_F(ResumedWriter, GoesOnWithARunThatWasKilled) {
  std::string state;
  {
    RunWriter writer = Writer(folder_.Path("run"), {.timings = RunTimings::kNone});
    state = Begin("run", &writer);
  }
  EXPECT_TRUE(HasCheckpoint(folder_.Path("run")));
  GoOn("run", state);
  ExpectSameFiles("run");
}

TEST_F(ResumedWriter, GoesOnWithARunThatWasStoppedAfterItsSubmapsWereMovedIntoOneWorld) {
  std::string state;
  {
    RunWriter writer = Writer(folder_.Path("run"), {.timings = RunTimings::kNone});
    state = Begin("run", &writer);
    ASSERT_TRUE(writer.Finish(RunStatus::kInterrupted, "stopped").ok());
  }
  EXPECT_TRUE(HasCheckpoint(folder_.Path("run")));
  EXPECT_NE(folder_.Read("run/trajectory.txt"), folder_.Read("run/checkpoint/trajectory.txt"));
  GoOn("run", state);
  ExpectSameFiles("run");
}

TEST_F(ResumedWriter, IsStoppedAndGoesOnAgain) {
  std::string state;
  {
    RunWriter writer = Writer(folder_.Path("run"), {.timings = RunTimings::kNone});
    state = Begin("run", &writer);
    ASSERT_TRUE(writer.Finish(RunStatus::kFailed, "an image is damaged").ok());
  }
  for (int end = kBefore; end < kFrames; ++end) {
    auto writer = Resume("run", state);
    ASSERT_TRUE(writer.ok()) << writer.status().message();
    WriteFrames(kBefore, end, &*writer);
    ASSERT_TRUE(writer->Finish(RunStatus::kInterrupted, "stopped").ok());
  }
  GoOn("run", state);
  ExpectSameFiles("run");
}

TEST_F(ResumedWriter, RefusesRowsThatAreMissingAndAStateThatIsCutOff) {
  std::string state;
  {
    RunWriter writer = Writer(folder_.Path("run"), {.timings = RunTimings::kNone});
    state = Begin("run", &writer);
  }
  EXPECT_THAT(Resume("run", state.substr(0, state.size() - 1)).status().message(), HasSubstr("is damaged"));
  folder_.Write("run/frames.csv", "frame\n");
  const auto refused = Resume("run", state);
  EXPECT_EQ(refused.status().code(), ErrorCode::kUnreadable);
  EXPECT_THAT(refused.status().message(), HasSubstr("frames.csv' is shorter than it was"));
}

TEST_F(ResumedWriter, ANewRunTakesThePlaceOfTheCheckpointToo) {
  {
    RunWriter writer = Writer(folder_.Path("run"), {.timings = RunTimings::kNone});
    Begin("run", &writer);
    ASSERT_TRUE(writer.Finish(RunStatus::kInterrupted, "stopped").ok());
  }
  WriteRun(folder_.Path("run"), 3);
  EXPECT_FALSE(std::filesystem::exists(folder_.Path("run/checkpoint")));
  EXPECT_FALSE(std::filesystem::exists(folder_.Path("run/.former_run")));
}

}  // namespace
}  // namespace pliant
