// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Frames whose reference was given up: once there is a map they are tracked from it back in time.
#include <algorithm>
#include <iterator>
#include <set>
#include <vector>

#include <gmock/gmock.h>
#include <opencv2/core.hpp>

#include "e2e/e2e_support.h"

namespace pliant {
namespace {

constexpr double kAsTheReference = 1.5;  // the largest of five frames' medians against one

constexpr int kFrames = 24;
constexpr int kElsewhere = 5;  // shows something else: the reference before it is given up, and itself is none

class FramesBeforeTheReference : public testing::Test {
 protected:
  FramesBeforeTheReference() : sequence_(folder_, kFrames) {
    cv::Mat noise = cv::imread(sequence_.Image(kElsewhere).string());
    cv::RNG(1).fill(noise, cv::RNG::UNIFORM, 40, 220);
    sequence_.Replace(kElsewhere, noise);
  }
  pliant::Run Track(const TrackOptions& options) {
    summary_ = TrackSequenceAt(sequence_.path(), folder_.Path("run"), options);
    auto run = ReadRun(folder_.Path("run"));
    EXPECT_TRUE(run.ok()) << run.status().message();
    return *std::move(run);
  }
  static std::vector<int> TrackedFrames(const pliant::Run& run) {
    std::vector<int> frames_idx;
    for (const RunPose& pose : run.poses) frames_idx.push_back(*pose.frame_idx);
    return frames_idx;
  }
  static std::vector<int> FramesFrom(int first) {
    std::vector<int> frames_idx;
    for (int idx = first; idx < kFrames; ++idx)
      if (idx != kElsewhere) frames_idx.push_back(idx);
    return frames_idx;
  }

  const TestFolder folder_;
  const SequenceCopy sequence_;
  RunSummary summary_;
};

TEST_F(FramesBeforeTheReference, AreTrackedBackFromIt) {
  const pliant::Run run = Track({});
  EXPECT_EQ(summary_.status, RunStatus::kCompleted) << summary_.note;
  ASSERT_FALSE(summary_.first_maps.empty());
  EXPECT_EQ(summary_.first_maps.front().reference_frame_idx, kElsewhere + 1);
  EXPECT_EQ(TrackedFrames(run), FramesFrom(0));
  EXPECT_FALSE(HasPose(run.frames[kElsewhere].state));
  EXPECT_GT(run.frames[0].optimized, run.frames[kElsewhere + 1].optimized / 2);
  EXPECT_EQ(run.frames[0].added, run.frames[0].optimized) << "new in the first frame that shows them";

  const Evaluation evaluation = EvaluateRun(folder_.Path("run"), kSequence, ErrorScale::kPerFrame);
  ASSERT_TRUE(evaluation.trajectory);
  ASSERT_EQ(evaluation.trajectory->frame_idx, FramesFrom(0));
  constexpr double kLargest_mm = 0.1;  // of a path of 12 mm
  EXPECT_LT(evaluation.trajectory->ate_max_mm, kLargest_mm);
  // The same points at the same places: as good as where the map was made.
  double before = 0;
  double reference = 0;
  for (const PointFrameError& frame : evaluation.surface->plain.frames) {
    if (frame.frame_idx < kElsewhere) before = std::max(before, frame.estimate.median_mm);
    if (frame.frame_idx == kElsewhere + 1) reference = frame.estimate.median_mm;
  }
  EXPECT_LT(before, kAsTheReference * reference);
}

TEST_F(FramesBeforeTheReference, AreTrackedBackAsFarAsIsAskedFor) {
  TrackOptions options;
  options.max_frames_back = 3;
  EXPECT_EQ(TrackedFrames(Track(options)), FramesFrom(kElsewhere + 1 - 3));
  options.max_frames_back = 0;
  EXPECT_EQ(TrackedFrames(Track(options)), FramesFrom(kElsewhere + 1));
}

TEST_F(FramesBeforeTheReference, StayWithoutAPoseWhereTheyShowSomethingElse) {
  for (int idx = 0; idx < kElsewhere; ++idx) {
    cv::Mat upside_down;
    cv::flip(cv::imread(sequence_.Image(idx).string()), upside_down, 0);
    sequence_.Replace(idx, upside_down);
  }
  const pliant::Run run = Track({});
  EXPECT_EQ(TrackedFrames(run), FramesFrom(kElsewhere + 1));
  EXPECT_EQ(static_cast<int>(run.frames.size()), kFrames);
}

// All of the sequence; its first half waits for the map of the second.
TEST(FramesBefore, TheMapGrowsInThem) {
  constexpr int kLast = 24;
  const TestFolder folder;
  const SequenceCopy sequence(folder, 60);
  cv::Mat noise = cv::imread(sequence.Image(kLast).string());
  cv::RNG(1).fill(noise, cv::RNG::UNIFORM, 40, 220);
  sequence.Replace(kLast, noise);
  TrackOptions options;
  options.tracker.init.window.first_frame = kLast + 1;
  const RunSummary summary = TrackSequenceAt(sequence.path(), folder.Path("run"), options);
  ASSERT_FALSE(summary.first_maps.empty()) << summary.note;
  ASSERT_EQ(summary.first_maps.front().reference_frame_idx, kLast + 1);
  auto reader = ObservationReader::Open(folder.Path("run"));
  ASSERT_TRUE(reader.ok()) << reader.status().message();
  std::set<PointId> before;
  std::set<PointId> after;
  for (auto frame = reader->Next(); frame.ok() && *frame; frame = reader->Next())
    for (const PointObservation& seen : (*frame)->observations)
      ((*frame)->frame_idx < kLast ? before : after).insert(seen.id);
  std::vector<PointId> new_before;
  std::ranges::set_difference(before, after, std::back_inserter(new_before));
  EXPECT_GT(new_before.size(), 20U);
  // An id belongs to one point: nothing jumps where the two halves meet.
  const Evaluation evaluation = EvaluateRun(folder.Path("run"), kSequence, ErrorScale::kPerFrame);
  for (const PointFrameError& frame : evaluation.surface->plain.frames)
    EXPECT_LT(frame.estimate.median_mm, 1.0) << frame.frame_idx;
}

TEST_F(FramesBeforeTheReference, AreTheSameForAnyNumberOfThreads) {
  TrackOptions options;
  options.timings = RunTimings::kNone;
  std::set<std::string> observations;
  for (const int threads : {1, 2}) {
    options.threads = threads;
    Track(options);
    observations.insert(folder_.Read("run/observations.csv"));
  }
  EXPECT_EQ(observations.size(), 1U);
}

}  // namespace
}  // namespace pliant
