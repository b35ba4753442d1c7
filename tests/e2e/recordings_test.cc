// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Real recordings, where they are at hand: the tests are skipped where they are not.
#include <gmock/gmock.h>

#include "e2e/e2e_support.h"

namespace pliant {
namespace {

std::string RecordingOrSkip(const std::string& name) {
  const std::filesystem::path path = std::filesystem::path(PLIANT_TEST_RECORDINGS) / name;
  return std::filesystem::exists(path) ? path.string() : "";
}

TEST(Recordings, TheLaparoscopyVideoIsReadDirectlyAndTrackedThroughAllItsFrames) {
  const std::string folder_path = RecordingOrSkip("laparoscopy");
  if (folder_path.empty()) GTEST_SKIP() << "no recordings at " << PLIANT_TEST_RECORDINGS;
  const TestFolder folder;
  RunRequest request;
  request.input.image_path = folder_path + "/endo.mp4";
  request.input.camera_path = folder_path + "/camera.yaml";
  request.output_path = folder.Path("run");
  const auto summary = RunTrack(request, TrackOptions(), {});
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->frames_tracked, 250);
  const auto run = ReadRun(folder.Path("run"));
  ASSERT_TRUE(run.ok()) << run.status().message();
  EXPECT_EQ(static_cast<std::int64_t>(run->poses.size()), summary->frames_tracked);
}

TEST(Recordings, TenNearlyStillImagesSayWhyTheyCarryNoMap) {
  const std::string folder_path = RecordingOrSkip("porcine_stereo");
  if (folder_path.empty()) GTEST_SKIP() << "no recordings at " << PLIANT_TEST_RECORDINGS;
  const TestFolder folder;
  const RunSummary summary = TrackSequenceAt(folder_path, folder.Path("run"), TrackOptions());
  EXPECT_EQ(summary.frames_read, 10);
  if (summary.frames_tracked == 0) {
    EXPECT_EQ(summary.status, RunStatus::kFailed);
    EXPECT_THAT(summary.note, testing::HasSubstr("without a first map"));
    EXPECT_THAT(summary.note, testing::HasSubstr("parallax"));
  }
  EXPECT_TRUE(ReadRun(folder.Path("run")).ok());
}

}  // namespace
}  // namespace pliant
