// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/pipeline/surface_run.h"

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "pipeline/mesh_writer.h"
#include "pipeline/surface_neighbors.h"
#include "pipeline/surface_notes.h"
#include "pliant/base/folder_lock.h"
#include "pliant/datasets/surface_folder.h"
#include "pliant/io/run_map.h"
#include "support/small_run.h"
#include "support/test_folder.h"

namespace pliant {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class SurfaceRunTest : public testing::Test {
 protected:
  Result<SurfaceSummary> Make(const std::string& sequence, std::vector<int> frames = {},
                              const std::string& camera = {}) const {
    SurfaceRequest request;
    request.run_path = folder_.Path("run");
    request.sequence_path = sequence;
    request.camera_path = camera;
    request.output_path = folder_.Path("surface");
    request.frames = std::move(frames);
    return MakeSurface(request, {}, {});
  }

  // Frame 20 was read, and has no pose.
  void WriteRunWithALostFrame() const {
    auto writer =
        RunWriter::Create(folder_.Path("run"), TestCamera(), {"0.1.0", {"pliant"}, 7, "nowhere", {}}, "Track:\n", {});
    ASSERT_TRUE(writer.ok()) << writer.status().message();
    for (int frame = 0; frame < kRunFrames; ++frame) ASSERT_TRUE(writer->Write(Report(frame)).ok());
    FrameReport lost;
    lost.frame_idx = 10 + 2 * kRunFrames;
    lost.name = FileName(lost.frame_idx);
    lost.timestamp_s = kRunFrames / 25.0;
    lost.state = TrackingState::kLost;
    ASSERT_TRUE(writer->Write(lost).ok());
    ASSERT_TRUE(writer->Finish(RunStatus::kCompleted, "").ok());
  }

  static std::string FileName(int frame) { return std::to_string(frame) + ".png"; }

  // Gray images of the run's frames and of those between, `count` of them.
  std::string WriteImages(int count) const {
    std::string images = folder_.Path("images");
    std::filesystem::create_directories(images);
    for (int k = 0; k < count; ++k) cv::imwrite(images + "/" + FileName(k), cv::Mat(480, 640, CV_8U, cv::Scalar(90)));
    folder_.Write("images/camera.yaml",
                  "model: PINHOLE\nwidth: 640\nheight: 480\nparams: [500, 500, 319.5, 239.5]\nfps: 25\n");
    return images;
  }

  TestFolder folder_;
};

TEST_F(SurfaceRunTest, SaysWhatIsMissing) {
  EXPECT_EQ(Make("").status().code(), ErrorCode::kNotFound);
  WriteRun(folder_);
  EXPECT_THAT(Make(folder_.Path("nowhere")).status().message(), HasSubstr("nowhere"));
}

TEST_F(SurfaceRunTest, SaysThatNoChosenFrameIsThereOrWasTracked) {
  WriteRunWithALostFrame();
  const std::string images = WriteImages(21);
  const auto absent = Make(images, {3, 70});
  EXPECT_EQ(absent.status().code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(absent.status().message(),
              HasSubstr("has none of the chosen frames (frames 3, 70); its frames are 10 to 20"));
  const auto lost = Make(images, {20, 70});
  EXPECT_EQ(lost.status().code(), ErrorCode::kInsufficient);
  EXPECT_THAT(lost.status().message(), HasSubstr("none of the chosen frames was tracked"));
}

TEST_F(SurfaceRunTest, NotesWhyAChosenFrameIsLeftOut) {
  WriteRunWithALostFrame();
  EXPECT_FALSE(Make(WriteImages(21), {10, 20, 70}).ok());  // gray images have no depth
  const std::string summary = folder_.Read("surface/surface.json");
  EXPECT_THAT(summary, HasSubstr("it was not tracked"));
  EXPECT_THAT(summary, HasSubstr("the run has no such frame"));
}

TEST_F(SurfaceRunTest, ImagesThatEndTooEarlyAreOthers) {
  WriteRun(folder_);
  const auto result = Make(WriteImages(13));
  EXPECT_EQ(result.status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(result.status().message(), HasSubstr("the images end before frame 14"));
  EXPECT_THAT(folder_.Read("surface/surface.json"), HasSubstr("\"status\": \"interrupted\""));
  EXPECT_TRUE(ReadSurfaceFolder(folder_.Path("surface")).ok());
}

TEST_F(SurfaceRunTest, ImagesOfOtherNamesAreOthers) {
  WriteRun(folder_);
  const std::string images = WriteImages(19);
  std::filesystem::rename(images + "/12.png", images + "/12b.png");
  const auto result = Make(images);
  EXPECT_EQ(result.status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(result.status().message(), HasSubstr("frame 12 of the run is image 12.png, and here it is 12b.png"));
}

TEST_F(SurfaceRunTest, RefusesImagesWithAnotherCalibration) {
  WriteRun(folder_);
  const std::string images = WriteImages(19);
  const std::string head = "model: PINHOLE\nwidth: 640\nheight: 480\nfps: 25\n";
  folder_.Write("images/camera.yaml", head + "params: [600, 600, 319.5, 239.5]\n");
  const auto other = Make(images);
  EXPECT_EQ(other.status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(other.status().message(),
              HasSubstr("the run was tracked with PINHOLE of 640x480 (500 500 319.5 239.5), and the calibration that"));
  EXPECT_THAT(other.status().message(), HasSubstr("is PINHOLE of 640x480 (600 600 319.5 239.5)"));
  EXPECT_FALSE(std::filesystem::exists(folder_.Path("surface")));

  const std::string of_run = folder_.Write("run.yaml", head + "params: [500, 500, 319.5, 239.5]\n");
  EXPECT_THAT(Make(images, {}, of_run).status().message(), HasSubstr("needs 12 points"));
}

// Where the images were not moved, their own calibration may be another one than was used.
TEST_F(SurfaceRunTest, AnUnusedCalibrationBesideTheRunsOwnImagesIsIgnored) {
  const std::string images = WriteImages(19);
  folder_.Write("images/camera.yaml",
                "model: PINHOLE\nwidth: 640\nheight: 480\nparams: [600, 600, 319.5, 239.5]\nfps: 25\n");
  for (const std::string used : {"elsewhere.yaml", ""}) {
    RunDescription description{"0.1.0", {"pliant"}, 7, images, used};
    description.metric = false;
    auto writer = RunWriter::Create(folder_.Path("run"), TestCamera(), description, "Track:\n", {});
    ASSERT_TRUE(writer.ok()) << writer.status().message();
    for (int frame = 0; frame < kRunFrames; ++frame) ASSERT_TRUE(writer->Write(Report(frame)).ok());
    ASSERT_TRUE(writer->Finish(RunStatus::kCompleted, "").ok());
    EXPECT_EQ(Make("").status().code(), used.empty() ? ErrorCode::kMismatch : ErrorCode::kInsufficient) << used;
  }
}

TEST_F(SurfaceRunTest, AFrameWithFewPointsHasNoDepthAndSaysWhy) {
  WriteRun(folder_);
  const auto result = Make(WriteImages(19));
  EXPECT_EQ(result.status().code(), ErrorCode::kInsufficient);
  EXPECT_THAT(result.status().message(), HasSubstr("needs 12 points"));
  EXPECT_THAT(folder_.Read("surface/surface.json"), HasSubstr("needs 12 points"));
}

TEST_F(SurfaceRunTest, LeavesAFolderAloneThatAnotherOneWritesInto) {
  WriteRun(folder_);
  std::filesystem::create_directories(folder_.Path("surface"));
  folder_.Write("surface/surface.json", "{}");
  const auto held = FolderLock::Take(folder_.Path("surface"));
  ASSERT_TRUE(held.ok());
  const auto result = Make(WriteImages(19));
  EXPECT_EQ(result.status().code(), ErrorCode::kUnwritable);
  EXPECT_EQ(folder_.Read("surface/surface.json"), "{}");
}

TEST(SurfaceFileNames, AreTheImagesUnlessTwoWouldBeCalledTheSame) {
  const std::map<int, std::string> images = {{3, "a.jpg"}, {4, "left/1.png"}, {5, "right/1.png"}, {6, "1.tif"}};
  const SurfaceFileNames names(images);
  EXPECT_EQ(names.Of(3), "a.png");
  EXPECT_EQ(names.Of(4), "1_000004.png");
  EXPECT_EQ(names.Of(5), "1_000005.png");
  EXPECT_EQ(names.Of(7), "000007.png");
}

TEST(SurfaceFileNames, AreNoneOfAnotherImageThatEndsInANumber) {
  const std::map<int, std::string> images = {{0, "a.jpg"}, {1, "a.png"}, {2, "a_000000.png"}};
  const SurfaceFileNames names(images);
  EXPECT_EQ(names.Of(0), "a_000000_000000.png");
  EXPECT_EQ(names.Of(1), "a_000001.png");
  EXPECT_EQ(names.Of(2), "a_000000.png");
}

TEST_F(SurfaceRunTest, SaysWhetherAMapUnitIsAMillimeter) {
  const std::string images = WriteImages(19);
  for (const auto& [metric, text] : {std::pair(true, "\"metric\": true"), std::pair(false, "\"metric\": false")}) {
    RunDescription description{"0.1.0", {"pliant"}, 7, "nowhere", {}};
    description.metric = metric;
    auto writer = RunWriter::Create(folder_.Path("run"), TestCamera(), description, "Track:\n", {});
    ASSERT_TRUE(writer.ok()) << writer.status().message();
    for (int frame = 0; frame < kRunFrames; ++frame) ASSERT_TRUE(writer->Write(Report(frame)).ok());
    ASSERT_TRUE(writer->Finish(RunStatus::kCompleted, "").ok());
    EXPECT_FALSE(Make(images).ok());  // gray images have no depth
    EXPECT_THAT(folder_.Read("surface/surface.json"), HasSubstr(text));
    EXPECT_THAT(folder_.Read("surface/camera.yaml"), HasSubstr(metric ? "# mm per step" : "# map units per step"));
    EXPECT_EQ(folder_.Read("surface/camera.yaml").find("unit: mm") != std::string::npos, metric);
  }
}

TEST_F(SurfaceRunTest, ImagesOfOneNameHaveFilesOfTheirOwnWhateverIsChosen) {
  const std::map<int, std::string> names = {{10, "a.jpg"}, {11, "a.n.png"}, {12, "a.png"}};
  auto writer =
      RunWriter::Create(folder_.Path("run"), TestCamera(), {"0.1.0", {"pliant"}, 7, "nowhere", {}}, "Track:\n", {});
  ASSERT_TRUE(writer.ok()) << writer.status().message();
  for (const int frame : {0, 1}) {
    FrameReport report = Report(frame);
    report.name = names.at(report.frame_idx);
    ASSERT_TRUE(writer->Write(report).ok());
  }
  ASSERT_TRUE(writer->Finish(RunStatus::kCompleted, "").ok());
  const std::string images = WriteImages(13);
  for (const auto& [frame_idx, name] : names)
    std::filesystem::rename(images + "/" + FileName(frame_idx), images + "/" + name);
  EXPECT_FALSE(Make(images, {12}).ok());  // gray images have no depth
  EXPECT_THAT(folder_.Read("surface/surface.json"), HasSubstr("\"name\": \"a_000012.png\""));
}

TEST_F(SurfaceRunTest, KnowsWhenTheRunIsReplaced) {
  WriteRun(folder_);
  EXPECT_FALSE(Make(WriteImages(19)).ok());  // gray images have no depth
  const auto surface = ReadSurfaceFolder(folder_.Path("surface"));
  ASSERT_TRUE(surface.ok()) << surface.status().message();
  EXPECT_TRUE(CheckSurfaceOfRun(*surface, folder_.Path("run")).ok());
  WriteRunWithALostFrame();  // the same poses
  EXPECT_TRUE(CheckSurfaceOfRun(*surface, folder_.Path("run")).ok());
  WriteRunOfTwoSubmaps(folder_);
  EXPECT_EQ(CheckSurfaceOfRun(*surface, folder_.Path("run")).code(), ErrorCode::kMismatch);
}

TEST_F(SurfaceRunTest, LeavesAFolderOfOtherThingsAlone) {
  WriteRun(folder_);
  std::filesystem::create_directories(folder_.Path("surface/depth"));
  folder_.Write("surface/depth/mine.png", "mine");
  const auto result = Make(WriteImages(19));
  EXPECT_EQ(result.status().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(folder_.Read("surface/depth/mine.png"), "mine");
}

TEST_F(SurfaceRunTest, SaysThatAMapIsProvisional) {
  auto writer =
      RunWriter::Create(folder_.Path("run"), TestCamera(), {"0.1.0", {"pliant"}, 7, "nowhere", {}}, "Track:\n", {});
  ASSERT_TRUE(writer.ok()) << writer.status().message();
  for (int frame = 0; frame < kRunFrames; ++frame) {
    FrameReport report = Report(frame);
    if (frame < 2) report.state = TrackingState::kProvisional;
    ASSERT_TRUE(writer->Write(report).ok());
  }
  ASSERT_TRUE(writer->Finish(RunStatus::kCompleted, "").ok());
  EXPECT_FALSE(Make(WriteImages(19)).ok());  // gray images have no depth
  const auto json = nlohmann::json::parse(folder_.Read("surface/surface.json"));
  std::vector<bool> provisional;
  for (const auto& frame : json.at("frames")) provisional.push_back(frame.at("provisional").get<bool>());
  EXPECT_THAT(provisional, ElementsAre(true, true, false, false, false));
}

TEST(SurfaceNotes, CountProvisionalFrames) {
  EXPECT_EQ(ProvisionalWarning({{.frame_idx = 1}}), "");
  EXPECT_THAT(ProvisionalWarning({{.frame_idx = 1}, {.frame_idx = 3, .provisional = true}}),
              testing::StartsWith("1 of 2 frames are of a provisional map"));
}

TEST(SurfaceNotes, SayThatThereIsNoMesh) {
  SurfaceRunOptions options;
  EXPECT_EQ(MeshWarning({.submaps = 2, .meshes = 2}, options), "");
  EXPECT_EQ(MeshWarning({.stopped = true, .submaps = 2, .meshes = 0}, options), "");
  EXPECT_THAT(MeshWarning({.submaps = 2, .meshes = 1}, options),
              testing::StartsWith("there is no mesh of 1 of 2 submaps: "));
  options.mesh_columns = 1;
  EXPECT_EQ(MeshWarning({.submaps = 1}, options),
            "there is no mesh: its depths give no connected piece of enough triangles; raise Surface.mesh_columns (1)");
  options.mesh_columns = 0;
  EXPECT_EQ(MeshWarning({}, options), "");
  options.obj = true;
  EXPECT_THAT(MeshWarning({}, options), HasSubstr("there is no obj/ without a mesh"));
}

TEST(SurfaceNotes, SayWhyMostPixelsHaveNoDepth) {
  RejectedPixels rejected = {};
  const auto reject = [&](DepthRejection why, int pixels) { rejected[static_cast<std::size_t>(why)] = pixels; };
  reject(DepthRejection::kNotSurface, 1000);
  EXPECT_THAT(NoteWithoutDepth(rejected, {}), HasSubstr("masks, highlights and the dark border leave no pixel"));
  reject(DepthRejection::kDisagreement, 30);
  EXPECT_EQ(NoteWithoutDepth(rejected, {}),
            "the two halves of the other images tell different depths (100 % of the usable pixels); refine the run, or "
            "raise Surface.max_disagreement");
  reject(DepthRejection::kLittleParallax, 20);
  reject(DepthRejection::kUncertain, 50);
  EXPECT_THAT(
      NoteWithoutDepth(rejected, {}),
      testing::StartsWith("the other images show too little parallax for a depth with a sigma of 2.0 % (70 % of "
                          "the usable pixels); take frames farther away (raise Surface.max_frames_apart, "));
}

TEST(DeformedMesh, TheSeenPartSaysWhereTheFrameItselfHasADepth) {
  Mesh mesh;
  mesh.vertices.assign(4, Eigen::Vector3f::Zero());
  mesh.triangles = {{0, 1, 2}, {1, 2, 3}};
  const MeshInFrame now{{{0, 0, 5}, {2, 0, 5}, {0, 2, 5}, {2, 2, 5}},
                        {1, 1, 1, 1},
                        {VertexView::kOutOfView, VertexView::kMeasured, VertexView::kInView, VertexView::kMeasured}};
  const Mesh seen = DeformedMesh{mesh, now, {}}.SeenPart();
  EXPECT_THAT(seen.ids, ElementsAre(1, 2, 3));
  EXPECT_THAT(seen.views, ElementsAre(2, 1, 2));
}

// Frames of a camera that moves sideways by a millimeter each; every frame sees the points of `from` to `to`.
std::vector<PosedFrame> Frames(int count, int points_lost_a_frame) {
  std::vector<PosedFrame> frames;
  for (int k = 0; k < count; ++k) {
    PosedFrame frame{k, 0, 0.0, false, {Eigen::Quaterniond::Identity(), Eigen::Vector3d(-k, 0, 0)}, {}};
    for (int i = 0; i < 40; ++i)
      frame.observations.push_back({PointId{k * points_lost_a_frame + i}, {}, Eigen::Vector3d(0.1 * i, 0, 50)});
    frames.push_back(frame);
  }
  return frames;
}

TEST(SurfaceNotes, CountFramesWhosePointsRest) {
  std::vector<PosedFrame> frames = Frames(3, 0);
  RunMap run;
  for (const PointObservation& seen : frames[0].observations) run.points[seen.id] = {seen.id, seen.position, {}};
  frames[2].observations[7].position.y() += 0.1;  // 50 away
  EXPECT_EQ(StillWarning(frames, {2}, run), "");
  EXPECT_THAT(StillWarning(frames, {0, 2}, run),
              testing::StartsWith("the run takes the scene as rigid in 1 of 2 frames: "));
}

TEST(SurfaceNeighbors, AreOnBothSidesAsFarAsPointsGo) {
  // Half of the points are common with frames up to ten away.
  EXPECT_THAT(ChooseNeighbors(Frames(41, 2), 20, {}), ElementsAre(17, 15, 10, 30, 25, 23));
}

TEST(SurfaceNeighbors, AreAllOnOneSideAtTheEnds) {
  EXPECT_THAT(ChooseNeighbors(Frames(41, 2), 0, {}), ElementsAre(10, 5, 3, 2, 1));
  EXPECT_TRUE(ChooseNeighbors(Frames(1, 2), 0, {}).empty());
}

TEST(SurfaceNeighbors, AreNotFartherThanAsManyFrames) {
  SurfaceRunOptions options;
  options.max_frames_apart = 4;
  EXPECT_THAT(ChooseNeighbors(Frames(41, 2), 20, options), ElementsAre(19, 18, 16, 24, 22, 21));
}

TEST(SurfaceNeighbors, EndAtTheLargestParallaxAndAtTheSubmap) {
  SurfaceRunOptions options;
  options.max_parallax_deg = 2.5;  // between 2 and 3 mm from some 53 mm
  std::vector<PosedFrame> frames = Frames(41, 1);
  EXPECT_THAT(ChooseNeighbors(frames, 20, options), ElementsAre(19, 18, 22, 21));
  for (std::size_t k = 20; k < frames.size(); ++k) frames[k].submap = 1;
  EXPECT_THAT(ChooseNeighbors(frames, 20, options), ElementsAre(22, 21));
}

}  // namespace
}  // namespace pliant
