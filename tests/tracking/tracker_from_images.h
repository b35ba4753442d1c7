// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A tracker that is shown the images of a small simulated scene, and what its reports have to be like.
#pragma once

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "pliant/tracking/tracker.h"
#include "simulation/small_scene.h"

namespace pliant::tracking_test {

inline constexpr int kFrames = 14;
inline constexpr double kLargestSsim = 1;  // of equal patches
// A rigid scene: what is left is the error of a track, in single views up to what the initializer's root mean square
// over 8 views lets through.
inline constexpr double kMedianError_px = 0.3;
inline constexpr double kLargestError_px = 1.5 * 2.83;

class TrackerFromImages : public testing::Test {
 protected:
  // The sequence is rendered once for all tests.
  static void SetUpTestSuite() {
    SimulationOptions scene = simulation_test::SmallScene(TrajectoryKind::kSway, kFrames);
    scene.camera.width = 320;
    scene.camera.height = 240;
    scene.deformation.amplitude_mm = 0;
    scene.trajectory.sway_period_s = 2.0;
    Simulator simulator = simulation_test::Make(scene);
    camera_ = new Camera(simulator.camera());
    images_ = new std::vector<cv::Mat>();
    for (int i = 0; i < kFrames; ++i) images_->push_back(simulator.Render(i).image.clone());
    depth_ = new cv::Mat(simulator.Render(0).depth.clone());
  }
  static void TearDownTestSuite() {
    delete camera_;
    delete images_;
    delete depth_;
  }

  static Tracker MakeTracker(const TrackerOptions& options = {}) { return {*camera_, options, 1, 1}; }
  static std::string NameOf(int frame_idx) { return "image" + std::to_string(frame_idx) + ".png"; }
  // Shows the tracker image `image_idx` as the sequence's frame `frame_idx`.
  static std::vector<FrameReport> Show(int image_idx, int frame_idx, Tracker* tracker) {
    return tracker->Process(PrepareFrame(frame_idx, NameOf(frame_idx), frame_idx / 30.0,
                                         (*images_)[static_cast<std::size_t>(image_idx)], {}, {}));
  }

  // The sequence ends, unless the tracker has gone back to a frame. Appends the reports that were held back, and
  // returns the frame that it went back to.
  static std::optional<int> End(std::optional<int> back, Tracker* tracker, std::vector<FrameReport>* reports) {
    if (!back) {
      tracker->EndSequence();
      back = tracker->TakeGoesBackTo();
    }
    for (FrameReport& report : tracker->Finish()) reports->push_back(std::move(report));
    for (int k = 0; k < std::ssize(*reports); ++k) EXPECT_EQ((*reports)[static_cast<std::size_t>(k)].frame_idx, k);
    return back;
  }

  // All images, from the depth of the first one. `hide` (frame, mask) sets to 0 what a frame does not show.
  template <class Function>
  static std::vector<FrameReport> RunMasked(const TrackerOptions& options, const Function& hide) {
    Tracker tracker = MakeTracker(options);
    std::vector<FrameReport> reports;
    for (int i = 0; i < kFrames; ++i) {
      cv::Mat mask(images_->front().size(), CV_8UC1, cv::Scalar(255));
      hide(i, mask);
      PreparedFrame frame =
          PrepareFrame(i, NameOf(i), i / 30.0, (*images_)[static_cast<std::size_t>(i)], mask, options);
      frame.known_depth_mm = [depth = *depth_] { return depth; };
      for (FrameReport& report : tracker.Process(frame)) reports.push_back(std::move(report));
    }
    return reports;
  }

  static inline const Camera* camera_ = nullptr;
  static inline std::vector<cv::Mat>* images_ = nullptr;
  static inline cv::Mat* depth_ = nullptr;  // of the first image
};

// Pose, points of the map alone, and reprojections on the pixels.
inline void ExpectFromTheMap(const FrameReport& report, const std::set<PointId>& map, const Camera& camera) {
  EXPECT_EQ(report.state, TrackingState::kTracking);
  ASSERT_TRUE(report.cam_from_world);
  ASSERT_FALSE(report.observations.empty());
  EXPECT_EQ(report.optimized, static_cast<int>(report.observations.size()));
  EXPECT_GE(report.tracked, report.optimized);
  std::vector<double> errors;
  PointId last;
  for (const PointObservation& seen : report.observations) {
    EXPECT_TRUE(map.contains(seen.id));
    EXPECT_LT(last, seen.id);
    EXPECT_GT(seen.ssim, 0);
    EXPECT_LE(seen.ssim, kLargestSsim);
    last = seen.id;
    const auto projected = camera.Project(*report.cam_from_world * seen.position);
    ASSERT_TRUE(projected);
    errors.push_back((*projected - seen.pixel).norm());
  }
  EXPECT_LT(*std::max_element(errors.begin(), errors.end()), kLargestError_px);
  EXPECT_LT(simulation_test::Median(errors), kMedianError_px);
  EXPECT_LT(report.median_reprojection_error_px, kMedianError_px);
}

}  // namespace pliant::tracking_test
