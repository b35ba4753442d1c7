// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/viewer/view.h"

#include <array>
#include <cmath>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/io/gltf.h"
#include "support/tolerances.h"
#include "viewer/small_sequence.h"

namespace pliant {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kScaleOfAPlane = 0.05;  // of 2; the plane is not quite twice as far as the run's points are
constexpr double kPath_mm = 0.05;        // of a path of some mm, at a scale that is not quite the path's
constexpr double kPath_rad = 1e-3;
constexpr double kDepthOfPlane = 0.05;     // relative; the camera turns and moves a little before the plane
constexpr double kFloatPixel_px = 1e-2;    // positions are floats in a world that is 500 px for one unit of depth
constexpr double kFloatError_mm = 1e-4;    // the same sum from floats
constexpr double kVertexError_mm = 1e-2;   // depth images have steps, and meshes in files floats
constexpr double kSigma_mm = 0.5;          // of every point of a run in another world
constexpr double kAligned_mm = 1e-3;       // two paths from files, aligned with each other
constexpr double kAlignedPoint_mm = 1e-2;  // the same at the arm of the points

class ViewTest : public testing::Test {
 protected:
  Result<View> Open(const ViewOptions& options = {}) {
    return OpenView({.run_paths = {folder_.Path("run")}, .sequence_path = sequence_, .camera_path = ""}, options);
  }

  TestFolder folder_;
  std::string sequence_;
};

TEST_F(ViewTest, ARunWithoutImagesIsShownAllTheSame) {
  WriteRun(folder_);
  const auto view = Open();
  ASSERT_TRUE(view.ok()) << view.status().message();
  EXPECT_THAT(view->notes, ElementsAre(HasSubstr("the images cannot be shown: ")));
  EXPECT_FALSE(view->sequence);
  EXPECT_FALSE(view->in_millimeters);
  ASSERT_TRUE(view->camera);
  ASSERT_EQ(view->runs.size(), 1U);
  const ViewedRun& run = view->runs.front();
  EXPECT_EQ(run.name, "run");
  EXPECT_EQ(run.status, "completed");
  ASSERT_EQ(run.frames.size(), static_cast<std::size_t>(kRunFrames));
  EXPECT_EQ(run.points.size(), static_cast<std::size_t>(kRunPoints));
  EXPECT_LT((run.points.at(PointId{3}).position - Undeformed(1)).norm(), kFileLength_mm);
  const ViewedObservation& seen = run.frames[2].observations[1];
  EXPECT_EQ(seen.id, PointId{3});
  EXPECT_LT((seen.position.cast<double>() - PositionAt(1, 2)).norm(), kFloatRoundOff_mm);
  EXPECT_NEAR(seen.depth, (PoseAt(2) * PositionAt(1, 2)).z(), 10 * kFloatRoundOff_mm);
  EXPECT_LT(seen.reprojection_px, kExactReprojection_px);
  EXPECT_TRUE(std::isnan(seen.error_mm));
  EXPECT_THAT(run.errors, IsEmpty());
}

TEST_F(ViewTest, BringsTheRunIntoTheWorldOfTheTruth) {
  WriteRun(folder_);
  sequence_ = folder_.Path("sequence");
  WriteSmallSequence(sequence_, Truth::kDepthAndPoses);
  const auto view = Open();
  ASSERT_TRUE(view.ok()) << view.status().message();
  EXPECT_TRUE(view->in_millimeters);
  ASSERT_EQ(view->truth.size(), static_cast<std::size_t>(kRunFrames));
  const ViewedRun& run = view->runs.front();
  // The plane is about twice as far as the run's points are in its unit, so its scale is not quite the path's.
  ASSERT_EQ(run.scales.size(), static_cast<std::size_t>(kRunFrames));
  const double scale = *run.scales[2];
  EXPECT_NEAR(scale, kTruthFromRun.scale, kScaleOfAPlane);
  for (int i = 0; i < kRunFrames; ++i) {
    const Rigid3& truth = view->truth[static_cast<std::size_t>(i)].world_from_cam;
    const Rigid3& estimate = *run.frames[static_cast<std::size_t>(i)].world_from_cam;
    EXPECT_LT((truth.translation - estimate.translation).norm(), kPath_mm);
    EXPECT_LT(truth.rotation.angularDistance(estimate.rotation), kPath_rad);
  }
  // The error of each point is the evaluation's: their RMSE is the frame's.
  ASSERT_FALSE(run.errors.empty());
  EXPECT_EQ(run.errors.front().first, "surface RMSE, mm");
  for (int i = 0; i < kRunFrames; ++i) {
    const ViewedFrame& frame = run.frames[static_cast<std::size_t>(i)];
    double sum = 0;
    for (const ViewedObservation& o : frame.observations) {
      ASSERT_TRUE(std::isfinite(o.error_mm));
      sum += o.error_mm * o.error_mm;
      // The true point is on the plane, seen at the point's own pixel.
      const Eigen::Vector3d truth_in_cam = frame.world_from_cam->Inverse() * o.truth.cast<double>();
      EXPECT_NEAR(truth_in_cam.z(), kPlaneDepth_mm, kDepthOfPlane * kPlaneDepth_mm);
      EXPECT_LT((*view->camera->Project(truth_in_cam) - o.pixel.cast<double>()).norm(), kFloatPixel_px);
    }
    const auto& rmse_mm = run.errors.front().second[static_cast<std::size_t>(i)];
    EXPECT_NEAR(std::sqrt(sum / static_cast<double>(frame.observations.size())), *rmse_mm, kFloatError_mm);
  }
  EXPECT_THAT(run.figures, Contains(testing::Field(&NamedText::group, HasSubstr("Surface error"))));
}

// The run of WriteRun in another world and unit.
void WriteRunInWorld(const Sim3& world, const std::string& path, const RunDescription& description = {}) {
  auto writer = RunWriter::Create(path, TestCamera(), description, "Track:\n  option: 3\n", {});
  ASSERT_TRUE(writer.ok()) << writer.status().message();
  for (int i = 0; i < kRunFrames; ++i) {
    FrameReport report = Report(i);
    report.cam_from_world = PoseInWorld(world, *report.cam_from_world);
    for (PointObservation& o : report.observations) {
      o.position = world * o.position;
      o.sigma = world.scale * kSigma_mm;
    }
    for (NewPoint& point : report.new_points) point.position = world * point.position;
    ASSERT_TRUE(writer->Write(report).ok());
  }
  ASSERT_TRUE(writer->Finish(RunStatus::kCompleted, "").ok());
}

TEST_F(ViewTest, ShowsRunsOfOneSceneInOneWorld) {
  WriteRunInWorld({}, folder_.Path("run"));
  WriteRunInWorld({0.3, kTruthFromRun.rotation, {1, 1, 1}}, folder_.Path("b/run"));
  const auto view =
      OpenView({.run_paths = {folder_.Path("run"), folder_.Path("b/run")}, .sequence_path = "", .camera_path = ""}, {});
  ASSERT_TRUE(view.ok()) << view.status().message();
  EXPECT_EQ(view->runs[0].name, folder_.Path("run"));  // of the two paths one is in the other
  EXPECT_EQ(view->runs[1].name, "b");
  EXPECT_EQ(view->runs[1].options.size(), 1U);
  for (int i = 0; i < kRunFrames; ++i) {
    const ViewedFrame& a = view->runs[0].frames[static_cast<std::size_t>(i)];
    const ViewedFrame& b = view->runs[1].frames[static_cast<std::size_t>(i)];
    EXPECT_LT((a.world_from_cam->translation - b.world_from_cam->translation).norm(), kAligned_mm);
    ASSERT_EQ(a.observations.size(), b.observations.size());
    for (std::size_t k = 0; k < a.observations.size(); ++k) {
      EXPECT_LT((a.observations[k].position - b.observations[k].position).norm(), kAlignedPoint_mm);
      EXPECT_NEAR(a.observations[k].depth, b.observations[k].depth, kAlignedPoint_mm);
      EXPECT_NEAR(a.observations[k].sigma, b.observations[k].sigma, kAlignedPoint_mm);
      EXPECT_NEAR(a.observations[k].sigma, kSigma_mm, kAlignedPoint_mm);
    }
  }
}

// A start from known depth tells the scale.
TEST_F(ViewTest, ARunWithTrueMillimetersIsShownInMillimeters) {
  WriteRun(folder_);
  const auto in_millimeters = [&](const std::string& options) {
    folder_.Write("run/config.yaml", options);
    const auto view = Open();
    EXPECT_TRUE(view.ok()) << view.status().message();
    EXPECT_EQ(view->in_millimeters, view->runs.front().in_millimeters);
    return view->in_millimeters;
  };
  EXPECT_TRUE(in_millimeters("Init:\n  method: stereo\n"));
  EXPECT_TRUE(in_millimeters("Init:\n  method: depth\n"));
  EXPECT_TRUE(in_millimeters("Init:\n  method: colmap_model\n  model_unit_mm: 1000\n"));
  EXPECT_FALSE(in_millimeters("Init:\n  method: colmap_model\n  model_unit_mm: 0\n"));
  EXPECT_FALSE(in_millimeters("Init:\n  method: window\n"));
  EXPECT_FALSE(in_millimeters("Init:\n  method: of another version\n"));
}

TEST_F(ViewTest, ARefinedRunHasTheUnitOfTheRunItRefined) {
  WriteRun(folder_);
  folder_.Write("run/config.yaml", "Init:\n  method: stereo\n");
  RunDescription description;
  description.refined_from = folder_.Path("run");
  WriteRunInWorld({}, folder_.Path("refined"), description);
  description.refined_from = folder_.Path("refined");
  WriteRunInWorld({}, folder_.Path("again"), description);
  const auto view = OpenView({.run_paths = {folder_.Path("again")}, .sequence_path = "", .camera_path = ""}, {});
  ASSERT_TRUE(view.ok()) << view.status().message();
  EXPECT_TRUE(view->in_millimeters);
}

// Also where the run that was refined is not there any more, and against its options.
TEST_F(ViewTest, ARunThatSaysItsUnitHasIt) {
  const auto in_millimeters = [&] {
    const auto view = OpenView({.run_paths = {folder_.Path("refined")}, .sequence_path = "", .camera_path = ""}, {});
    EXPECT_TRUE(view.ok()) << view.status().message();
    return view->in_millimeters;
  };
  RunDescription description;
  description.refined_from = folder_.Path("gone");
  WriteRunInWorld({}, folder_.Path("refined"), description);
  EXPECT_FALSE(in_millimeters());
  description.metric = true;
  WriteRunInWorld({}, folder_.Path("refined"), description);
  EXPECT_TRUE(in_millimeters());
  description.metric = false;
  WriteRunInWorld({}, folder_.Path("refined"), description);
  folder_.Write("refined/config.yaml", "Init:\n  method: stereo\n");
  EXPECT_FALSE(in_millimeters());
}

TEST_F(ViewTest, TheRunThatTellsTheScaleScalesTheOthers) {
  constexpr double kScale = 0.3;
  WriteRunInWorld({kScale, kTruthFromRun.rotation, {1, 1, 1}}, folder_.Path("monocular"));
  WriteRun(folder_);
  folder_.Write("run/config.yaml", "Init:\n  method: depth\n");
  const auto view = OpenView(
      {.run_paths = {folder_.Path("monocular"), folder_.Path("run")}, .sequence_path = "", .camera_path = ""}, {});
  ASSERT_TRUE(view.ok()) << view.status().message();
  EXPECT_TRUE(view->in_millimeters);
  for (const ViewedRun& run : view->runs)
    EXPECT_NEAR(run.frames[2].observations[1].depth, (PoseAt(2) * PositionAt(1, 2)).z(), kAlignedPoint_mm) << run.name;
}

TEST_F(ViewTest, PutsSubmapsThatNothingConnectsOneAfterTheOther) {
  WriteRunOfTwoSubmaps(folder_);
  const auto view = Open();
  ASSERT_TRUE(view.ok()) << view.status().message();
  EXPECT_THAT(view->notes, Contains(HasSubstr("each begins where the one before it ended")));
  const ViewedRun& run = view->runs.front();
  const ViewedFrame& last = run.frames[kRunFrames - 1];
  const ViewedFrame& first = run.frames[kRunFrames];
  EXPECT_LT((last.world_from_cam->translation - first.world_from_cam->translation).norm(), kFileLength_mm);
}

// The truth ends before the second map begins.
TEST_F(ViewTest, AMapWithoutTruthKeepsItsSize) {
  WriteRunOfTwoSubmaps(folder_);
  sequence_ = folder_.Path("sequence");
  WriteSmallSequence(sequence_, Truth::kDepthAndPoses, 2 * kSequenceFrames);
  const std::string poses = folder_.Read("sequence/groundtruth.txt");
  std::size_t end = 0;
  for (int line = 0; line < kSequenceFrames; ++line) end = poses.find('\n', end) + 1;
  folder_.Write("sequence/groundtruth.txt", poses.substr(0, end));
  std::filesystem::remove_all(folder_.Path("sequence/depth"));
  const auto view = Open();
  ASSERT_TRUE(view.ok()) << view.status().message();
  const std::vector<ViewedFrame>& frames = view->runs.front().frames;
  ASSERT_EQ(frames.size(), 2U * kRunFrames);
  EXPECT_NEAR(frames[kRunFrames].observations.front().depth, frames[kRunFrames - 1].observations.front().depth,
              0.05 * frames[0].observations.front().depth);
}

TEST_F(ViewTest, ARunOfAnotherSceneIsSaidToBeApart) {
  WriteRun(folder_);
  {
    auto writer =
        RunWriter::Create(folder_.Path("late"), TestCamera(), {"0.1.0", {"pliant"}, 7, "nowhere", {}}, "Track:\n", {});
    ASSERT_TRUE(writer.ok()) << writer.status().message();
    for (int i = 0; i < kRunFrames; ++i) {
      FrameReport report = Report(i);
      report.frame_idx += 100;
      ASSERT_TRUE(writer->Write(report).ok());
    }
    ASSERT_TRUE(writer->Finish(RunStatus::kCompleted, "").ok());
  }
  const auto view =
      OpenView({.run_paths = {folder_.Path("run"), folder_.Path("late")}, .sequence_path = "", .camera_path = ""}, {});
  ASSERT_TRUE(view.ok()) << view.status().message();
  EXPECT_THAT(view->notes, Contains(HasSubstr("late has no frame in common with the first one")));
}

TEST_F(ViewTest, ShowsWhatAKilledRunLeft) {
  WriteRun(folder_, End::kKilled);
  const auto view = Open();
  ASSERT_TRUE(view.ok()) << view.status().message();
  EXPECT_EQ(view->runs.front().frames.size(), static_cast<std::size_t>(kRunFrames));
  EXPECT_EQ(view->runs.front().points.size(), static_cast<std::size_t>(kRunPoints));
  EXPECT_THAT(view->notes, Contains(HasSubstr("has no sparse/")));
}

TEST_F(ViewTest, ThinsTooManyPointsAndSaysSo) {
  WriteRun(folder_);
  const auto view = Open({.max_observations = kRunObservations / 2});
  ASSERT_TRUE(view.ok()) << view.status().message();
  EXPECT_THAT(view->notes, Contains(HasSubstr("those of one point in 3")));
  EXPECT_EQ(view->runs.front().points.size(), 3U);  // every second one would be one with the longer tracks
  std::size_t observations = 0;
  for (const ViewedFrame& frame : view->runs.front().frames) observations += frame.observations.size();
  EXPECT_GT(observations, 0U);
  EXPECT_LE(observations, static_cast<std::size_t>(kRunObservations / 2));
}

TEST_F(ViewTest, AnotherSequenceIsAnErrorWhereItWasNamed) {
  WriteRun(folder_);
  sequence_ = folder_.Path("sequence");
  const auto camera = Camera::Create("PINHOLE", 64, 48, std::vector<double>{50, 50, 31.5, 23.5});
  auto writer = NativeWriter::Create(sequence_, {.camera = *camera, .fps = 25});
  ASSERT_TRUE(writer.ok());
  for (int i = 0; i < kSequenceFrames; ++i)
    ASSERT_TRUE(writer->Write({.timestamp_s = i / 25.0, .image = cv::Mat::zeros(48, 64, CV_8UC1)}).ok());
  const auto view = Open();
  ASSERT_FALSE(view.ok());
  EXPECT_EQ(view.status().code(), ErrorCode::kMismatch);
}

TEST_F(ViewTest, ARunWithoutAFrameIsAnError) {
  ASSERT_TRUE(
      RunWriter::Create(folder_.Path("run"), TestCamera(), {"0.1.0", {"pliant"}, 7, "nowhere", {}}, "Track:\n", {})
          .ok());
  const auto view = Open();
  EXPECT_EQ(view.status().code(), ErrorCode::kInsufficient);
  EXPECT_THAT(view.status().message(), HasSubstr("no frame was read"));
}

TEST_F(ViewTest, WhatIsNoRunIsAnError) { EXPECT_EQ(Open().status().code(), ErrorCode::kNotFound); }

// A surface folder of the run, whose only triangle is displaced by (0, 0, 1) in frame 2.
void WriteSurface(const TestFolder& folder, const std::string& run_path) {
  std::filesystem::create_directories(folder.Path("surface"));
  folder.Write("surface/camera.yaml", "model: PINHOLE\nwidth: 640\nheight: 480\nparams: [500, 500, 319.5, 239.5]\n");
  folder.Write("surface/surface.json", "{\"status\": \"completed\", \"run\": \"" + run_path + "\", \"frames\": []}");
  Mesh mesh;
  mesh.vertices = {{0, 0, 20}, {0, 4, 20}, {4, 0, 20}};
  mesh.normals.assign(3, -Eigen::Vector3f::UnitZ());
  mesh.rgb.resize(3);
  mesh.sigmas = {0.5F, 0.5F, 1.0F};
  mesh.triangles = {{0, 1, 2}};
  const std::vector<MeshKey> keys = {{2, 0.1, {{0, 0, 21}, {0, 4, 21}, {4, 0, 21}}}};
  const Camera camera =
      Camera::Create(CameraModelId::kPinhole, 640, 480, std::array{500.0, 500.0, 319.5, 239.5}).value();
  ASSERT_TRUE(WriteGlb(folder.Path("surface/surface.glb"), {mesh, "", keys, {}, camera, 0}).ok());
}

TEST_F(ViewTest, TheSurfaceIsInTheSameWorldAsTheRun) {
  WriteRun(folder_);
  WriteSurface(folder_, folder_.Path("run"));
  sequence_ = folder_.Path("sequence");
  WriteSmallSequence(sequence_, Truth::kDepthAndPoses);
  const auto alone = Open();
  const auto view = OpenView({.run_paths = {folder_.Path("run")},
                              .sequence_path = sequence_,
                              .camera_path = "",
                              .surface_paths = {folder_.Path("surface")}},
                             {});
  ASSERT_TRUE(view.ok()) << view.status().message();
  ASSERT_EQ(view->runs[0].meshes.size(), 1U);
  const GltfMesh& mesh = view->runs[0].meshes[0].surface;
  const double scale = *view->runs[0].scales[2];
  EXPECT_NEAR((mesh.mesh.vertices[1] - mesh.mesh.vertices[0]).norm(), 4 * scale, 0.02 * scale);
  EXPECT_NEAR(mesh.mesh.sigmas[2], scale, 0.02 * scale);
  EXPECT_NEAR((mesh.keys[0].positions[0] - mesh.mesh.vertices[0]).norm(), scale, 0.02 * scale);
  // As far from the run's points as in its own world.
  const auto& point = view->runs[0].points.at(PointId{3}).position;
  EXPECT_NEAR((mesh.mesh.vertices[0].cast<double>() - point).norm(),
              scale * (Eigen::Vector3d(0, 0, 20) - Undeformed(1)).norm(), 0.05 * scale * Undeformed(1).norm());
}

// A triangle parallel to the true plane, before the camera of the third frame, and another one that it hides in part.
TEST_F(ViewTest, VerticesThatAFrameShowsHaveTheirError) {
  WriteRun(folder_);
  std::filesystem::create_directories(folder_.Path("surface"));
  folder_.Write("surface/camera.yaml", "model: PINHOLE\nwidth: 640\nheight: 480\nparams: [500, 500, 319.5, 239.5]\n");
  folder_.Write("surface/surface.json",
                "{\"status\": \"completed\", \"run\": \"" + folder_.Path("run") + "\", \"frames\": []}");
  Mesh mesh;
  for (const Eigen::Vector3d& in_cam :
       {Eigen::Vector3d(-4, -4, 40), Eigen::Vector3d(-4, 8, 40), Eigen::Vector3d(8, -4, 40),
        Eigen::Vector3d(-1, -1, 45), Eigen::Vector3d(-1, 20, 45), Eigen::Vector3d(60, -1, 45)})
    mesh.vertices.push_back((PoseAt(2).Inverse() * in_cam).cast<float>());
  mesh.normals.assign(6, -Eigen::Vector3f::UnitZ());
  mesh.rgb.resize(6);
  mesh.sigmas.assign(6, 0.1F);
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  const std::vector<MeshKey> keys = {{14, 0.1, mesh.vertices}};
  ASSERT_TRUE(WriteGlb(folder_.Path("surface/surface.glb"), {mesh, "", keys, {}, TestCamera(), 0}).ok());
  ViewRequest request{.run_paths = {folder_.Path("run")}, .sequence_path = "", .camera_path = ""};
  request.surface_paths = {folder_.Path("surface")};
  const auto without_truth = OpenView(request, {});
  ASSERT_TRUE(without_truth.ok()) << without_truth.status().message();
  EXPECT_THAT(without_truth->runs[0].meshes[0].errors_mm, IsEmpty());

  request.sequence_path = folder_.Path("sequence");
  WriteSmallSequence(request.sequence_path, Truth::kDepthAndPoses);
  const auto view = OpenView(request, {});
  ASSERT_TRUE(view.ok()) << view.status().message();
  const ViewedMesh& viewed = view->runs[0].meshes[0];
  ASSERT_EQ(viewed.errors_mm.size(), 1U);
  const double scale = *view->runs[0].scales[2];
  const auto error_mm = [&](double z, double x, double y) {
    return std::abs(scale * z - kPlaneDepth_mm) * Eigen::Vector3d(x / z, y / z, 1).norm();
  };
  EXPECT_NEAR(viewed.errors_mm[0][0], error_mm(40, -4, -4), kVertexError_mm);
  EXPECT_NEAR(viewed.errors_mm[0][2], error_mm(40, 8, -4), kVertexError_mm);
  EXPECT_TRUE(std::isnan(viewed.errors_mm[0][3]));  // hidden
  EXPECT_NEAR(viewed.errors_mm[0][4], error_mm(45, -1, 20), kVertexError_mm);
  EXPECT_TRUE(std::isnan(viewed.errors_mm[0][5]));  // out of the image
}

TEST_F(ViewTest, ASurfaceOfAnotherRunIsRefused) {
  WriteRun(folder_);
  std::filesystem::create_directories(folder_.Path("other"));
  WriteSurface(folder_, folder_.Path("other"));
  ViewRequest request{.run_paths = {folder_.Path("run")}, .sequence_path = "", .camera_path = ""};
  request.surface_paths = {folder_.Path("surface")};
  const auto other = OpenView(request, {});
  EXPECT_EQ(other.status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(other.status().message(), HasSubstr("was made of the run"));
  // One whose run has been moved belongs to the only run that is shown.
  std::filesystem::remove_all(folder_.Path("other"));
  EXPECT_TRUE(OpenView(request, {}).ok());
  std::filesystem::remove(folder_.Path("surface/surface.glb"));
  EXPECT_THAT(OpenView(request, {}).status().message(),
              AllOf(HasSubstr("has no surface.glb to show"), HasSubstr("--Surface.gltf true"),
                    HasSubstr("--Surface.mesh_columns")));
  request.surface_paths = {folder_.Path("nowhere")};
  EXPECT_EQ(OpenView(request, {}).status().code(), ErrorCode::kNotFound);
}

}  // namespace
}  // namespace pliant
