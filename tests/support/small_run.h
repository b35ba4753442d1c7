// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A run of a few points that move, as a tracker would have written it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pliant/camera/camera.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/io/run_writer.h"
#include "support/test_folder.h"

namespace pliant {

inline constexpr int kRunFrames = 5;  // frames 10, 12, ... 18
inline constexpr int kRunPoints = 8;  // ids 0, 3, ...; odd ones are seen in every second frame

inline Camera TestCamera() {
  return Camera::Create("PINHOLE", 640, 480, std::vector<double>{500, 500, 319.5, 239.5}).value();
}

inline Eigen::Vector3d Undeformed(int point) { return {point - 3.0, 0.5 * point - 2, 50}; }
inline Eigen::Vector3d PositionAt(int point, int frame) {
  return Undeformed(point) + Eigen::Vector3d(0, 0.25 * frame, 0);
}
inline Rigid3 PoseAt(int frame) { return {RotationExp({0, 0.01 * frame, 0}), Eigen::Vector3d(0.1 * frame, 0, 0.5)}; }

inline FrameReport Report(int frame) {
  FrameReport report;
  report.frame_idx = 10 + 2 * frame;
  report.name = std::to_string(report.frame_idx) + ".png";
  report.timestamp_s = frame / 25.0;
  report.state = TrackingState::kTracking;
  report.cam_from_world = PoseAt(frame);
  for (int i = 0; i < kRunPoints; ++i) {
    if (frame == 0)
      report.new_points.push_back({PointId{3 * i}, Undeformed(i), {10, 20, static_cast<std::uint8_t>(i)}});
    if (i % 2 == 1 && frame % 2 == 1) continue;
    const Eigen::Vector3d x = PositionAt(i, frame);
    report.observations.push_back({PointId{3 * i}, *TestCamera().Project(*report.cam_from_world * x), x, 0.9});
  }
  return report;
}

enum class End { kFinished, kKilled };

// A run in `folder`/run; without deformation at frame 0.
inline void WriteRun(const TestFolder& folder, End end = End::kFinished) {
  auto writer =
      RunWriter::Create(folder.Path("run"), TestCamera(), {"0.1.0", {"pliant"}, 7, "nowhere", {}}, "Track:\n", {});
  ASSERT_TRUE(writer.ok()) << writer.status().message();
  for (int frame = 0; frame < kRunFrames; ++frame) ASSERT_TRUE(writer->Write(Report(frame)).ok());
  if (end == End::kKilled) return;
  ASSERT_TRUE(writer->Finish(RunStatus::kCompleted, "").ok());
}

// The same twice over: from the sixth frame on as a submap of its own, whose points are others.
inline FrameReport ReportOfSecondSubmap(int frame) {
  FrameReport report = Report(frame);
  report.frame_idx += 2 * kRunFrames;
  report.name = std::to_string(report.frame_idx) + ".png";
  report.timestamp_s += kRunFrames / 25.0;
  report.submap = 1;
  for (NewPoint& point : report.new_points) point.id.value += 100;
  for (PointObservation& seen : report.observations) seen.id.value += 100;
  return report;
}

inline void WriteRunOfTwoSubmaps(const TestFolder& folder) {
  auto writer =
      RunWriter::Create(folder.Path("run"), TestCamera(), {"0.1.0", {"pliant"}, 7, "nowhere", {}}, "Track:\n", {});
  ASSERT_TRUE(writer.ok()) << writer.status().message();
  for (int frame = 0; frame < kRunFrames; ++frame) ASSERT_TRUE(writer->Write(Report(frame)).ok());
  for (int frame = 0; frame < kRunFrames; ++frame) ASSERT_TRUE(writer->Write(ReportOfSecondSubmap(frame)).ok());
  ASSERT_TRUE(writer->Finish(RunStatus::kCompleted, "").ok());
}

inline constexpr int kRunObservations = 3 * kRunPoints + 2 * (kRunPoints / 2);  // of that run

}  // namespace pliant
