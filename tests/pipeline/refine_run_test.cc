// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/pipeline/refine_run.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <set>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "pliant/io/run_map.h"
#include "pliant/io/run_reader.h"
#include "support/small_files.h"
#include "support/small_run.h"
#include "support/test_folder.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using testing::HasSubstr;

// The run's points move together by 0.25 mm a frame, which is a motion of the camera: a rigid scene fits exactly.
constexpr double kExactFit_px = 1e-3;

class RefineRunTest : public testing::Test {
 protected:
  Result<RefineSummary> Refine(const std::string& output = "refined", const RefineOptions& options = {}) const {
    RefineRequest request;
    request.run_path = folder_.Path("run");
    request.output_path = folder_.Path(output);
    request.command_line = {"pliant", "refine"};
    return RefineRun(request, options, {});
  }

  TestFolder folder_;
};

TEST_F(RefineRunTest, LeavesARunOfTheSameFramesAndPoints) {
  WriteRun(folder_);
  const auto summary = Refine();
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  ASSERT_EQ(summary->submaps.size(), 1U);
  EXPECT_FALSE(summary->submaps.front().deforming);
  const auto run = ReadRun(folder_.Path("run"));
  const auto refined = ReadRun(folder_.Path("refined"));
  ASSERT_TRUE(run.ok() && refined.ok());
  ASSERT_EQ(refined->frames.size(), run->frames.size());
  for (std::size_t k = 0; k < run->frames.size(); ++k) {
    EXPECT_EQ(refined->frames[k].frame_idx, run->frames[k].frame_idx);
    EXPECT_EQ(refined->frames[k].state, run->frames[k].state);
    EXPECT_EQ(refined->frames[k].timestamp_s, run->frames[k].timestamp_s);
    EXPECT_LT(refined->frames[k].median_reprojection_error_px, kExactFit_px);
  }
  EXPECT_EQ(refined->summary->status, RunStatus::kCompleted);
  EXPECT_EQ(refined->summary->points, kRunPoints);
  const auto map = ReadRunMap(folder_.Path("refined"), *refined);
  ASSERT_TRUE(map.ok()) << map.status().message();
  EXPECT_EQ(map->points.at(PointId{3}).rgb, (std::array<std::uint8_t, 3>{10, 20, 1}));
  EXPECT_EQ(map->names.at(12), "12.png");
}

TEST_F(RefineRunTest, SaysWhatTheSceneWasTakenFor) {
  WriteRun(folder_);
  ASSERT_TRUE(Refine().ok());
  const auto summary = ReadRunSummary(folder_.Path("refined/run.json"));
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  const auto& refinement = summary->description.refinement;
  ASSERT_TRUE(refinement.has_value());
  EXPECT_THAT(refinement->models, testing::ElementsAre(RefinedModel::kRigid));
  EXPECT_GT(refinement->depth_sigma, 0.0);
  EXPECT_FALSE(refinement->has_estimated_camera);
  EXPECT_THAT(folder_.Read("refined/run.json"), HasSubstr("\"camera\": \"The scene was taken for rigid"));
  EXPECT_THAT(folder_.Read("refined/sparse/points3D.txt"), HasSubstr("# Positions are those of a rigid scene"));
  EXPECT_THAT(folder_.Read("run/sparse/points3D.txt"), HasSubstr("the scene moved"));
}

TEST_F(RefineRunTest, CountsThePointsThatAreLeft) {
  WriteRun(folder_);
  std::string rows = folder_.Read("run/observations.csv");
  const std::size_t begin = rows.find("\n10,21,") + 1;
  const std::size_t end = rows.find('\n', begin) + 1;
  const std::string of_last = rows.substr(begin, end - begin);
  rows.insert(end, "10,24," + of_last.substr(6));  // a point that is seen once: too seldom
  folder_.Write("run/observations.csv", rows);
  const auto summary = Refine();
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->submaps.front().wrong_observations, 1);
  EXPECT_EQ(summary->submaps.front().points, kRunPoints);
  EXPECT_EQ(summary->run.points, kRunPoints);
}

TEST_F(RefineRunTest, RefusesACalibrationThatIsNotTheRuns) {
  WriteRun(folder_);
  const auto refine = [&](const std::string& camera) {
    RefineRequest request;
    request.run_path = folder_.Path("run");
    request.camera_path = camera;
    request.output_path = folder_.Path("refined");
    return RefineRun(request, {}, {}).status();
  };
  const std::string head = "model: PINHOLE\nwidth: 640\nheight: ";
  const std::string same = folder_.Write("same.yaml", head + "480\nparams: [500, 500, 319.5, 239.5]\n");
  const std::string longer = folder_.Write("longer.yaml", head + "480\nparams: [600, 600, 319.5, 239.5]\n");
  const std::string lower = folder_.Write("lower.yaml", head + "400\nparams: [500, 500, 319.5, 199.5]\n");
  for (const std::string& other : {longer, lower, std::string("fov:70")}) {
    const Status status = refine(other);
    EXPECT_EQ(status.code(), ErrorCode::kMismatch) << other;
    EXPECT_THAT(status.message(), HasSubstr("the run was tracked with PINHOLE of 640x480 (500 500 319.5 239.5), and "));
    EXPECT_THAT(status.message(), HasSubstr("'" + other + "' is "));
  }
  EXPECT_THAT(refine(longer).message(), HasSubstr("PINHOLE of 640x480 (600 600 319.5 239.5)"));
  EXPECT_EQ(refine(folder_.Path("none.yaml")).code(), ErrorCode::kNotFound);
  EXPECT_FALSE(std::filesystem::exists(folder_.Path("refined")));
  EXPECT_TRUE(refine(same).ok());
  EXPECT_EQ(ReadRunSummary(folder_.Path("refined/run.json"))->description.camera, "") << "as the run says";
}

TEST_F(RefineRunTest, NamesTheCalibrationThatARunWithoutOneWasRefinedWith) {
  WriteRun(folder_);
  std::filesystem::remove_all(folder_.Path("run/sparse"));
  std::filesystem::create_directories(folder_.Path("images"));
  const cv::Mat image(480, 640, CV_8UC1, cv::Scalar(99));
  for (int k = 0; k < 10 + 2 * kRunFrames; ++k)  // up to the run's last
    ASSERT_TRUE(cv::imwrite(folder_.Path("images/" + std::to_string(k) + ".png"), image));
  RefineRequest request;
  request.run_path = folder_.Path("run");
  request.sequence_path = folder_.Path("images");
  request.camera_path =
      folder_.Write("lens.yaml", "model: PINHOLE\nwidth: 640\nheight: 480\nparams: [500, 500, 319.5, 239.5]\n");
  request.output_path = folder_.Path("refined");
  const auto summary = RefineRun(request, {}, {});
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(ReadRunSummary(folder_.Path("refined/run.json"))->description.camera, request.camera_path);
}

// Of an earlier version's run nothing is made up.
TEST_F(RefineRunTest, KeepsTheUnitThatTheRunStates) {
  WriteRun(folder_);
  ASSERT_TRUE(Refine().ok());
  EXPECT_EQ(ReadRunSummary(folder_.Path("refined/run.json"))->description.metric, std::nullopt);
  std::string summary = folder_.Read("run/run.json");
  const std::string unknown = "\"metric\": null";
  ASSERT_THAT(summary, HasSubstr(unknown));
  folder_.Write("run/run.json", summary.replace(summary.find(unknown), unknown.size(), "\"metric\": true"));
  ASSERT_TRUE(Refine("again").ok());
  EXPECT_EQ(ReadRunSummary(folder_.Path("again/run.json"))->description.metric, true);
}

TEST_F(RefineRunTest, RefinesEverySubmapByItself) {
  WriteRunOfTwoSubmaps(folder_);
  const auto summary = Refine();
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  ASSERT_EQ(summary->submaps.size(), 2U);
  EXPECT_EQ(summary->submaps[1].submap, 1);
  EXPECT_EQ(summary->submaps[1].frames, kRunFrames);
  EXPECT_EQ(summary->run.submaps, 2);
}

TEST_F(RefineRunTest, ASubmapThatCannotBeRefinedStaysAsItIs) {
  WriteRunOfTwoSubmaps(folder_);
  std::istringstream rows(folder_.Read("run/observations.csv"));
  std::string kept;
  for (std::string row; std::getline(rows, row);)  // of the second submap five points are left, three too few
    if (const auto id = row.substr(row.find(',') + 1); !(std::atoi(id.c_str()) >= 115)) kept += row + "\n";
  folder_.Write("run/observations.csv", kept);
  const auto summary = Refine();
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  ASSERT_EQ(summary->submaps.size(), 2U);
  EXPECT_EQ(summary->submaps[0].failure, "");
  EXPECT_THAT(summary->submaps[1].failure, HasSubstr("points"));
  const auto rows_of_second = [&](const std::string& text) { return text.substr(text.find("\n20,100,")); };
  EXPECT_EQ(rows_of_second(folder_.Read("refined/observations.csv")), rows_of_second(kept));
}

TEST_F(RefineRunTest, SaysHowCertainPointsAndPosesAre) {
  WriteRun(folder_);
  ASSERT_TRUE(Refine().ok());
  auto reader = ObservationReader::Open(folder_.Path("refined"));
  ASSERT_TRUE(reader.ok()) << reader.status().message();
  for (auto frame = reader->Next(); frame.ok() && frame->has_value(); frame = reader->Next())
    for (const PointObservation& observation : (*frame)->observations) EXPECT_GT(observation.sigma, 0);
  std::istringstream rows(folder_.Read("refined/pose_covariance.csv"));
  std::string header;
  std::getline(rows, header);
  EXPECT_EQ(header.substr(0, 14), "frame,x_x,x_y,");
  EXPECT_EQ(std::ranges::count(header, ','), 21);
  int poses = 0;
  for (std::string row; std::getline(rows, row); ++poses) {
    EXPECT_EQ(std::ranges::count(row, ','), 21);
    const double variance = std::stod(row.substr(row.find(',') + 1));
    EXPECT_EQ(variance > 0, poses > 0) << "the first pose is the world";
  }
  EXPECT_EQ(poses, kRunFrames);
}

TEST_F(RefineRunTest, DoesNotOverwriteTheRun) {
  WriteRun(folder_);
  const std::string before = folder_.Read("run/observations.csv");
  std::filesystem::create_directory_symlink("run", folder_.Path("link"));
  for (const char* const output : {"run", "run/", "run/../run", "link", "run/refined", "link/new/refined"}) {
    const auto summary = Refine(output);
    ASSERT_EQ(summary.status().code(), ErrorCode::kInvalidArgument) << output;
    EXPECT_THAT(summary.status().message(), HasSubstr("give another --output_path"));
  }
  EXPECT_EQ(folder_.Read("run/observations.csv"), before);
  EXPECT_FALSE(std::filesystem::exists(folder_.Path("run/refined")));
  EXPECT_TRUE(Refine("run_2").ok()) << "a name that only begins like the run's";
}

TEST_F(RefineRunTest, SaysWhatARunThatWasKilledLacks) {
  WriteRun(folder_, End::kKilled);
  const auto summary = Refine();
  ASSERT_FALSE(summary.ok());
  EXPECT_THAT(summary.status().message(), HasSubstr("sparse/"));
  EXPECT_FALSE(std::filesystem::exists(folder_.Path("refined")));
}

TEST_F(RefineRunTest, WhatFailsLeavesTheOutputAsItWas) {
  WriteRun(folder_);
  ASSERT_TRUE(Refine().ok());
  const std::string before = folder_.Read("refined/observations.csv");
  const std::string rows = folder_.Read("run/observations.csv");
  folder_.Write("run/observations.csv", rows.substr(0, rows.find('\n') + 1));  // a run without points
  const auto summary = Refine();
  ASSERT_FALSE(summary.ok());
  EXPECT_THAT(summary.status().message(), HasSubstr("points"));
  EXPECT_EQ(folder_.Read("refined/observations.csv"), before);
}

TEST_F(RefineRunTest, OnAFullDiskAppearsWholeOrNotAtAll) {
  WriteRun(folder_);
  ASSERT_TRUE(Refine("whole").ok());
  const auto size = std::filesystem::file_size(folder_.Path("whole/observations.csv"));
  const auto names = [&] {
    std::set<std::string> found;
    if (!std::filesystem::exists(folder_.Path("refined"))) return found;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.Path("refined")))
      found.insert(entry.path().string());
    return found;
  };
  const auto fail = [&] {
    for (const auto bytes : {size / 4, size / 2, size - 1}) {
      const SmallFiles full_disk(bytes);
      EXPECT_EQ(Refine().status().code(), ErrorCode::kUnwritable) << bytes;
    }
  };
  fail();
  EXPECT_TRUE(names().empty());
  ASSERT_TRUE(Refine().ok()) << "what failed before is in nobody's way";
  const std::set<std::string> whole = names();
  const std::string rows = folder_.Read("refined/observations.csv");
  const std::string frames = folder_.Read("refined/frames.csv") + "\n";  // tells it from a new one
  folder_.Write("refined/frames.csv", frames);
  fail();
  EXPECT_EQ(names(), whole);
  EXPECT_EQ(folder_.Read("refined/observations.csv"), rows);
  EXPECT_EQ(folder_.Read("refined/frames.csv"), frames);
  ASSERT_TRUE(Refine().ok());
  EXPECT_EQ(names(), whole);
  EXPECT_NE(folder_.Read("refined/frames.csv"), frames);
}

// What a killed program leaves.
TEST_F(RefineRunTest, AnUnfinishedOneIsInNobodysWay) {
  WriteRun(folder_);
  std::filesystem::create_directories(folder_.Path("refined/.unfinished"));
  folder_.Write("refined/.unfinished/run.json", "half");
  ASSERT_TRUE(Refine().ok());
  EXPECT_FALSE(std::filesystem::exists(folder_.Path("refined/.unfinished")));
  EXPECT_TRUE(ReadRun(folder_.Path("refined")).ok());
}

TEST_F(RefineRunTest, AnOutputFolderWithOtherFilesIsRefused) {
  WriteRun(folder_);
  std::filesystem::create_directories(folder_.Path("mine"));
  folder_.Write("mine/notes.txt", "keep");
  EXPECT_FALSE(Refine("mine").ok());
  EXPECT_EQ(folder_.Read("mine/notes.txt"), "keep");
}

TEST_F(RefineRunTest, AStopBeforeAllFramesWereSolvedForLeavesNothing) {
  WriteRun(folder_);
  const std::atomic<bool> stop = true;
  RefineRequest request;
  request.run_path = folder_.Path("run");
  request.output_path = folder_.Path("refined");
  request.stop = &stop;
  for (const RefinementModel model : {RefinementModel::kAuto, RefinementModel::kRigid}) {
    const auto early = RefineRun(request, {.model = model}, {});
    EXPECT_EQ(early.status().code(), ErrorCode::kInterrupted);
    EXPECT_FALSE(std::filesystem::exists(request.output_path));
  }
}

// A focal length that was estimated is that of a refined run alone.
TEST_F(RefineRunTest, TheCalibrationOfAFormerOneGoesWithIt) {
  WriteRun(folder_);
  ASSERT_TRUE(Refine().ok());
  folder_.Write("refined/camera.yaml", "of its user");
  ASSERT_TRUE(Refine().ok());
  EXPECT_EQ(folder_.Read("refined/camera.yaml"), "of its user");
  std::string summary = folder_.Read("refined/run.json");
  const std::string camera = "\"camera\": \"";
  const std::size_t begin = summary.find(camera) + camera.size();
  summary.replace(begin, summary.find('"', begin) - begin, folder_.Path("refined/camera.yaml"));
  folder_.Write("refined/run.json", summary);
  ASSERT_TRUE(Refine().ok());
  EXPECT_FALSE(std::filesystem::exists(folder_.Path("refined/camera.yaml")));
}

}  // namespace
}  // namespace pliant
