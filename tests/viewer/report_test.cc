// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/viewer/report.h"

#include <cmath>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "viewer/small_sequence.h"
#include "viewer/unpack_array.h"

namespace pliant {
namespace {

using nlohmann::ordered_json;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kQuantized_mm = 1e-3;   // 16 bits over the extent of the points
constexpr double kFloatPose_mm = 1e-4;   // poses are packed as floats
constexpr double kQuantizedGain = 0.01;  // gains are packed in steps

class ReportTest : public testing::Test {
 protected:
  void SetUp() override { WriteRun(folder_); }

  Result<ReportSummary> Write(const ReportOptions& options = {}) {
    return WriteReportPage({.run_paths = {folder_.Path("run")}, .sequence_path = sequence_, .camera_path = ""}, options,
                           folder_.Path("report.html"));
  }
  // What the page was given.
  ordered_json Data() const {
    const std::string page = folder_.Read("report.html");
    const std::string begin = "<script type=\"application/json\" id=\"pliant-data\">";
    const std::size_t at = page.find(begin) + begin.size();
    return ordered_json::parse(page.substr(at, page.find("</script>", at) - at));
  }

  TestFolder folder_;
  std::string sequence_;
};

TEST_F(ReportTest, EndsOnRequestAndLeavesTheReportBefore) {
  WriteSmallSequence(folder_.Path("seq"), Truth::kDepthAndPoses);
  sequence_ = folder_.Path("seq");
  ASSERT_TRUE(Write().ok());
  const std::string before = folder_.Read("report.html");
  std::set<std::string> tasks;
  for (const std::string last : {"evaluate", "images"}) {
    const auto summary =
        WriteReportPage({.run_paths = {folder_.Path("run")}, .sequence_path = sequence_, .camera_path = ""}, {},
                        folder_.Path("report.html"), [&](std::string_view task, int /*done*/, int total) {
                          EXPECT_GE(total, kRunFrames);
                          tasks.emplace(task);
                          return task != last;
                        });
    EXPECT_EQ(summary.status().code(), ErrorCode::kInterrupted);
    EXPECT_EQ(folder_.Read("report.html"), before);
  }
  EXPECT_THAT(tasks, ElementsAre("evaluate", "images"));
}

TEST_F(ReportTest, HoldsTheRun) {
  const auto summary = Write();
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->frames, kRunFrames);
  EXPECT_EQ(summary->observations, kRunObservations);
  EXPECT_EQ(summary->images, 0U);
  const ordered_json data = Data();
  EXPECT_EQ(data["format"], 1);
  EXPECT_EQ(data["unit"], "map units");
  EXPECT_TRUE(data["images"].is_null());
  EXPECT_TRUE(data["truth"].is_null());
  EXPECT_EQ(data["camera"]["corners"].size(), 4U);
  const ordered_json& run = data["runs"][0];
  EXPECT_THAT(run["frames"]["frame"], ElementsAre(10, 12, 14, 16, 18));
  EXPECT_THAT(Unpack(run["points"]["id"]), ElementsAre(0, 3, 6, 9, 12, 15, 18, 21));
  EXPECT_THAT(run["observations"]["count"], ElementsAre(5, 3, 5, 3, 5, 3, 5, 3));
  const std::vector<double> rows = Unpack(run["observations"]["row"]);
  EXPECT_THAT(std::vector<double>(rows.begin(), rows.begin() + 8), ElementsAre(0, 1, 2, 3, 4, 0, 2, 4));
  const std::vector<double> positions = Unpack(run["observations"]["position"]);
  const Eigen::Vector3d third = PositionAt(1, 2);  // of the second point, its second observation
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(positions[static_cast<std::size_t>(3 * 6 + i)], third[i], kQuantized_mm);
  const std::vector<double> poses = Unpack(run["frames"]["pose"]);
  EXPECT_NEAR(poses[7 * 3 + 4], PoseAt(3).Inverse().translation.x(), kFloatPose_mm);
  EXPECT_TRUE(run["observations"]["gain"].is_null());
}

// A frame of the first map, one that the joint problem was solved for, one without a pose.
TEST_F(ReportTest, WhatARunCouldNotMeasureIsNotZero) {
  constexpr double kFirstMap_px = 0.5;
  constexpr double kJoint_px = 0.001;
  {
    auto writer = RunWriter::Create(folder_.Path("run"), TestCamera(), {"0.1.0", {"pliant"}, 7, "nowhere", {}},
                                    "Track:\n", {.costs = {"reprojection", "edge_length"}, .stages = {}});
    ASSERT_TRUE(writer.ok()) << writer.status().message();
    FrameReport report = Report(0);
    report.median_reprojection_error_px = kFirstMap_px;
    ASSERT_TRUE(writer->Write(report).ok());
    report = Report(1);
    report.costs = {{"reprojection", 2.0}, {"edge_length", 0.0}};
    report.median_reprojection_error_px = kJoint_px;
    ASSERT_TRUE(writer->Write(report).ok());
    FrameReport lost;
    lost.frame_idx = Report(2).frame_idx;
    lost.timestamp_s = Report(2).timestamp_s;
    lost.state = TrackingState::kLost;
    ASSERT_TRUE(writer->Write(lost).ok());
    ASSERT_TRUE(writer->Finish(RunStatus::kCompleted, "").ok());
  }
  ASSERT_TRUE(Write().ok());
  const ordered_json frames = Data()["runs"][0]["frames"];
  EXPECT_THAT(frames["reprojection_px"], ElementsAre(kFirstMap_px, kJoint_px, nullptr));
  EXPECT_THAT(frames["costs"]["reprojection"], ElementsAre(nullptr, 2.0, nullptr));
  EXPECT_THAT(frames["costs"]["edge length"], ElementsAre(nullptr, 0.0, nullptr));
}

TEST_F(ReportTest, SaysWhereLengthsAreMillimeters) {
  folder_.Write("run/config.yaml", "Init:\n  method: stereo\n");
  ASSERT_TRUE(Write().ok());
  EXPECT_EQ(Data()["unit"], "mm");
  EXPECT_EQ(Data()["runs"][0]["unit"], "mm");
}

TEST_F(ReportTest, HoldsImagesAndWhatTheySayOfBrightness) {
  sequence_ = folder_.Path("sequence");
  WriteSmallSequence(sequence_, Truth::kDepthAndPoses);
  ReportOptions options;
  options.image_width_px = 320;
  const auto summary = Write(options);
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->images, static_cast<std::size_t>(kRunFrames));
  const ordered_json data = Data();
  EXPECT_EQ(data["unit"], "mm");  // the truth's
  EXPECT_EQ(data["runs"][0]["unit"], "map units");
  EXPECT_EQ(data["truth"]["frame"].size(), static_cast<std::size_t>(kRunFrames));
  EXPECT_DOUBLE_EQ(data["images"]["scale"], 0.5);
  EXPECT_THAT(data["images"]["frame"], ElementsAre(10, 12, 14, 16, 18));
  const std::string jpeg = FromBase64(data["images"]["jpeg"][0]);
  const cv::Mat image = cv::imdecode(std::vector<char>(jpeg.begin(), jpeg.end()), cv::IMREAD_COLOR);
  EXPECT_EQ(image.cols, 320);
  EXPECT_EQ(image.rows, 240);
  const ordered_json& observations = data["runs"][0]["observations"];
  EXPECT_NEAR(Unpack(observations["gain"])[0], 1.0, kQuantizedGain);  // a point's first patch beside itself
  EXPECT_FALSE(observations["error_mm"].is_null());
  EXPECT_FALSE(data["runs"][0]["frames"]["scale"].is_null());
}

TEST_F(ReportTest, LeavesImagesOutUntilTheyFit) {
  sequence_ = folder_.Path("sequence");
  WriteSmallSequence(sequence_, Truth::kNone);
  ReportOptions options;
  options.image_width_px = 640;
  options.image_quality = 100;
  options.max_image_mb = 0.3;
  const auto summary = Write(options);
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_LT(summary->images, static_cast<std::size_t>(kRunFrames));
  EXPECT_GT(summary->images, 0U);
  EXPECT_THAT(summary->notes, Contains(HasSubstr("--Report.max_image_mb")));
  EXPECT_EQ(Data()["images"]["frame"][0], 10);
}

TEST_F(ReportTest, ANameCannotEndTheElementOfTheData) {
  std::filesystem::rename(folder_.Path("run"), folder_.Path("a<!--<script>"));
  const auto summary =
      WriteReportPage({.run_paths = {folder_.Path("a<!--<script>")}, .sequence_path = "", .camera_path = ""}, {},
                      folder_.Path("report.html"));
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  const std::string page = folder_.Read("report.html");
  EXPECT_EQ(page.find("a<!--<script>"), std::string::npos);
  EXPECT_EQ(Data()["runs"][0]["name"], "a<!--<script>");
}

TEST_F(ReportTest, WhatCannotBeWrittenIsAnError) {
  const auto summary = WriteReportPage({.run_paths = {folder_.Path("run")}, .sequence_path = "", .camera_path = ""}, {},
                                       folder_.Path("nowhere/report.html"));
  EXPECT_EQ(summary.status().code(), ErrorCode::kUnwritable);
}

}  // namespace
}  // namespace pliant
