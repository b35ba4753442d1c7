// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Runs in which no first map is as certain as demanded.
#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "pliant/datasets/convert_sequence.h"
#include "pliant/io/run_reader.h"
#include "pliant/pipeline/track.h"
#include "support/rendered_sequence.h"
#include "support/test_folder.h"

namespace pliant {
namespace {

constexpr double kNever = 1e-4;  // no depth is known to this share of it
// Images of something else: the reference's points are lost, and found again.
constexpr int kCut = 14;
constexpr int kCutFrames = 2;

class ProvisionalRun : public testing::Test {
 protected:
  void SetUp() override {
    RenderedSequence rendered;
    rendered.mono = true;
    ASSERT_TRUE(ConvertSequence(rendered, folder_.Path("sequence")).ok());
    for (int k = kCut; k < kCut + kCutFrames; ++k) {
      const std::string path = folder_.Path("sequence") + "/images/0000" + std::to_string(k) + ".png";
      cv::Mat image = cv::imread(path);
      ASSERT_FALSE(image.empty()) << path;
      cv::theRNG().state = static_cast<std::uint64_t>(k);
      cv::randu(image, 0, 255);
      ASSERT_TRUE(cv::imwrite(path, image));
    }
  }

  // No map is certain; attempts every `every` frames from the 6th after the reference on.
  pliant::Run Tracked(const std::string& name, int threads, Switch provisional) const {
    TrackOptions options = MakeTrackOptions(Preset::kDefault);
    options.threads = threads;
    options.timings = RunTimings::kNone;
    options.image.working = WorkingImageMode::kFixed;
    WindowInitOptions& window = options.tracker.init.window;
    window.provisional = provisional;
    window.first_frame = 6;
    window.every = 3;
    window.deforming_frame = 6;
    window.certain_depth_sigma = window.last_depth_sigma = window.max_depth_sigma = kNever;
    window.min_points = 20;
    RunRequest request;
    request.input.image_path = folder_.Path("sequence");
    request.output_path = folder_.Path(name);
    const auto summary = RunTrack(request, options, {});
    EXPECT_TRUE(summary.ok()) << summary.status().message();
    auto run = ReadRun(request.output_path);
    EXPECT_TRUE(run.ok()) << run.status().message();
    return *std::move(run);
  }

  TestFolder folder_;
};

TEST_F(ProvisionalRun, GoesBackToTheMapAndReportsEveryFrameOnce) {
  const pliant::Run run = Tracked("run", 2, Switch::kOn);
  ASSERT_TRUE(run.summary);
  ASSERT_EQ(run.frames.size(), Rendered().frames.size());
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    EXPECT_EQ(run.frames[k].frame_idx, static_cast<int>(k));
    const bool cut = kCut <= static_cast<int>(k) && static_cast<int>(k) < kCut + kCutFrames;
    EXPECT_EQ(run.frames[k].state, cut ? TrackingState::kLost : TrackingState::kProvisional) << k;
  }
  EXPECT_EQ(run.poses.size(), run.frames.size() - kCutFrames);
  ASSERT_EQ(run.summary->first_maps.size(), 1U);
  const FirstMapFrames& map = run.summary->first_maps.front();
  EXPECT_LT(map.declared_frame_idx, kCut);
  EXPECT_TRUE(map.evidence.provisional);
  EXPECT_GE(map.evidence.depth_spread, 3 * map.evidence.depth_sigma);
}

TEST_F(ProvisionalRun, DoesNotDependOnTheThreads) {
  const pliant::Run one = Tracked("one", 1, Switch::kOn);
  const pliant::Run two = Tracked("two", 2, Switch::kOn);
  ASSERT_EQ(one.poses.size(), two.poses.size());
  for (std::size_t k = 0; k < one.poses.size(); ++k)
    EXPECT_EQ(one.poses[k].world_from_cam.translation, two.poses[k].world_from_cam.translation) << k;
}

TEST_F(ProvisionalRun, WithoutProvisionalMapsThereIsNone) {
  const pliant::Run run = Tracked("strict", 2, Switch::kOff);
  ASSERT_TRUE(run.summary);
  EXPECT_EQ(run.summary->frames_tracked, 0);
  EXPECT_TRUE(run.summary->first_maps.empty());
  EXPECT_EQ(run.summary->status, RunStatus::kFailed);
}

}  // namespace
}  // namespace pliant
