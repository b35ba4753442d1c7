// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/frames_before.h"

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/base/statistics.h"
#include "pliant/datasets/convert_sequence.h"
#include "pliant/pipeline/track.h"
#include "support/kept_reports.h"
#include "support/rendered_sequence.h"
#include "support/test_folder.h"

namespace pliant {
namespace {

constexpr std::size_t kLost = 8;    // the first frame without a map
constexpr std::size_t kFound = 12;  // the frame in which it is found again
// Between a frame tracked forwards and backwards, medians: the camera goes 2 mm a frame, 50 mm before the surface.
constexpr double kCameraAgain_mm = 0.5;
constexpr double kPointAgain_px = 0.2;

class FramesOfALoss : public testing::Test {
 protected:
  FramesOfALoss() {
    RenderedSequence rendered;
    rendered.mono = false;
    request_.input.image_path = folder_.Path("stereo");
    EXPECT_TRUE(ConvertSequence(rendered, folder_.Path("stereo")).ok());
    request_.output_path = folder_.Path("run");
    options_.tracker.init.method = InitMethod::kStereo;
    options_.image.working = WorkingImageMode::kFixed;
    KeptReports kept;
    const auto summary = RunTrack(request_, options_, std::array<TrackObserver*, 1>{&kept});
    EXPECT_TRUE(summary.ok() && summary->frames_tracked == summary->frames_read) << summary.status().message();
    tracked_ = kept.reports;
  }

  // What becomes of the run's reports when some of them have no pose.
  std::vector<FrameReport> WithALoss(int max_frames_back) {
    std::vector<FrameReport> reports = tracked_;
    for (std::size_t k = kLost; k < kFound; ++k) {
      reports[k] = FrameReport();
      reports[k].frame_idx = tracked_[k].frame_idx;
      reports[k].name = tracked_[k].name;
      reports[k].state = TrackingState::kLost;
    }
    options_.max_frames_back = max_frames_back;
    Tracker tracker(Rendered().camera, options_.tracker, 0, 1);
    tracker.SkipPointIds(PointId{kManyPoints});
    FramesBefore before(request_.input, {}, Rendered().camera, options_, {}, &tracker);
    std::vector<FrameReport> final_reports = before.Pass(std::move(reports));
    EXPECT_TRUE(before.Finish().empty());
    EXPECT_EQ(final_reports.size(), tracked_.size());
    return final_reports;
  }

  static constexpr int kManyPoints = 100000;  // more than the run has
  const TestFolder folder_;
  RunRequest request_;
  TrackOptions options_;
  std::vector<FrameReport> tracked_;
};

TEST_F(FramesOfALoss, AreTrackedBackFromWhereTheMapIsFound) {
  const std::vector<FrameReport> reports = WithALoss(10);
  for (std::size_t k = 0; k < reports.size(); ++k) {
    SCOPED_TRACE(k);
    const FrameReport& of_run = tracked_[k];
    const FrameReport& report = reports[k];
    EXPECT_EQ(report.frame_idx, of_run.frame_idx);
    ASSERT_TRUE(report.cam_from_world);
    EXPECT_EQ(report.submap, of_run.submap);
    if (k < kLost || k >= kFound) {
      EXPECT_EQ(report.note, of_run.note);
      continue;
    }
    EXPECT_THAT(report.note, testing::HasSubstr("tracked back from frame 000012.png, in which the map is seen again"));
    EXPECT_LT((report.cam_from_world->Inverse().translation - of_run.cam_from_world->Inverse().translation).norm(),
              kCameraAgain_mm);
    std::vector<double> apart_px;
    for (const PointObservation& seen : report.observations) {
      const auto in_run = std::ranges::find(of_run.observations, seen.id, &PointObservation::id);
      if (in_run != of_run.observations.end()) apart_px.push_back((seen.pixel - in_run->pixel).norm());
    }
    ASSERT_GT(apart_px.size(), of_run.observations.size() / 2) << "the same points, under the same ids";
    EXPECT_LT(Median(apart_px), kPointAgain_px);
  }
}

TEST_F(FramesOfALoss, AreTrackedBackAsFarAsIsAskedFor) {
  const std::vector<FrameReport> reports = WithALoss(1);
  EXPECT_TRUE(reports[kFound - 1].cam_from_world);
  EXPECT_FALSE(reports[kFound - 2].cam_from_world);
  EXPECT_EQ(reports[kFound - 2].state, TrackingState::kLost);
}

TEST_F(FramesOfALoss, AddAPointOnce) {
  std::set<PointId> added;
  for (const FrameReport& report : WithALoss(10)) {
    for (const NewPoint& point : report.new_points) EXPECT_TRUE(added.insert(point.id).second);
    for (const PointObservation& seen : report.observations) EXPECT_TRUE(added.contains(seen.id));
  }
}

}  // namespace
}  // namespace pliant
