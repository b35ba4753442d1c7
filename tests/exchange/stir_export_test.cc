// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Points of a run's start at its end, in the JSON of the STIR challenge.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/exchange/export.h"
#include "pliant/io/stir_file.h"
#include "support/small_run.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using testing::HasSubstr;

constexpr int kLast = kRunFrames - 1;
constexpr double kInterpolation_px = 0.5;  // of the motion of 23 px, between points that are 10 px apart
constexpr double kInterpolation_mm = 0.2;

Eigen::Vector3d InCamera(int point, int frame) { return PoseAt(frame) * PositionAt(point, frame); }
Eigen::Vector2d PixelAt(int point, int frame) { return *TestCamera().Project(InCamera(point, frame)); }

class StirExport : public testing::Test {
 protected:
  void WriteRun(std::optional<bool> metric) const {
    RunDescription description{"0.1.0", {"pliant"}, 7, "nowhere", {}};
    description.metric = metric;
    auto writer = RunWriter::Create(folder_.Path("run"), TestCamera(), description, "Track:\n", {});
    ASSERT_TRUE(writer.ok()) << writer.status().message();
    for (int frame = 0; frame < kRunFrames; ++frame) ASSERT_TRUE(writer->Write(Report(frame)).ok());
    ASSERT_TRUE(writer->Finish(RunStatus::kCompleted, "").ok());
  }
  Status Export(const ExportOptions& options) const {
    return ExportRun({folder_.Path("run"), "", "stir", folder_.Path("out")}, options).status();
  }
  std::vector<Eigen::Vector3d> Read(const std::string& name, const std::string& recording, int dimensions) const {
    const auto points = ReadStirPoints(folder_.Path("out/") + name);
    EXPECT_TRUE(points.ok()) << points.status().message();
    if (!points.ok()) return {};
    EXPECT_EQ(points->dimensions, dimensions);
    EXPECT_EQ(points->of_recording.size(), 1U);
    return points->of_recording.contains(recording) ? points->of_recording.at(recording)
                                                    : std::vector<Eigen::Vector3d>();
  }
  void WriteStart(const StirPoints& points) const {
    ASSERT_TRUE(WriteStirPoints(points, folder_.Path("start.json")).ok());
  }
  ExportOptions OfStart(const std::string& recording = "") const {
    ExportOptions options;
    options.start_points = folder_.Path("start.json");
    options.recording = recording;
    return options;
  }

  TestFolder folder_;
};

TEST_F(StirExport, LabelledPointsAreCarriedByThePointsAroundThem) {
  WriteRun(true);
  StirPoints start;
  for (const int point : {2, 5}) {  // the second one is not seen in every frame
    const Eigen::Vector2d pixel = PixelAt(point, 0);
    start.of_recording["0/left/seq00"].emplace_back(pixel.x(), pixel.y(), 0);
  }
  start.of_recording["0/left/seq01"] = {{1, 2, 0}};
  WriteStart(start);
  ASSERT_TRUE(Export(OfStart("0/left/seq00")).ok());
  const auto pixels = Read("positions.json", "0/left/seq00", 2);
  const auto points = Read("positions3d.json", "0/left/seq00", 3);
  ASSERT_EQ(pixels.size(), 2U);
  ASSERT_EQ(points.size(), 2U);
  for (const auto& [k, point] : {std::pair(0U, 2), std::pair(1U, 5)}) {
    ASSERT_GT((PixelAt(point, kLast) - PixelAt(point, 0)).norm(), 20 * kInterpolation_px);
    EXPECT_LT((pixels[k].head<2>() - PixelAt(point, kLast)).norm(), kInterpolation_px);
    EXPECT_LT((points[k] - InCamera(point, kLast)).norm(), kInterpolation_mm);
  }
  EXPECT_FALSE(std::filesystem::exists(folder_.Path("out/start.json")));
}

TEST_F(StirExport, WithoutLabelsTheRunsOwnPointsAreWritten) {
  WriteRun(true);
  ExportOptions options;
  options.recording = "mine";
  ASSERT_TRUE(Export(options).ok());
  const auto start = Read("start.json", "mine", 2);
  const auto pixels = Read("positions.json", "mine", 2);
  const auto points = Read("positions3d.json", "mine", 3);
  const auto start_points = Read("start3d.json", "mine", 3);
  ASSERT_EQ(pixels.size(), static_cast<std::size_t>(kRunPoints));
  for (int i = 0; i < kRunPoints; ++i) {
    EXPECT_LT((start[i].head<2>() - PixelAt(i, 0)).norm(), kFilePixel_px);
    EXPECT_LT((pixels[i].head<2>() - PixelAt(i, kLast)).norm(), kFilePixel_px);
    EXPECT_LT((points[i] - InCamera(i, kLast)).norm(), kFileLength_mm);
    EXPECT_LT((start_points[i] - InCamera(i, 0)).norm(), kFileLength_mm);
  }
}

TEST_F(StirExport, ARunWithoutAUnitHasPixelsAlone) {
  for (const std::optional<bool> metric : {std::optional<bool>(), std::optional(false)}) {
    WriteRun(metric);
    ASSERT_TRUE(Export({}).ok());
    EXPECT_TRUE(std::filesystem::exists(folder_.Path("out/positions.json")));
    EXPECT_FALSE(std::filesystem::exists(folder_.Path("out/positions3d.json")));
    for (const char* name : {"run", "out"}) std::filesystem::remove_all(folder_.Path(name));
  }
}

TEST_F(StirExport, LabelsNeedTheLastFrameToo) {
  WriteRun(true);
  WriteStart({2, {{"a", {{1, 2, 0}}}}});
  ExportOptions options = OfStart();
  options.stride = kRunFrames - 2;
  const Status status = Export(options);
  EXPECT_EQ(status.code(), ErrorCode::kInsufficient);
  EXPECT_THAT(status.message(), HasSubstr("a map has the frames 10 to 16"));
}

TEST_F(StirExport, LabelsThatDoNotServeAreRefused) {
  WriteRun(true);
  EXPECT_EQ(Export(OfStart()).code(), ErrorCode::kNotFound);
  WriteStart({2, {{"a", {{1, 2, 0}}}, {"b", {{1, 2, 0}}}}});
  EXPECT_THAT(Export(OfStart()).message(), HasSubstr("--Export.recording is the name of one of its 2"));
  EXPECT_THAT(Export(OfStart("c")).message(), HasSubstr("no points of the recording"));
  WriteStart({3, {{"a", {{1, 2, 3}}}}});
  EXPECT_THAT(Export(OfStart()).message(), HasSubstr("are pixels"));
  WriteStart({2, {{"a", {{1, 2, 0}}}}});
  EXPECT_TRUE(Export(OfStart()).ok());
}

TEST_F(StirExport, FilesOfTwoExportsAreNotMixed) {
  WriteRun(true);
  ASSERT_TRUE(Export({}).ok());
  WriteRun(false);
  EXPECT_EQ(Export({}).code(), ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace pliant
