// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/exchange/export.h"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/base/staged_folder.h"
#include "pliant/colmap/check.h"
#include "pliant/colmap/convert.h"
#include "pliant/io/run_reader.h"
#include "pliant/io/run_writer.h"
#include "pliant/io/track_file.h"
#include "pliant/io/trajectory.h"
#include "support/small_run.h"
#include "support/test_folder.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using testing::HasSubstr;

Result<ExportSummary> Export(const TestFolder& folder, const std::string& format, const ExportOptions& options = {}) {
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

TEST(Export, TracksAreThePixelsOfThePointsInBothForms) {
  const TestFolder folder;
  WriteRun(folder);
  for (const char* name : {"tracks.csv", "tracks.npz"}) {
    const auto summary = Export(folder, name == std::string("tracks.csv") ? "tracks_csv" : "tracks_npz");
    ASSERT_TRUE(summary.ok()) << summary.status().message();
    const auto file = ReadTrackFile(folder.Path("out/") + name);
    ASSERT_TRUE(file.ok()) << file.status().message();
    ASSERT_EQ(file->tracks.size(), static_cast<std::size_t>(kRunPoints));
    for (int i = 0; i < kRunPoints; ++i) {
      const PixelTrack& track = file->tracks[static_cast<std::size_t>(i)];
      EXPECT_EQ(track.id, PointId{3 * i});
      EXPECT_EQ(PixelIn(track, 12) == nullptr, i % 2 == 1);
      const Eigen::Vector2d pixel = *TestCamera().Project(PoseAt(2) * PositionAt(i, 2));
      EXPECT_LT((PixelIn(track, 14)->pixel - pixel).norm(), kFilePixel_px);
    }
  }
  EXPECT_EQ(ReadTrackFile(folder.Path("out/tracks.npz"))->frames, 19);  // what the run read: the images are not there
}

TEST(Export, CanonicalHasOnePointATrackAtItsUndeformedPosition) {
  for (const colmap::Format files : {colmap::Format::kBinary, colmap::Format::kText}) {
    const TestFolder folder;
    WriteRun(folder);
    ExportOptions options;
    options.files = files;
    const auto summary = Export(folder, "canonical", options);
    ASSERT_TRUE(summary.ok()) << summary.status().message();
    EXPECT_EQ(summary->frames, kRunFrames);
    EXPECT_EQ(summary->points, kRunPoints);
    EXPECT_EQ(summary->observations, kRunObservations);
    EXPECT_TRUE(summary->notes.empty());
    EXPECT_EQ(colmap::FindModel(folder.Path("out")).value(), files);
    const colmap::Model model = ReadValidModel(folder.Path("out"));
    ASSERT_EQ(model.images.size(), static_cast<std::size_t>(kRunFrames));
    EXPECT_EQ(model.images[1].name, "12.png");
    ASSERT_EQ(model.points3D.size(), static_cast<std::size_t>(kRunPoints));
    for (int i = 0; i < kRunPoints; ++i) {
      const colmap::Point3D& point = model.points3D[static_cast<std::size_t>(i)];
      EXPECT_EQ(point.id, static_cast<std::uint64_t>(3 * i));
      EXPECT_LT((PositionOf(point) - Undeformed(i)).norm(), kFileLength_mm);
      EXPECT_EQ(point.rgb[2], i);
      EXPECT_EQ(point.track.size(), i % 2 == 0 ? 5U : 3U);
      EXPECT_LT(point.error, kExactReprojection_px);
    }
  }
}

TEST(Export, SpacetimeHasOnePointATrackAndFrameColoredByTime) {
  const TestFolder folder;
  WriteRun(folder);
  ASSERT_TRUE(Export(folder, "spacetime").ok());
  const colmap::Model model = ReadValidModel(folder.Path("out"));
  ASSERT_EQ(model.points3D.size(), static_cast<std::size_t>(kRunObservations));
  for (const colmap::Point3D& point : model.points3D) {
    const auto frame = (static_cast<int>(point.id / 1'000'000) - 10) / 2;
    const auto track = static_cast<int>(point.id % 1'000'000) / 3;
    EXPECT_LT((PositionOf(point) - PositionAt(track, frame)).norm(), kFileLength_mm);
    ASSERT_EQ(point.track.size(), 1U);
    EXPECT_EQ(point.track[0].image_id, static_cast<std::uint32_t>(11 + 2 * frame));
  }
  EXPECT_EQ(model.points3D.front().rgb, (std::array<std::uint8_t, 3>{68, 1, 84}));
  EXPECT_EQ(model.points3D.back().rgb, (std::array<std::uint8_t, 3>{253, 231, 37}));
}

TEST(Export, FramesHasAModelAFrameThatReprojectsExactly) {
  const TestFolder folder;
  WriteRun(folder);
  ASSERT_TRUE(Export(folder, "frames").ok());
  for (int frame = 0; frame < kRunFrames; ++frame) {
    const colmap::Model model = ReadValidModel(folder.Path("out/0000" + std::to_string(10 + 2 * frame)));
    ASSERT_EQ(model.images.size(), 1U);
    const colmap::Image& image = model.images[0];
    const auto pose = colmap::ToPliant(image.cam_from_world);
    const auto camera = colmap::ToPliant(model.cameras[0]);
    ASSERT_TRUE(pose.ok() && camera.ok());
    ASSERT_EQ(model.points3D.size(), frame % 2 == 0 ? 8U : 4U);
    for (const colmap::Point3D& point : model.points3D) {
      const colmap::Point2D& keypoint = image.points2D[point.track[0].point2D_idx];
      EXPECT_LT((*camera->Project(*pose * PositionOf(point)) - colmap::ToPliant(keypoint)).norm(),
                kExactReprojection_px);
    }
  }
}

TEST(Export, PlyHasDisplacementsFromTheUndeformedPosition) {
  const TestFolder folder;
  WriteRun(folder);
  ASSERT_TRUE(Export(folder, "ply").ok());
  const std::string ply = folder.Read("out/000016.ply");  // the fourth frame
  EXPECT_THAT(ply, HasSubstr("element vertex 4\n"));
  const std::size_t at = ply.find("end_header\n") + 11;
  constexpr std::size_t kRow = 3 * 4 + 3 + 4 + 3 * 4;
  ASSERT_EQ(ply.size(), at + 4 * kRow);
  float displacement = 0;
  std::memcpy(&displacement, ply.data() + at + kRow - 8, 4);
  EXPECT_FLOAT_EQ(displacement, 0.75F);
}

TEST(Export, TrajectoriesConnectATracksPositions) {
  const TestFolder folder;
  WriteRun(folder);
  ASSERT_TRUE(Export(folder, "trajectories").ok());
  const std::string ply = folder.Read("out/trajectories.ply");
  EXPECT_THAT(ply, HasSubstr("element vertex " + std::to_string(kRunObservations) + "\n"));
  EXPECT_THAT(ply, HasSubstr("element edge " + std::to_string(kRunObservations - kRunPoints) + "\n"));
  const std::size_t at = ply.find("end_header\n") + 11;
  constexpr std::size_t kVertex = 3 * 4 + 3 + 4 + 4;
  ASSERT_EQ(ply.size(), at + kRunObservations * kVertex + (kRunObservations - kRunPoints) * 8U);
  const auto track_of = [&](std::uint32_t vertex) {
    std::int32_t track = 0;
    std::memcpy(&track, ply.data() + at + vertex * kVertex + 15, 4);
    return track;
  };
  for (std::size_t edge = 0; edge < static_cast<std::size_t>(kRunObservations - kRunPoints); ++edge) {
    std::array<std::uint32_t, 2> ends{};
    std::memcpy(ends.data(), ply.data() + at + kRunObservations * kVertex + edge * 8, 8);
    ASSERT_LT(ends[0], ends[1]);
    EXPECT_EQ(track_of(ends[0]), track_of(ends[1]));
  }
}

TEST(Export, TumIsTheRunsPath) {
  const TestFolder folder;
  WriteRun(folder);
  ASSERT_TRUE(Export(folder, "tum").ok());
  const auto poses = ReadTumTrajectory(folder.Path("out/trajectory.txt"));
  ASSERT_TRUE(poses.ok());
  ASSERT_EQ(poses->size(), static_cast<std::size_t>(kRunFrames));
  EXPECT_LT(((*poses)[2].world_from_cam.translation - PoseAt(2).Inverse().translation).norm(), kFileLength_mm);
  EXPECT_EQ(folder.Read("out/trajectory.txt"), folder.Read("run/trajectory.txt"));
}

TEST(Export, Colmap4dHasATimeForEveryImageAndPoint) {
  const TestFolder folder;
  WriteRun(folder);
  ASSERT_TRUE(Export(folder, "colmap4d").ok());
  EXPECT_EQ(folder.Read("out/times.bin").size(), 8U + kRunFrames * 12U);
  EXPECT_EQ(folder.Read("out/points_t.bin").size(), 8U + kRunObservations * 16U);
  std::int64_t time_ns = 0;
  std::memcpy(&time_ns, folder.Read("out/times.bin").data() + 8 + 12 + 4, 8);
  EXPECT_EQ(time_ns, 40'000'000);
  EXPECT_THAT(folder.Read("out/time_meta.json"), HasSubstr("\"time_convention\": \"mid_exposure\""));
  EXPECT_EQ(ReadValidModel(folder.Path("out")).images.size(), static_cast<std::size_t>(kRunFrames));
}

TEST(Export, AStrideLeavesFramesOut) {
  const TestFolder folder;
  WriteRun(folder);
  ExportOptions options;
  options.stride = 2;
  const auto summary = Export(folder, "canonical", options);
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->frames, 3);
  const colmap::Model model = ReadValidModel(folder.Path("out"));
  EXPECT_EQ(model.images.size(), 3U);
  ASSERT_FALSE(model.points3D.empty());
  for (const colmap::Point3D& point : model.points3D) EXPECT_EQ(point.track.size(), 3U);
}

TEST(Export, EverySubmapHasAFolder) {
  for (const auto& [format, file] :
       {std::pair{std::string("canonical"), "points3D.bin"}, std::pair{std::string("tum"), "trajectory.txt"},
        std::pair{std::string("ply"), "000010.ply"}, std::pair{std::string("trajectories"), "trajectories.ply"}}) {
    const TestFolder folder;
    WriteRunOfTwoSubmaps(folder);
    const auto summary = Export(folder, format);
    ASSERT_TRUE(summary.ok()) << summary.status().message();
    EXPECT_EQ(summary->frames, 2 * kRunFrames);
    EXPECT_EQ(summary->points, 2 * kRunPoints);
    EXPECT_EQ(summary->observations, 2 * kRunObservations);
    ASSERT_EQ(summary->notes.size(), 1U);
    EXPECT_THAT(summary->notes[0], HasSubstr("2 submaps"));
    EXPECT_TRUE(std::filesystem::exists(folder.Path("out/0/" + std::string(file)))) << file;
    EXPECT_FALSE(std::filesystem::exists(folder.Path("out/" + std::string(file)))) << file;
    if (format != "canonical") continue;
    const colmap::Model second = ReadValidModel(folder.Path("out/1"));
    ASSERT_EQ(second.images.size(), static_cast<std::size_t>(kRunFrames));
    EXPECT_EQ(second.images[0].name, "20.png");
    ASSERT_EQ(second.points3D.size(), static_cast<std::size_t>(kRunPoints));
    EXPECT_EQ(second.points3D[1].id, 103U);
    EXPECT_LT((PositionOf(second.points3D[1]) - Undeformed(1)).norm(), kFileLength_mm);
  }
}

TEST(Export, FilesAFrameAreNotAddedToThoseThatAreThere) {
  const TestFolder folder;
  WriteRun(folder);
  for (const char* format : {"frames", "ply"}) {
    ASSERT_TRUE(Export(folder, format).ok());
    ExportOptions options;
    options.stride = 2;
    const Status again = Export(folder, format, options).status();
    EXPECT_EQ(again.code(), ErrorCode::kInvalidArgument);
    EXPECT_THAT(again.message(), HasSubstr("is there already; delete it or give another --output_path"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder.Path("out/.unfinished")));
}

TEST(Export, ARunsOwnFolderIsNotWrittenInto) {
  const TestFolder folder;
  WriteRun(folder);
  const std::string path = folder.Read("run/trajectory.txt");
  for (const ExportFormat& format : ExportFormats()) {
    const std::string name(format.name);
    const Status status = ExportRun({folder.Path("run"), "", name, folder.Path("run")}, {}).status();
    EXPECT_EQ(status.code(), ErrorCode::kInvalidArgument) << name;
    EXPECT_THAT(status.message(), HasSubstr("holds a run; give another --output_path")) << name;
  }
  EXPECT_EQ(folder.Read("run/trajectory.txt"), path);
  ExportOptions options;
  options.stride = 2;
  EXPECT_TRUE(ExportRun({folder.Path("run"), "", "tum", folder.Path("run/tum")}, options).ok());
  EXPECT_EQ(folder.Read("run/trajectory.txt"), path);
  EXPECT_NE(folder.Read("run/tum/trajectory.txt"), "");
}

TEST(Export, ARunThatWasKilledNeedsItsSequence) {
  const TestFolder folder;
  WriteRun(folder, End::kKilled);
  const auto summary = Export(folder, "canonical");
  EXPECT_EQ(summary.status().code(), ErrorCode::kNotFound);
  EXPECT_THAT(summary.status().message(), HasSubstr("no sparse/"));
}

// What it had written of its model is none.
TEST(Export, ARunThatWasKilledWhileItWroteItsModelNeedsItsSequence) {
  const TestFolder folder;
  WriteRun(folder, End::kKilled);
  std::filesystem::create_directories(folder.Path("run/sparse"));
  folder.Write("run/sparse/cameras.bin.tmp", "half");
  const auto summary = Export(folder, "canonical");
  EXPECT_EQ(summary.status().code(), ErrorCode::kNotFound);
  EXPECT_THAT(summary.status().message(), HasSubstr("no sparse/"));
}

TEST(Export, OneWritesIntoAFolderAtATime) {
  const TestFolder folder;
  WriteRun(folder);
  std::filesystem::create_directories(folder.Path("out"));
  const auto other = StagedFolder::Create(folder.Path("out"), {});
  ASSERT_TRUE(other.ok());
  EXPECT_EQ(Export(folder, "ply").status().code(), ErrorCode::kUnwritable);
}

TEST(Export, RefusesAFolderWithAModelInAnotherFormat) {
  const TestFolder folder;
  WriteRun(folder);
  ASSERT_TRUE(Export(folder, "canonical").ok());
  ExportOptions options;
  options.files = colmap::Format::kText;
  EXPECT_EQ(Export(folder, "spacetime", options).status().code(), ErrorCode::kInvalidArgument);
}

TEST(Export, RefusesAFolderWhoseRigsWouldStay) {
  const TestFolder folder;
  WriteRun(folder);
  std::filesystem::create_directories(folder.Path("out"));
  folder.Write("out/frames.bin", "of another model");
  const Status status = Export(folder, "canonical").status();
  EXPECT_EQ(status.code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(status.message(), testing::HasSubstr("frames.bin"));
}

TEST(Export, RefusesIdsThatWouldBeThoseOfTheNextFrame) {
  const TestFolder folder;
  auto writer = RunWriter::Create(folder.Path("run"), TestCamera(), {"0.1.0", {"pliant"}, 7, "nowhere", {}}, "", {});
  ASSERT_TRUE(writer.ok());
  for (int frame = 0; frame < kRunFrames; ++frame) {
    FrameReport report = Report(frame);
    for (NewPoint& point : report.new_points) point.id.value += 1'000'000;
    for (PointObservation& seen : report.observations) seen.id.value += 1'000'000;
    ASSERT_TRUE(writer->Write(report).ok());
  }
  ASSERT_TRUE(writer->Finish(RunStatus::kCompleted, "").ok());
  const Status status = Export(folder, "spacetime").status();
  EXPECT_EQ(status.code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(status.message(), testing::HasSubstr("use the format canonical"));
  EXPECT_TRUE(Export(folder, "canonical").ok());
}

TEST(Export, AnUnknownFormatIsRefusedWithTheKnownOnes) {
  const TestFolder folder;
  WriteRun(folder);
  const Status status = Export(folder, "canonicle").status();
  EXPECT_EQ(status.code(), ErrorCode::kInvalidArgument);
  for (const ExportFormat& format : ExportFormats()) EXPECT_THAT(status.message(), HasSubstr(std::string(format.name)));
  EXPECT_FALSE(std::filesystem::exists(folder.Path("out")));
}

TEST(Export, ARunThatIsNotThereOrTrackedNothingIsSaid) {
  const TestFolder folder;
  EXPECT_EQ(Export(folder, "tum").status().code(), ErrorCode::kNotFound);
  auto writer = RunWriter::Create(folder.Path("run"), TestCamera(), {"0.1.0", {"pliant"}, 7, "nowhere", {}}, "", {});
  ASSERT_TRUE(writer.ok());
  ASSERT_TRUE(writer->Finish(RunStatus::kFailed, "no map").ok());
  EXPECT_EQ(Export(folder, "tum").status().code(), ErrorCode::kInsufficient);
}

}  // namespace
}  // namespace pliant
