// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Runs that start from a pair of images.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/base/statistics.h"
#include "pliant/datasets/convert_sequence.h"
#include "pliant/datasets/surface_folder.h"
#include "pliant/io/trajectory.h"
#include "pliant/pipeline/surface_run.h"
#include "pliant/pipeline/track.h"
#include "support/kept_reports.h"
#include "support/rendered_sequence.h"
#include "support/test_folder.h"

namespace pliant {
namespace {

constexpr double kCamera_mm = 2.0;          // one frame's pose among points of 0.3 px some 50 mm away, which deform
constexpr std::size_t kMinMapped = 60;      // of 160 x 120 pixels' corners with a match
constexpr double kDepthFromStereo = 0.015;  // median, relative: a tenth of a pixel of the disparity
constexpr double kFollowed_px = 0.5;        // where the points lie in the image, which no camera motion explains

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

TrackOptions StereoOptions() {
  TrackOptions options = MakeTrackOptions(Preset::kDefault);
  options.tracker.init.method = InitMethod::kStereo;
  options.threads = 2;
  return options;
}

class StereoRun : public testing::Test {
 protected:
  std::string Sequence(bool mono) const {
    RenderedSequence rendered;
    rendered.mono = mono;
    std::string path = folder_.Path(mono ? "mono" : "stereo");
    EXPECT_TRUE(ConvertSequence(rendered, path).ok());
    return path;
  }

  TestFolder folder_;
};

TEST_F(StereoRun, HasTrueMillimetersFromTheFirstFrameOn) {
  RunRequest request;
  request.input.image_path = Sequence(/*mono=*/false);
  request.output_path = folder_.Path("run");
  KeptReports observer;
  TrackObserver* const observers[] = {&observer};
  const auto summary = RunTrack(request, StereoOptions(), observers);
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->status, RunStatus::kCompleted) << summary->note;
  EXPECT_THAT(observer.warnings, IsEmpty());
  ASSERT_EQ(observer.reports.size(), Rendered().frames.size());
  std::vector<double> errors;  // relative, of depths
  for (std::size_t k = 0; k < observer.reports.size(); ++k) {
    const FrameReport& report = observer.reports[k];
    ASSERT_EQ(report.state, TrackingState::kTracking) << k;
    for (const PointObservation& seen : report.observations) {
      const auto depth_mm = SampleBilinear(Rendered().frames[k].depth, seen.pixel.x(), seen.pixel.y());
      if (depth_mm && *depth_mm > 0)
        errors.push_back(std::abs((*report.cam_from_world * seen.position).z() / *depth_mm - 1.0));
    }
    // The reference is the world, and the camera's way is in mm as well.
    const Rigid3 truth = Rendered().world_from_cam[0].Inverse() * Rendered().world_from_cam[k];
    EXPECT_LT((report.cam_from_world->Inverse().translation - truth.translation).norm(), kCamera_mm) << k;
  }
  EXPECT_GT(observer.reports[0].observations.size(), kMinMapped);
  EXPECT_LT(Median(errors), kDepthFromStereo);
}

TEST_F(StereoRun, KeepsACameraWhereItIsSaidToStandStill) {
  RunRequest request;
  request.input.image_path = Sequence(/*mono=*/false);
  request.input.end = 8;
  request.output_path = folder_.Path("run");
  TrackOptions options = StereoOptions();
  options.tracker.camera_motion = CameraMotion::kNone;
  KeptReports observer;
  TrackObserver* const observers[] = {&observer};
  const auto summary = RunTrack(request, options, observers);
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  ASSERT_EQ(observer.reports.size(), 8U);
  for (const FrameReport& report : observer.reports) {
    ASSERT_EQ(report.state, TrackingState::kTracking);
    EXPECT_EQ(report.cam_from_world->translation.norm(), 0.0);
    EXPECT_EQ(RotationAngle(report.cam_from_world->rotation), 0.0);
    EXPECT_TRUE(report.frame_idx == 0 || report.new_points.empty()) << "nothing tells the depth of a new point";
  }
  // All motion is the scene's: the points are where the last image has them.
  EXPECT_LT(observer.reports.back().median_reprojection_error_px, kFollowed_px);
}

TEST_F(StereoRun, WhatWasMeasuredIsNotReestimatedWhileItIsInView) {
  RunRequest request;
  request.input.image_path = Sequence(/*mono=*/false);
  const auto reestimated = [&](double max_measured_share) {
    request.output_path = folder_.Path("run" + std::to_string(max_measured_share));
    TrackOptions options = StereoOptions();
    options.image.working = WorkingImageMode::kFixed;
    options.tracker.growth.window = 12;
    options.tracker.growth.reestimate_every = 2;
    WindowInitOptions& window = options.tracker.init.window;  // which makes do with so few frames
    window.certain_depth_sigma = window.last_depth_sigma = window.max_depth_sigma = 1;
    window.min_certain_share = 0.01;
    window.deforming_frame = 1;
    options.tracker.growth.max_measured_share = max_measured_share;
    KeptReports observer;
    TrackObserver* const observers[] = {&observer};
    const auto summary = RunTrack(request, options, observers);
    EXPECT_TRUE(summary.ok() && summary->status == RunStatus::kCompleted);
    return std::count_if(observer.reports.begin(), observer.reports.end(), [](const FrameReport& report) {
      return report.note.starts_with("the map was re-estimated") && !report.refined_points.empty();
    });
  };
  EXPECT_EQ(reestimated(0.5), 0);
  EXPECT_GT(reestimated(2.0), 0);
}

TEST_F(StereoRun, OfASequenceWithoutPairsIsRefusedBeforeItStarts) {
  RunRequest request;
  request.input.image_path = Sequence(/*mono=*/true);
  request.output_path = folder_.Path("run");
  const auto summary = RunTrack(request, StereoOptions(), {});
  ASSERT_FALSE(summary.ok());
  EXPECT_EQ(summary.status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(summary.status().message(), HasSubstr("needs pairs"));
  EXPECT_FALSE(std::filesystem::exists(request.output_path));
}

TEST_F(StereoRun, SaysBeforeItStartsThatPairsAreSwappedOrDepthIsInAnotherUnit) {
  RunRequest request;
  request.input.image_path = folder_.Path("set");
  request.input.end = 14;
  RenderedSequence swapped;
  swapped.mono = false;
  swapped.swapped = true;
  ASSERT_TRUE(ConvertSequence(swapped, folder_.Path("set")).ok());
  request.output_path = folder_.Path("run");
  KeptReports observer;
  TrackObserver* const observers[] = {&observer};
  const auto failed = RunTrack(request, StereoOptions(), observers);
  ASSERT_TRUE(failed.ok()) << failed.status().message();
  EXPECT_EQ(failed->status, RunStatus::kFailed);
  EXPECT_THAT(observer.warnings, Contains(HasSubstr("left and right are swapped")));
  EXPECT_EQ(failed->description.warnings, observer.warnings);

  std::filesystem::remove_all(folder_.Path("set"));
  RenderedSequence in_cm;
  in_cm.mono = false;
  in_cm.depth_unit = 0.1;
  ASSERT_TRUE(ConvertSequence(in_cm, folder_.Path("set")).ok());
  TrackOptions options = StereoOptions();
  options.tracker.init.method = InitMethod::kDepth;
  observer.warnings.clear();
  request.output_path = folder_.Path("run2");
  ASSERT_TRUE(RunTrack(request, options, observers).ok());
  EXPECT_THAT(observer.warnings,
              Contains(HasSubstr("the depth images say 0.1 times what poses and baseline agree on")));
}

TEST_F(StereoRun, SaysBeforeTheFirstFrameThatARightImageIsCutOff) {
  RunRequest request;
  request.input.image_path = Sequence(/*mono=*/false);
  request.output_path = folder_.Path("run");
  std::filesystem::resize_file(std::filesystem::path(request.input.image_path) / "right/000000.png", 500);
  const auto summary = RunTrack(request, StereoOptions(), {});
  EXPECT_EQ(summary.status().code(), ErrorCode::kUnreadable);
  EXPECT_THAT(summary.status().message(), HasSubstr("right/000000.png is truncated"));
}

// Median relative error of the surface's depths in some frames.
double SurfaceError(const std::string& path) {
  const auto surface = ReadSurfaceFolder(path);
  EXPECT_TRUE(surface.ok()) << surface.status().message();
  std::vector<double> errors;
  for (const SurfaceFolder::Frame& frame : surface->frames) {
    const auto dense = ReadSurfaceDepth(*surface, frame);
    EXPECT_TRUE(dense.ok()) << dense.status().message();
    const cv::Mat& truth_mm = Rendered().frames[static_cast<std::size_t>(frame.frame_idx)].depth;
    for (int y = 0; y < truth_mm.rows; ++y)
      for (int x = 0; x < truth_mm.cols; ++x)
        if (dense->depth.at<float>(y, x) > 0 && truth_mm.at<float>(y, x) > 0)
          errors.push_back(std::abs(dense->depth.at<float>(y, x) / truth_mm.at<float>(y, x) - 1.0));
  }
  EXPECT_GT(errors.size(), 1000U);
  return Median(errors);
}

TEST_F(StereoRun, ItsSurfaceIsSeenInThePairs) {
  RunRequest request;
  request.input.image_path = Sequence(/*mono=*/false);
  request.output_path = folder_.Path("run");
  ASSERT_TRUE(RunTrack(request, StereoOptions(), {}).ok());
  SurfaceRequest surface;
  surface.run_path = folder_.Path("run");
  surface.output_path = folder_.Path("surface");
  surface.frames = {4, 8};
  SurfaceRunOptions options;
  options.mesh_columns = 0;
  const auto by_pairs = MakeSurface(surface, options, {});
  ASSERT_TRUE(by_pairs.ok()) << by_pairs.status().message();
  for (const SurfaceFrame& frame : by_pairs->frames) EXPECT_TRUE(frame.has_pair);
  EXPECT_LT(SurfaceError(surface.output_path), kDepthFromStereo);
  options.pairs = false;
  const auto by_neighbors = MakeSurface(surface, options, {});
  ASSERT_TRUE(by_neighbors.ok()) << by_neighbors.status().message();
  for (const SurfaceFrame& frame : by_neighbors->frames) EXPECT_FALSE(frame.has_pair);
}

}  // namespace
}  // namespace pliant
