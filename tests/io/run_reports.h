// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A small run, as a tracker would report it.
#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pliant/io/run_writer.h"

namespace pliant::run_reports {

inline const std::vector<std::string> kCosts = {"stretch", "bending"};
inline const std::vector<std::string> kStages = {"pyramid", "tracking"};
inline constexpr int kPoints = 6;

inline Camera TestCamera() {
  return Camera::Create("PINHOLE", 640, 480, std::vector<double>{500, 500, 319.5, 239.5}).value();
}

inline constexpr FirstMapFrames kFirstMap = {12,
                                             14,
                                             {.deforming = true,
                                              .points = 6,
                                              .depth_sigma = 0.0125,
                                              .still_camera_error_ratio = 1.75,
                                              .focal_length_factor = 0.6,
                                              .uses_prior = true}};
inline constexpr double kCoverage = 0.625;
inline constexpr double kFollowedCoverage = 0.75;

// Frame 0 waits; frames 1 and 2 have their poses from the first map; from frame 1 on, odd points are seen in odd frames
// only.
inline FrameReport Report(int frame) {
  FrameReport report;
  report.frame_idx = 10 + 2 * frame;
  report.name = std::to_string(report.frame_idx) + ".png";
  report.timestamp_s = frame / 25.0;
  report.stage_ms = {{"pyramid", 1.5}, {"tracking", 2.25}};
  report.losses = {{"similarity", frame}, {"border", 1}};
  if (frame == 0) return report;
  report.state = TrackingState::kTracking;
  report.cam_from_world = Rigid3(RotationExp({0, 0.01 * frame, 0}), Eigen::Vector3d(0.1 * frame, 0, 0.5));
  if (frame <= 2) report.first_map = kFirstMap;
  report.coverage = kCoverage;
  report.followed_coverage = kFollowedCoverage;
  if (frame > 1)
    report.prior = {frame % 2 == 0 ? PriorAgreement::kFalls : PriorAgreement::kAgrees, frame == 2, frame == 3};
  report.tracked = kPoints;
  for (int i = 0; i < kPoints; ++i) {
    const Eigen::Vector3d x(i - 2, 0.5 * i, 50 + 0.25 * frame);
    if (frame == 1) report.new_points.push_back({PointId{3 * i}, x, {10, 20, static_cast<std::uint8_t>(i)}});
    if (i % 2 == 1 && frame % 2 == 0) continue;
    report.observations.push_back({PointId{3 * i}, *TestCamera().Project(*report.cam_from_world * x), x, 0.9, 0.25});
  }
  report.costs = {{"stretch", 2.5}, {"bending", 0.125}};
  return report;
}

inline RunWriter Writer(const std::string& path, const RunWriterOptions& options = {}) {
  auto writer = RunWriter::Create(
      path, TestCamera(),
      {"0.1.0", {"pliant", "track"}, 7, "clip.mp4", "stereo.yaml", "masks", {"tracks"}, 0.75, 0.7, 21}, "Track:\n",
      {kCosts, kStages}, options);
  EXPECT_TRUE(writer.ok()) << writer.status().message();
  return std::move(writer).value();
}

inline void WriteRun(const std::string& path, int frames, const RunWriterOptions& options = {}) {
  RunWriter writer = Writer(path, options);
  for (int i = 0; i < frames; ++i) ASSERT_TRUE(writer.Write(Report(i)).ok());
  ASSERT_TRUE(writer.Finish(RunStatus::kLost, "too few points").ok());
}

}  // namespace pliant::run_reports
