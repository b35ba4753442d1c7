// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/exchange/export.h"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/colmap/check.h"
#include "pliant/colmap/convert.h"
#include "pliant/io/run_reader.h"
#include "pliant/io/run_writer.h"
#include "pliant/io/trajectory.h"
#include "support/test_folder.h"

namespace pliant {
namespace {

using testing::HasSubstr;

constexpr int kFrames = 5;  // frames 10, 12, ... 18
constexpr int kPoints = 8;  // ids 0, 3, ...; odd ones are seen in every second frame

Camera TestCamera() { return Camera::Create("PINHOLE", 640, 480, std::vector<double>{500, 500, 319.5, 239.5}).value(); }

Eigen::Vector3d Undeformed(int point) { return {point - 3.0, 0.5 * point - 2, 50}; }
Eigen::Vector3d PositionAt(int point, int frame) { return Undeformed(point) + Eigen::Vector3d(0, 0.25 * frame, 0); }
Rigid3 PoseAt(int frame) { return {RotationExp({0, 0.01 * frame, 0}), Eigen::Vector3d(0.1 * frame, 0, 0.5)}; }

FrameReport Report(int frame) {
  FrameReport report;
  report.frame_idx = 10 + 2 * frame;
  report.name = std::to_string(report.frame_idx) + ".png";
  report.timestamp_s = frame / 25.0;
  report.state = TrackingState::kTracking;
  report.cam_from_world = PoseAt(frame);
  for (int i = 0; i < kPoints; ++i) {
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
void WriteRun(const TestFolder& folder, End end = End::kFinished) {
  auto writer =
      RunWriter::Create(folder.Path("run"), TestCamera(), {"0.1.0", {"pliant"}, 7, "nowhere", {}}, "Track:\n", {});
  ASSERT_TRUE(writer.ok()) << writer.status().message();
  for (int frame = 0; frame < kFrames; ++frame) ASSERT_TRUE(writer->Write(Report(frame)).ok());
  if (end == End::kKilled) return;
  ASSERT_TRUE(writer->Finish(RunStatus::kCompleted, "").ok());
}

constexpr int kObservations = 3 * kPoints + 2 * (kPoints / 2);

Result<ExportSummary> Export(const TestFolder& folder, ExportFormat format, const ExportOptions& options = {}) {
  return ExportRun({folder.Path("run"), "", format, folder.Path("out")}, options);
}

colmap::Model ReadValidModel(const std::string& path) {
  const auto model = colmap::ReadModel(path);
  EXPECT_TRUE(model.ok()) << model.status().message();
  if (!model.ok()) return {};
  for (const colmap::Finding& finding : colmap::CheckModel(*model))
    EXPECT_NE(finding.severity, colmap::Severity::kError) << finding.what << ", " << finding.example;
  return *model;
}

Eigen::Vector3d PositionOf(const colmap::Point3D& point) { return {point.xyz[0], point.xyz[1], point.xyz[2]}; }

TEST(Export, CanonicalHasOnePointATrackAtItsUndeformedPosition) {
  for (const colmap::Format files : {colmap::Format::kBinary, colmap::Format::kText}) {
    const TestFolder folder;
    WriteRun(folder);
    ExportOptions options;
    options.files = files;
    const auto summary = Export(folder, ExportFormat::kCanonical, options);
    ASSERT_TRUE(summary.ok()) << summary.status().message();
    EXPECT_EQ(summary->frames, kFrames);
    EXPECT_EQ(summary->points, kPoints);
    EXPECT_EQ(summary->observations, kObservations);
    EXPECT_TRUE(summary->notes.empty());
    EXPECT_EQ(colmap::FindModel(folder.Path("out")).value(), files);
    const colmap::Model model = ReadValidModel(folder.Path("out"));
    ASSERT_EQ(model.images.size(), static_cast<std::size_t>(kFrames));
    EXPECT_EQ(model.images[1].name, "12.png");
    ASSERT_EQ(model.points3D.size(), static_cast<std::size_t>(kPoints));
    for (int i = 0; i < kPoints; ++i) {
      const colmap::Point3D& point = model.points3D[static_cast<std::size_t>(i)];
      EXPECT_EQ(point.id, static_cast<std::uint64_t>(3 * i));
      EXPECT_LT((PositionOf(point) - Undeformed(i)).norm(), 1e-6);
      EXPECT_EQ(point.rgb[2], i);
      EXPECT_EQ(point.track.size(), i % 2 == 0 ? 5U : 3U);
      EXPECT_LT(point.error, 1e-3);
    }
  }
}

TEST(Export, SpacetimeHasOnePointATrackAndFrameColouredByTime) {
  const TestFolder folder;
  WriteRun(folder);
  ASSERT_TRUE(Export(folder, ExportFormat::kSpacetime).ok());
  const colmap::Model model = ReadValidModel(folder.Path("out"));
  ASSERT_EQ(model.points3D.size(), static_cast<std::size_t>(kObservations));
  for (const colmap::Point3D& point : model.points3D) {
    const auto frame = (static_cast<int>(point.id / 1'000'000) - 10) / 2;
    const auto track = static_cast<int>(point.id % 1'000'000) / 3;
    EXPECT_LT((PositionOf(point) - PositionAt(track, frame)).norm(), 1e-6);
    ASSERT_EQ(point.track.size(), 1U);
    EXPECT_EQ(point.track[0].image_id, static_cast<std::uint32_t>(11 + 2 * frame));
  }
  EXPECT_EQ(model.points3D.front().rgb, (std::array<std::uint8_t, 3>{68, 1, 84}));
  EXPECT_EQ(model.points3D.back().rgb, (std::array<std::uint8_t, 3>{253, 231, 37}));
}

TEST(Export, FramesHasAModelAFrameThatReprojectsExactly) {
  const TestFolder folder;
  WriteRun(folder);
  ASSERT_TRUE(Export(folder, ExportFormat::kFrames).ok());
  for (int frame = 0; frame < kFrames; ++frame) {
    const colmap::Model model = ReadValidModel(folder.Path("out/0000" + std::to_string(10 + 2 * frame)));
    ASSERT_EQ(model.images.size(), 1U);
    const colmap::Image& image = model.images[0];
    const auto pose = colmap::ToPliant(image.cam_from_world);
    const auto camera = colmap::ToPliant(model.cameras[0]);
    ASSERT_TRUE(pose.ok() && camera.ok());
    ASSERT_EQ(model.points3D.size(), frame % 2 == 0 ? 8U : 4U);
    for (const colmap::Point3D& point : model.points3D) {
      const colmap::Point2D& keypoint = image.points2D[point.track[0].point2D_idx];
      EXPECT_LT((*camera->Project(*pose * PositionOf(point)) - colmap::ToPliant(keypoint)).norm(), 1e-3);
    }
  }
}

TEST(Export, PlyHasDisplacementsFromTheUndeformedPosition) {
  const TestFolder folder;
  WriteRun(folder);
  ASSERT_TRUE(Export(folder, ExportFormat::kPly).ok());
  const std::string ply = folder.Read("out/000016.ply");  // the fourth frame
  EXPECT_THAT(ply, HasSubstr("element vertex 4\n"));
  const std::size_t at = ply.find("end_header\n") + 11;
  constexpr std::size_t kRow = 3 * 4 + 3 + 4 + 3 * 4;
  ASSERT_EQ(ply.size(), at + 4 * kRow);
  float displacement = 0;
  std::memcpy(&displacement, ply.data() + at + kRow - 8, 4);
  EXPECT_FLOAT_EQ(displacement, 0.75F);
}

TEST(Export, TrajectoriesJoinATracksPositions) {
  const TestFolder folder;
  WriteRun(folder);
  ASSERT_TRUE(Export(folder, ExportFormat::kTrajectories).ok());
  const std::string ply = folder.Read("out/trajectories.ply");
  EXPECT_THAT(ply, HasSubstr("element vertex " + std::to_string(kObservations) + "\n"));
  EXPECT_THAT(ply, HasSubstr("element edge " + std::to_string(kObservations - kPoints) + "\n"));
  const std::size_t at = ply.find("end_header\n") + 11;
  constexpr std::size_t kVertex = 3 * 4 + 3 + 4 + 4;
  ASSERT_EQ(ply.size(), at + kObservations * kVertex + (kObservations - kPoints) * 8U);
  const auto track_of = [&](std::uint32_t vertex) {
    std::int32_t track = 0;
    std::memcpy(&track, ply.data() + at + vertex * kVertex + 15, 4);
    return track;
  };
  for (std::size_t edge = 0; edge < static_cast<std::size_t>(kObservations - kPoints); ++edge) {
    std::array<std::uint32_t, 2> ends{};
    std::memcpy(ends.data(), ply.data() + at + kObservations * kVertex + edge * 8, 8);
    ASSERT_LT(ends[0], ends[1]);
    EXPECT_EQ(track_of(ends[0]), track_of(ends[1]));
  }
}

TEST(Export, TumIsTheRunsPath) {
  const TestFolder folder;
  WriteRun(folder);
  ASSERT_TRUE(Export(folder, ExportFormat::kTum).ok());
  const auto poses = ReadTumTrajectory(folder.Path("out/trajectory.txt"));
  ASSERT_TRUE(poses.ok());
  ASSERT_EQ(poses->size(), static_cast<std::size_t>(kFrames));
  EXPECT_LT(((*poses)[2].world_from_cam.translation - PoseAt(2).Inverse().translation).norm(), 2e-6);
  EXPECT_EQ(folder.Read("out/trajectory.txt"), folder.Read("run/trajectory.txt"));
}

TEST(Export, Colmap4dHasATimeForEveryImageAndPoint) {
  const TestFolder folder;
  WriteRun(folder);
  ASSERT_TRUE(Export(folder, ExportFormat::kColmap4d).ok());
  EXPECT_EQ(folder.Read("out/times.bin").size(), 8U + kFrames * 12U);
  EXPECT_EQ(folder.Read("out/points_t.bin").size(), 8U + kObservations * 16U);
  std::int64_t time_ns = 0;
  std::memcpy(&time_ns, folder.Read("out/times.bin").data() + 8 + 12 + 4, 8);
  EXPECT_EQ(time_ns, 40'000'000);
  EXPECT_THAT(folder.Read("out/time_meta.json"), HasSubstr("\"time_convention\": \"mid_exposure\""));
  EXPECT_EQ(ReadValidModel(folder.Path("out")).images.size(), static_cast<std::size_t>(kFrames));
}

TEST(Export, AStrideLeavesFramesOut) {
  const TestFolder folder;
  WriteRun(folder);
  ExportOptions options;
  options.stride = 2;
  const auto summary = Export(folder, ExportFormat::kCanonical, options);
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->frames, 3);
  const colmap::Model model = ReadValidModel(folder.Path("out"));
  EXPECT_EQ(model.images.size(), 3U);
  for (const colmap::Point3D& point : model.points3D) EXPECT_EQ(point.track.size(), 3U);
}

TEST(Export, ARunThatWasKilledNeedsItsSequence) {
  const TestFolder folder;
  WriteRun(folder, End::kKilled);
  const auto summary = Export(folder, ExportFormat::kCanonical);
  EXPECT_EQ(summary.status().code(), ErrorCode::kNotFound);
  EXPECT_THAT(summary.status().message(), HasSubstr("no sparse/"));
}

TEST(Export, RefusesAFolderWithAModelInAnotherFormat) {
  const TestFolder folder;
  WriteRun(folder);
  ASSERT_TRUE(Export(folder, ExportFormat::kCanonical).ok());
  ExportOptions options;
  options.files = colmap::Format::kText;
  EXPECT_EQ(Export(folder, ExportFormat::kSpacetime, options).status().code(), ErrorCode::kInvalidArgument);
}

TEST(Export, ARunThatIsNotThereOrTrackedNothingIsSaid) {
  const TestFolder folder;
  EXPECT_EQ(Export(folder, ExportFormat::kTum).status().code(), ErrorCode::kNotFound);
  auto writer = RunWriter::Create(folder.Path("run"), TestCamera(), {"0.1.0", {"pliant"}, 7, "nowhere", {}}, "", {});
  ASSERT_TRUE(writer.ok());
  ASSERT_TRUE(writer->Finish(RunStatus::kFailed, "no map").ok());
  EXPECT_EQ(Export(folder, ExportFormat::kTum).status().code(), ErrorCode::kInsufficient);
}

}  // namespace
}  // namespace pliant
