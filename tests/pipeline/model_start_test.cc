// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Runs that start from a COLMAP model: here the one that a start from true depth leaves, of a rigid scene.
#include <algorithm>
#include <filesystem>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/colmap/model.h"
#include "pliant/evaluation/evaluation.h"
#include "pliant/pipeline/track.h"
#include "pliant/simulation/write_sequence.h"
#include "simulation/small_scene.h"
#include "support/test_folder.h"

namespace pliant {
namespace {

using testing::HasSubstr;

constexpr double kFileModel_mm = 0.05;  // what the steps of the model's numbers add to the error
constexpr double kMedianOfOthers_mm =
    1.0;  // the scale is that of the points seen in the first image, the median of all
constexpr int kModelFrames = 12;

class ModelStartTest : public testing::Test {
 protected:
  void SetUp() override {
    SimulationOptions scene = simulation_test::SmallScene(TrajectoryKind::kSway, kModelFrames);
    scene.camera.width = 320;
    scene.camera.height = 240;
    scene.trajectory.sway_period_s = 2.0;
    const Status written = WriteSequence(scene, folder_.Path("sequence"));
    ASSERT_TRUE(written.ok()) << written.message();
    const auto summary = Track(InitMethod::kDepth, "true", {});
    ASSERT_TRUE(summary.ok()) << summary.status().message();
  }

  Result<RunSummary> Track(InitMethod method, const std::string& output, const ModelInitOptions& model) const {
    RunRequest request;
    request.input.image_path = folder_.Path("sequence");
    request.output_path = folder_.Path(output);
    TrackOptions options;
    options.tracker.init.method = method;
    options.tracker.init.model = model;
    return RunTrack(request, options, {});
  }
  ModelInitOptions Model() const { return {folder_.Path("true/sparse"), 1.0, 40}; }

  // Without a scale: as it is, in mm.
  double RmseMm(const std::string& run_path) const {
    SequenceRequest request;
    request.image_path = folder_.Path("sequence");
    const auto sequence = OpenSequence(request);
    EvaluationOptions options;
    options.parts = {EvaluationPart::kSurface};
    options.points.scale = ErrorScale::kNone;
    const auto input = ReadEvaluationInput(folder_.Path(run_path), **sequence, options.matching);
    const auto evaluation = Evaluate(*input, **sequence, Status(ErrorCode::kNotFound, "not asked for"), options);
    EXPECT_TRUE(evaluation.ok()) << evaluation.status().message();
    return evaluation.ok() ? evaluation->surface->plain.estimate.mean_rmse_mm : 1e9;
  }

  TestFolder folder_;
};

TEST_F(ModelStartTest, ItsPointsAreTrackedAsThoseOfTrueDepth) {
  const auto summary = Track(InitMethod::kColmapModel, "run", Model());
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->status, RunStatus::kCompleted) << summary->note;
  EXPECT_EQ(summary->frames_tracked, kModelFrames);
  EXPECT_EQ(summary->first_maps.front().declared_frame_idx, 0);
  EXPECT_LT(RmseMm("run"), RmseMm("true") + kFileModel_mm);
}

// As of a rig of two cameras.
TEST_F(ModelStartTest, ImagesOfAnotherFolderWithTheSameNamesAreOthers) {
  auto model = colmap::ReadModel(folder_.Path("true/sparse"));
  ASSERT_TRUE(model.ok()) << model.status().message();
  std::vector<colmap::Image> images;
  for (const colmap::Image& image : model->images) {
    colmap::Image of_other = image;
    of_other.id += 1000;
    of_other.name = "another/" + image.name;
    of_other.points2D.clear();
    images.push_back(of_other);
  }
  images.insert(images.end(), model->images.begin(), model->images.end());
  model->images = images;
  const Status written = colmap::WriteModel(folder_.Path("two"), *model, colmap::Format::kBinary);
  ASSERT_TRUE(written.ok()) << written.message();
  ModelInitOptions two = Model();
  two.path = folder_.Path("two");
  const auto summary = Track(InitMethod::kColmapModel, "run", two);
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->frames_tracked, kModelFrames) << summary->note;
}

TEST_F(ModelStartTest, AModelOfUnknownUnitIsScaledToTheNominalDepth) {
  ModelInitOptions model = Model();
  model.unit_mm = 0;
  ASSERT_TRUE(Track(InitMethod::kColmapModel, "run", model).ok());
  // Other than that of true depth, the run says that its unit is none.
  EXPECT_EQ(ReadRunSummary(folder_.Path("true/run.json"))->description.metric, true);
  EXPECT_EQ(ReadRunSummary(folder_.Path("run/run.json"))->description.metric, false);
  const auto map = colmap::ReadModel(folder_.Path("run/sparse"));
  ASSERT_TRUE(map.ok());
  std::vector<double> depths;
  for (const colmap::Point3D& point : map->points3D) depths.push_back(point.xyz[2]);
  std::nth_element(depths.begin(), depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2), depths.end());
  EXPECT_NEAR(depths[depths.size() / 2], MonocularInitOptions().nominal_depth_mm, kMedianOfOthers_mm);
}

TEST_F(ModelStartTest, AModelThatIsTooSmallForTheFilesIsNoMap) {
  ModelInitOptions model = Model();
  model.unit_mm = 1e-9;
  const auto summary = Track(InitMethod::kColmapModel, "run", model);
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->status, RunStatus::kFailed);
  EXPECT_EQ(summary->frames_tracked, 0);
  EXPECT_THAT(summary->note, testing::HasSubstr("check the unit (Init.model_unit_mm"));
}

TEST_F(ModelStartTest, WaitsForAnImageThatTheModelHas) {
  auto model = colmap::ReadModel(folder_.Path("true/sparse"));
  ASSERT_TRUE(model.ok());
  for (int frame = 0; frame < 3; ++frame)
    model->images[static_cast<std::size_t>(frame)].name = "elsewhere" + std::to_string(frame);
  ASSERT_TRUE(colmap::WriteModel(folder_.Path("late"), *model, colmap::Format::kBinary).ok());
  ModelInitOptions late = Model();
  late.path = folder_.Path("late");
  const auto summary = Track(InitMethod::kColmapModel, "run", late);
  ASSERT_TRUE(summary.ok());
  EXPECT_EQ(summary->first_maps.front().reference_frame_idx, 3);
  EXPECT_EQ(summary->frames_tracked, kModelFrames) << "those before it are tracked back from it";
}

TEST_F(ModelStartTest, WhatIsNoModelOfThisSequenceIsRefusedInOneSentence) {
  const auto refused = [&](const std::string& path, ErrorCode code, const char* what) {
    ModelInitOptions model = Model();
    model.path = path;
    const Status status = Track(InitMethod::kColmapModel, "run", model).status();
    EXPECT_EQ(status.code(), code);
    EXPECT_THAT(status.message(), HasSubstr(what));
    EXPECT_FALSE(std::filesystem::exists(folder_.Path("run")));
  };
  refused("", ErrorCode::kInvalidArgument, "--Init.model_path");
  refused(folder_.Path("nowhere"), ErrorCode::kNotFound, "nowhere");
  auto model = colmap::ReadModel(folder_.Path("true/sparse"));
  ASSERT_TRUE(model.ok());
  model->cameras[0].width = 640;
  ASSERT_TRUE(colmap::WriteModel(folder_.Path("wide"), *model, colmap::Format::kBinary).ok());
  refused(folder_.Path("wide"), ErrorCode::kMismatch, "640x240");
  model->points3D.pop_back();
  ASSERT_TRUE(colmap::WriteModel(folder_.Path("dangling"), *model, colmap::Format::kBinary).ok());
  refused(folder_.Path("dangling"), ErrorCode::kUnreadable, "is damaged");
}

}  // namespace
}  // namespace pliant
