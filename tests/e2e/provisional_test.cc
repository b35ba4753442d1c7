// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Runs in which no first map is as certain as demanded.
#include <set>

#include <gmock/gmock.h>
#include <opencv2/core.hpp>

#include "e2e/e2e_support.h"

namespace pliant {
namespace {

constexpr int kProvisionalFrames = 24;
// Images of something else: the reference's points are lost, and found again.
constexpr int kCut = 18;
constexpr int kCutFrames = 2;
constexpr double kNever = 1e-5;  // no depth is known to this share of it

class ProvisionalMap : public testing::Test {
 protected:
  ProvisionalMap() : sequence_(folder_, kProvisionalFrames) {
    for (int k = kCut; k < kCut + kCutFrames; ++k) {
      cv::Mat noise = cv::imread(sequence_.Image(k).string());
      cv::RNG(static_cast<std::uint64_t>(k)).fill(noise, cv::RNG::UNIFORM, 40, 220);
      sequence_.Replace(k, noise);
    }
    WindowInitOptions& window = options_.tracker.init.window;
    window.certain_depth_sigma = window.last_depth_sigma = window.max_depth_sigma = kNever;
    options_.timings = RunTimings::kNone;
  }
  pliant::Run Track() {
    summary_ = TrackSequenceAt(sequence_.path(), folder_.Path("run"), options_);
    auto run = ReadRun(folder_.Path("run"));
    EXPECT_TRUE(run.ok()) << run.status().message();
    return *std::move(run);
  }

  const TestFolder folder_;
  const SequenceCopy sequence_;
  TrackOptions options_;
  RunSummary summary_;
};

TEST_F(ProvisionalMap, IsGoneBackToAndEveryFrameIsReportedOnce) {
  const pliant::Run run = Track();
  ASSERT_EQ(run.frames.size(), static_cast<std::size_t>(kProvisionalFrames));
  for (int k = 0; k < kProvisionalFrames; ++k) {
    const RunFrame& frame = run.frames[static_cast<std::size_t>(k)];
    EXPECT_EQ(frame.frame_idx, k);
    const bool cut = kCut <= k && k < kCut + kCutFrames;
    EXPECT_EQ(EnumName(frame.state), EnumName(cut ? TrackingState::kLost : TrackingState::kProvisional)) << k;
  }
  EXPECT_EQ(summary_.frames_tracked, kProvisionalFrames - kCutFrames);
  ASSERT_EQ(summary_.first_maps.size(), 1U);
  const FirstMapFrames& map = summary_.first_maps.front();
  EXPECT_EQ(map.reference_frame_idx, 0);
  EXPECT_LT(map.declared_frame_idx, kCut);
  EXPECT_TRUE(map.evidence.provisional);
  EXPECT_GE(map.evidence.depth_spread, 2 * map.evidence.depth_sigma);
  const Evaluation evaluation = EvaluateRun(folder_.Path("run"), kSequence, ErrorScale::kPerFrame);
  EXPECT_LT(evaluation.surface->plain.estimate.median_relative_depth,
            evaluation.surface->plain.null.median_relative_depth / 3);
}

TEST_F(ProvisionalMap, IsTheSameForAnyNumberOfThreads) {
  std::set<std::string> observations;
  for (const int threads : {1, 2}) {
    options_.threads = threads;
    EXPECT_EQ(Track().poses.size(), static_cast<std::size_t>(kProvisionalFrames - kCutFrames));
    observations.insert(folder_.Read("run/observations.csv") + folder_.Read("run/frames.csv"));
  }
  EXPECT_EQ(observations.size(), 1U);
}

TEST_F(ProvisionalMap, IsNotTakenWhereItIsNotWanted) {
  options_.tracker.init.window.provisional = Switch::kOff;
  const pliant::Run run = Track();
  EXPECT_EQ(summary_.frames_tracked, 0);
  EXPECT_TRUE(summary_.first_maps.empty());
  EXPECT_EQ(summary_.status, RunStatus::kFailed);
  EXPECT_EQ(run.frames.size(), static_cast<std::size_t>(kProvisionalFrames));
}

}  // namespace
}  // namespace pliant
