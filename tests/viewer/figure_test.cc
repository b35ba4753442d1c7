// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/viewer/figure.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "pliant/io/gltf.h"
#include "pliant/io/run_reader.h"
#include "viewer/draw_legend.h"
#include "viewer/draw_scene.h"
#include "viewer/drawing.h"
#include "viewer/frame_geometry.h"
#include "viewer/orbit.h"
#include "viewer/small_sequence.h"

namespace pliant {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr double kSmallOfDepth = 0.2;  // a camera, beside how far its points are
constexpr double kPixel = 1;           // the middle of an image of an even size lies between pixels
constexpr int kMinCamera = 50;         // pixels of a camera's frame, drawn in lines
constexpr int kMinLetters = 200;       // pixels of a sentence
constexpr int kMinLine = 20;           // pixels of a thin line or a few dots
constexpr int kMinTrails = 450;        // of eight trails in two frames, in lines that are as wide as points
constexpr int kMinSurface = 2000;      // pixels of a square that fills a good part of a panel
constexpr double kContainerFps = 0.1;  // a container keeps the rate as a fraction of its own

TEST(Orbit, ShowsEveryCameraAndNearlyEveryPoint) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 200; ++i) points.emplace_back(10 * std::sin(i), 20 * std::cos(i), 0.3 * i);
  points.emplace_back(1e5, 0, 0);  // one that went astray
  const std::vector<Eigen::Vector3d> centers = {{0, 0, -40}, {60, 0, 0}};
  const Orbit orbit(points, centers, Eigen::Quaterniond::Identity(), 40, 25, 480, 360);
  for (const std::vector<Eigen::Vector3d>* seen : {&std::as_const(points), &centers}) {
    for (std::size_t i = 0; i < std::min<std::size_t>(200, seen->size()); ++i) {
      const Eigen::Vector3d at = orbit.Project((*seen)[i]);
      EXPECT_GT(at.z(), 0);
      EXPECT_TRUE(at.x() >= 0 && at.x() <= 480 && at.y() >= 0 && at.y() <= 360) << at.transpose();
    }
  }
}

// Seen from behind the camera, to its right and above: what is ahead is farther, what is right is right, down is down.
TEST(Orbit, LooksFromBehindAndAbove) {
  const std::vector<Eigen::Vector3d> points = {{-10, -10, -10}, {10, 10, 10}};
  const Orbit orbit(points, points, Eigen::Quaterniond::Identity(), 40, 25, 480, 360);
  const Eigen::Vector3d middle = orbit.Project({0, 0, 0});
  // As far from the lower edge as from the upper one, or the same to the sides.
  const Eigen::Vector3d ends = orbit.Project(points[0]) + orbit.Project(points[1]);
  EXPECT_LT(std::min(std::abs(ends.x() / 2 - 240), std::abs(ends.y() / 2 - 180)), kPixel);
  EXPECT_GT(orbit.Project({0, 0, 1}).z(), middle.z());
  EXPECT_GT(orbit.Project({1, 0, 0}).x(), middle.x());
  EXPECT_LT(orbit.Project({1, 0, 0}).z(), middle.z());  // the eye is on the right
  EXPECT_GT(orbit.Project({0, 1, 0}).y(), middle.y());
  EXPECT_GT(orbit.Project({0, 1, 0}).z(), middle.z());  // and above
}

// A few points 50 mm before a camera that goes 10 mm to its right.
ViewedRun RunOf(const Camera& camera) {
  ViewedRun run;
  run.camera = camera;
  for (int i = 0; i < 3; ++i) {
    ViewedFrame& frame = run.frames.emplace_back();
    frame.row.frame_idx = i;
    frame.world_from_cam = Rigid3{Eigen::Quaterniond::Identity(), {5.0 * i, 0, 0}};
    for (const int x : {-2, 0, 2}) {
      ViewedObservation& seen = frame.observations.emplace_back();
      seen.id = PointId{x + 2};
      seen.position = {static_cast<float>(x), static_cast<float>(x), 50};
      seen.depth = 50;
      run.points.try_emplace(seen.id, NewPoint{seen.id, seen.position.cast<double>()});
    }
  }
  return run;
}

// A wide lens, whose image is as wide as six times its distance, and a narrow one.
TEST(Viewpoint, ShowsAllOfASmallCameraOfAnyFieldOfView) {
  for (const double focal_px : {100.0, 2000.0}) {
    const auto camera = Camera::Create("PINHOLE", 640, 480, std::vector<double>{focal_px, focal_px, 319.5, 239.5});
    const ViewedRun run = RunOf(*camera);
    const auto frustum = FrustumOf(run);
    ASSERT_TRUE(frustum);
    const Viewpoint viewpoint = ViewpointOf({}, run, {}, 480, 360);
    for (const Eigen::Vector3d& corner : *frustum) {
      EXPECT_LT(corner.norm(), kSmallOfDepth * 50) << focal_px;
      for (const ViewedFrame& frame : run.frames) {
        const Eigen::Vector3d at = viewpoint.orbit.Project(*frame.world_from_cam * corner);
        EXPECT_TRUE(at.x() >= 0 && at.x() <= 480 && at.y() >= 0 && at.y() <= 360) << at.transpose();
      }
    }
  }
}

// It reaches farther than the points, of which there are many more, and moves to its right.
TEST(Viewpoint, ShowsAllOfAMesh) {
  constexpr int kNodes = 9;
  const auto camera = Camera::Create("PINHOLE", 640, 480, std::vector<double>{500, 500, 319.5, 239.5});
  ViewedRun run = RunOf(*camera);
  run.frames[0].observations.resize(5000, run.frames[0].observations[1]);
  GltfMesh& surface = run.meshes.emplace_back().surface;
  for (int v = 0; v < kNodes * kNodes; ++v)
    surface.mesh.vertices.emplace_back(10 * (v % kNodes - 4), 10 * (v / kNodes - 4), 50);
  surface.keys = {{0, 0.0, surface.mesh.vertices}, {2, 0.1, surface.mesh.vertices}};
  for (Eigen::Vector3f& position : surface.keys[1].positions) position.x() += 40;
  const Viewpoint viewpoint = ViewpointOf({}, run, {}, 480, 360);
  double least = 480;
  double largest = 0;
  for (const MeshKey& key : surface.keys)
    for (const Eigen::Vector3f& position : key.positions) {
      const Eigen::Vector3d at = viewpoint.orbit.Project(position.cast<double>());
      EXPECT_TRUE(at.x() >= 0 && at.x() <= 480 && at.y() >= 0 && at.y() <= 360) << at.transpose();
      least = std::min(least, at.x());
      largest = std::max(largest, at.x());
    }
  EXPECT_GT(largest - least, 240);
}

// Pixels of a color in a part of a picture.
int CountPixels(const cv::Mat& picture, const cv::Scalar& bgr) {
  cv::Mat found;
  cv::inRange(picture, bgr - cv::Scalar::all(40), bgr + cv::Scalar::all(40), found);
  return cv::countNonZero(found);
}

class FigureTest : public testing::Test {
 protected:
  void SetUp() override {
    WriteRun(folder_);
    WriteSmallSequence(folder_.Path("sequence"), Truth::kDepthAndPoses);
    options_.panel_width_px = 160;
  }
  ViewRequest Request() const {
    return {.run_paths = {folder_.Path("run")}, .sequence_path = folder_.Path("sequence"), .camera_path = ""};
  }
  ViewRequest RequestWithSurface() const {
    ViewRequest request = Request();
    request.surface_paths = {folder_.Path("surface")};
    return request;
  }
  Status Write(const std::string& name, const std::vector<int>& frames_idx = {10, 14}) {
    return WriteFigure(Request(), options_, frames_idx, folder_.Path(name)).status();
  }

  TestFolder folder_;
  FigureOptions options_;
};

TEST_F(FigureTest, DrawsImagesAndScenes) {
  options_.panel_width_px = 960;
  ASSERT_TRUE(Write("figure.png").ok());
  const cv::Mat figure = cv::imread(folder_.Path("figure.png"));
  ASSERT_FALSE(figure.empty());
  EXPECT_EQ(figure.cols, 8 + 2 * 968);
  // The camera's blue, the trails' red and the truth's green are there.
  EXPECT_GT(CountPixels(figure, {178, 114, 0}), kMinCamera);
  EXPECT_GT(CountPixels(figure, {0, 94, 213}), kMinTrails);
  EXPECT_GT(CountPixels(figure, {115, 158, 0}), kMinLine);
}

TEST_F(FigureTest, OneNarrowColumnHasTheWholeLegend) {
  ASSERT_TRUE(Write("figure.png", {10}).ok());
  const cv::Mat figure = cv::imread(folder_.Path("figure.png"));
  const int height = static_cast<int>(LegendHeight(160, {.map = true, .truth = true}));
  EXPECT_GT(height, kLine);
  const cv::Mat legend = figure.rowRange(figure.rows - height, figure.rows);
  for (const cv::Scalar& bgr : {cv::Scalar(0, 94, 213), cv::Scalar(178, 114, 0), cv::Scalar(115, 158, 0)})
    EXPECT_GT(CountPixels(legend, bgr), kMinLine) << bgr;
}

TEST_F(FigureTest, TheLegendNamesATruthThatHasNoPoses) {
  const auto green_in_legend = [&] {
    EXPECT_TRUE(Write("figure.png").ok());
    const cv::Mat figure = cv::imread(folder_.Path("figure.png"));
    return CountPixels(figure.rowRange(figure.rows - static_cast<int>(kLine), figure.rows), {115, 158, 0});
  };
  options_.panel_width_px = 300;
  std::filesystem::remove(folder_.Path("sequence/groundtruth.txt"));
  EXPECT_GT(green_in_legend(), kMinLine);
  std::filesystem::remove_all(folder_.Path("sequence/depth"));
  EXPECT_EQ(green_in_legend(), 0);
}

TEST_F(FigureTest, ALongNameStaysAboveItsScene) {
  const std::string longer = folder_.Path("a run whose name is longer than its scene is wide");
  std::filesystem::copy(folder_.Path("run"), longer, std::filesystem::copy_options::recursive);
  ViewRequest request = Request();
  request.run_paths.push_back(longer);
  ASSERT_TRUE(WriteFigure(request, options_, {10}, folder_.Path("figure.png")).ok());
  const cv::Mat figure = cv::imread(folder_.Path("figure.png"));
  const cv::Mat margin = figure.colRange(figure.cols - 6, figure.cols);
  EXPECT_EQ(CountPixels(margin, cv::Scalar(255, 255, 255)), static_cast<int>(margin.total()));
}

TEST_F(FigureTest, ShowsThePointsOfEveryRunInTheImage) {
  std::filesystem::copy(folder_.Path("run"), folder_.Path("other"), std::filesystem::copy_options::recursive);
  ViewRequest request = Request();
  options_.panel_width_px = 960;
  const auto count = [&] {
    EXPECT_TRUE(WriteFigure(request, options_, {10}, folder_.Path("figure.png")).ok());
    const cv::Mat image = cv::imread(folder_.Path("figure.png")).rowRange(30, 740);
    return std::pair{CountPixels(image, {66, 228, 240}), CountPixels(image, {233, 180, 86})};  // yellow, sky blue
  };
  EXPECT_GT(count().first, kMinLine);
  EXPECT_EQ(count().second, 0);
  request.run_paths.push_back(folder_.Path("other"));  // whose points are at the same pixels
  EXPECT_GT(count().first, kMinLine);
  EXPECT_GT(count().second, kMinLine);
}

TEST_F(FigureTest, SaysWhyARunHasNothingToShow) {
  std::filesystem::remove_all(folder_.Path("run"));  // which a run that fails would leave in its place
  {
    auto writer =
        RunWriter::Create(folder_.Path("run"), TestCamera(), {"0.1.0", {"pliant"}, 7, "nowhere", {}}, "Track:\n", {});
    ASSERT_TRUE(writer.ok()) << writer.status().message();
    for (int i = 0; i < kRunFrames; ++i) {
      FrameReport report;
      report.frame_idx = Report(i).frame_idx;
      report.timestamp_s = Report(i).timestamp_s;
      report.state = TrackingState::kInitializing;
      ASSERT_TRUE(writer->Write(report).ok());
    }
    ASSERT_TRUE(writer->Finish(RunStatus::kFailed, "the camera did not move").ok());
  }
  options_.panel_width_px = 320;
  ASSERT_TRUE(Write("figure.png", {10}).ok());
  const cv::Mat figure = cv::imread(folder_.Path("figure.png"));
  const int bottom = figure.rows - static_cast<int>(kLine) - 12;  // inside the scene's panel
  EXPECT_GT(CountPixels(figure(cv::Range(bottom - 220, bottom), cv::Range(12, 324)), {0, 0, 0}), kMinLetters);
}

// A square behind the run's points, whose right half moves by up to 2 until the frame 14. It faces the cameras.
void WriteSquare(const TestFolder& folder) {
  std::filesystem::create_directories(folder.Path("surface"));
  folder.Write("surface/camera.yaml", "model: PINHOLE\nwidth: 640\nheight: 480\nparams: [500, 500, 319.5, 239.5]\n");
  folder.Write("surface/surface.json",
               "{\"status\": \"completed\", \"run\": \"" + folder.Path("run") + "\", \"frames\": []}");
  constexpr int kNodes = 9;
  Mesh mesh;
  for (int row = 0; row < kNodes; ++row)
    for (int column = 0; column < kNodes; ++column) {
      mesh.vertices.emplace_back(4 * (column - 4), 4 * (row - 4), 60);
      mesh.sigmas.push_back(0.5F);
      const int v = row * kNodes + column;
      if (row + 1 == kNodes || column + 1 == kNodes) continue;
      mesh.triangles.push_back({v, v + kNodes, v + 1});
      mesh.triangles.push_back({v + kNodes, v + kNodes + 1, v + 1});
    }
  mesh.normals.assign(mesh.vertices.size(), -Eigen::Vector3f::UnitZ());
  mesh.rgb.resize(mesh.vertices.size());
  std::vector<MeshKey> keys = {{10, 0.0, mesh.vertices}, {14, 0.1, mesh.vertices}};
  for (Eigen::Vector3f& position : keys[1].positions) position.z() += std::max(0.0F, position.x() / 8);
  ASSERT_TRUE(WriteGlb(folder.Path("surface/surface.glb"), {mesh, "", keys, {}, TestCamera(), 0}).ok());
}

TEST_F(FigureTest, DrawsTheSurfaceInTheColorsOfItsValues) {
  WriteSquare(folder_);
  options_.panel_width_px = 480;
  options_.surface_color = SurfaceColor::kDisplacement;
  const ViewRequest request = RequestWithSurface();
  const auto draw = [&](const char* name) {
    EXPECT_TRUE(WriteFigure(request, options_, {10, 14}, folder_.Path(name)).ok());
    return cv::imread(folder_.Path(name));
  };
  const cv::Mat figure = draw("figure.png");
  ASSERT_FALSE(figure.empty());
  const int bottom = figure.rows - static_cast<int>(kLine);  // of the panels; below is the legend
  const cv::Mat first = figure(cv::Range(400, bottom), cv::Range(0, 488));
  const cv::Mat then = figure(cv::Range(400, bottom), cv::Range(488, figure.cols));
  const cv::Scalar lowest(84, 1, 68);
  EXPECT_GT(CountPixels(first, lowest), kMinSurface);  // all of it is where it rests
  EXPECT_GT(CountPixels(then, lowest), kMinSurface / 4);
  EXPECT_LT(CountPixels(then, lowest), CountPixels(first, lowest) * 3 / 4);
  const cv::Scalar highest(37, 231, 253);
  EXPECT_EQ(CountPixels(first, highest), 0);
  // The legend has the colors, and names their range.
  const cv::Mat legend = figure.rowRange(bottom, figure.rows);
  EXPECT_GT(CountPixels(legend, highest), kMinLine);
  // Seen from behind it hides nothing.
  options_.azimuth_deg = 170;
  const cv::Mat behind = draw("behind.png");
  EXPECT_EQ(CountPixels(behind(cv::Range(400, bottom), cv::Range(0, 488)), lowest), 0);
}

TEST_F(FigureTest, DrawsAChangeOfAreaInColorsOfBothSigns) {
  WriteSquare(folder_);
  options_.panel_width_px = 480;
  options_.surface_color = SurfaceColor::kAreaChange;
  ASSERT_TRUE(WriteFigure(RequestWithSurface(), options_, {10, 14}, folder_.Path("figure.png")).ok());
  const cv::Mat figure = cv::imread(folder_.Path("figure.png"));
  const cv::Mat legend = figure.rowRange(figure.rows - static_cast<int>(kLine), figure.rows);
  EXPECT_GT(CountPixels(legend, {192, 76, 59}), kMinLine);  // blue, and no violet of viridis
  EXPECT_GT(CountPixels(legend, {38, 4, 180}), kMinLine);
  EXPECT_EQ(CountPixels(legend, {84, 1, 68}), 0);
}

// The keys are the frames 10 and 14.
TEST_F(FigureTest, ShowsNoSurfaceAfterItsLastKeyAndSaysSo) {
  WriteSquare(folder_);
  options_.panel_width_px = 480;
  options_.surface_color = SurfaceColor::kDisplacement;
  const ViewRequest request = RequestWithSurface();
  const auto scene = [&](int frame_idx) {
    EXPECT_TRUE(WriteFigure(request, options_, {frame_idx}, folder_.Path("figure.png")).ok());
    return cv::Mat(cv::imread(folder_.Path("figure.png")), cv::Range(400, 740), cv::Range(12, 484));
  };
  const cv::Mat with = scene(12);
  const cv::Mat without = scene(16);
  const cv::Scalar lowest(84, 1, 68);
  EXPECT_GT(CountPixels(with, lowest), kMinSurface / 4);
  EXPECT_LT(CountPixels(without, lowest), kMinLine);
  constexpr int kSentence = 16;  // rows
  EXPECT_LT(CountPixels(with.rowRange(0, kSentence), {0, 0, 0}), kMinLine);
  EXPECT_GT(CountPixels(without.rowRange(0, kSentence), {0, 0, 0}), kMinLine);
}

TEST(SceneDrawer, NamesTheMapWhereAFrameHasNoSurface) {
  const auto camera = Camera::Create("PINHOLE", 640, 480, std::vector<double>{500, 500, 319.5, 239.5});
  View view;
  view.runs.push_back(RunOf(*camera));
  GltfMesh& surface = view.runs[0].meshes.emplace_back().surface;
  surface.mesh.vertices = {{-2, -2, 50}, {2, -2, 50}, {2, 2, 50}};
  surface.mesh.triangles = {{0, 2, 1}};
  surface.keys = {{1, 0.0, surface.mesh.vertices}};
  const FigureOptions options;
  const SceneDrawer scenes(view, options, 480, 360);
  EXPECT_FALSE(scenes.Legend({1}).map);
  EXPECT_TRUE(scenes.Legend({0, 1}).map);
  EXPECT_TRUE(scenes.Legend({1, 2}).map);
}

TEST(SceneDrawer, ShowsNoSurfaceInAFrameWithoutAPose) {
  const auto camera = Camera::Create("PINHOLE", 640, 480, std::vector<double>{500, 500, 319.5, 239.5});
  View view;
  view.runs.push_back(RunOf(*camera));
  GltfMesh& surface = view.runs[0].meshes.emplace_back().surface;
  surface.mesh.vertices = {{-2, -2, 50}, {2, -2, 50}, {2, 2, 50}};
  surface.mesh.triangles = {{0, 2, 1}};
  surface.keys = {{0, 0.0, surface.mesh.vertices}, {2, 0.1, surface.mesh.vertices}};
  const FigureOptions options;
  const SceneDrawer scenes(view, options, 480, 360);
  EXPECT_FALSE(scenes.Legend({1}).map);
  view.runs[0].frames[1].world_from_cam.reset();
  EXPECT_TRUE(scenes.Legend({1}).map);
}

TEST_F(FigureTest, RefusesTheSurfaceOfARunThatWasReplaced) {
  WriteSquare(folder_);
  ViewRequest request = RequestWithSurface();
  for (const std::string& checksum : {TrajectoryChecksum(folder_.Path("run")).value(), std::string("00000000")}) {
    folder_.Write("surface/surface.json", "{\"status\": \"completed\", \"run\": \"" + folder_.Path("run") +
                                              "\", \"trajectory_crc32\": \"" + checksum + "\", \"frames\": []}");
    const Status status = WriteFigure(request, options_, {10}, folder_.Path("figure.png")).status();
    if (checksum != "00000000")
      EXPECT_TRUE(status.ok()) << status.message();
    else
      EXPECT_THAT(status.message(), HasSubstr("which was replaced or continued since"));
  }
}

TEST_F(FigureTest, DrawsTheSurfaceInAFilmAndInVectors) {
  WriteSquare(folder_);
  options_.panel_width_px = 320;
  options_.surface_color = SurfaceColor::kError;
  ViewRequest request = RequestWithSurface();
  ASSERT_TRUE(WriteFilm(request, options_, folder_.Path("film.mp4"), [](int, int) { return true; }).ok());
  cv::VideoCapture film(folder_.Path("film.mp4"));
  cv::Mat frame;
  ASSERT_TRUE(film.read(frame));
  cv::Mat hsv;
  cv::cvtColor(frame(cv::Range(30, 240), cv::Range(330, 630)), hsv, cv::COLOR_BGR2HSV);
  cv::Mat colored;
  cv::inRange(hsv, cv::Scalar(0, 60, 30), cv::Scalar(180, 255, 255), colored);
  EXPECT_GT(cv::countNonZero(colored), kMinSurface);
  ASSERT_TRUE(WriteFigure(request, options_, {14}, folder_.Path("figure.svg")).ok());
  EXPECT_THAT(folder_.Read("figure.svg"), HasSubstr("data:image/png"));
}

TEST_F(FigureTest, ColorsThatNothingHasAreRefused) {
  options_.surface_color = SurfaceColor::kAreaChange;
  EXPECT_THAT(Write("figure.png").message(), HasSubstr("is 'area_change', but there is no surface"));
  WriteSquare(folder_);
  options_.surface_color = SurfaceColor::kError;
  std::filesystem::remove_all(folder_.Path("sequence/depth"));
  ViewRequest request = RequestWithSurface();
  EXPECT_THAT(WriteFigure(request, options_, {10}, folder_.Path("figure.png")).status().message(),
              HasSubstr("the true surface is not known"));
}

TEST_F(FigureTest, WritesVectors) {
  ASSERT_TRUE(Write("figure.svg").ok());
  EXPECT_THAT(folder_.Read("figure.svg"), HasSubstr("<svg"));
  EXPECT_THAT(folder_.Read("figure.svg"), HasSubstr("data:image/jpeg"));
  ASSERT_TRUE(Write("figure.pdf").ok());
  EXPECT_THAT(folder_.Read("figure.pdf"), StartsWith("%PDF"));
}

TEST_F(FigureTest, AFrameThatIsNotThereIsNamed) {
  const Status status = Write("figure.png", {10, 11});
  EXPECT_EQ(status.code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr("frame 11 is in no run; the first run has 10 to 18"));
  EXPECT_FALSE(std::filesystem::exists(folder_.Path("figure.png")));
}

TEST_F(FigureTest, WhatCannotBeWrittenLeavesNothing) {
  for (const char* name : {"nowhere/figure.png", "nowhere/figure.svg", "nowhere/film.mp4"}) {
    const Status status =
        std::string(name).ends_with("mp4")
            ? WriteFilm(Request(), options_, folder_.Path(name), [](int, int) { return true; }).status()
            : Write(name);
    EXPECT_EQ(status.code(), ErrorCode::kUnwritable) << name;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_.Path("nowhere")));
}

TEST_F(FigureTest, AFrameIsDrawnOnce) {
  ASSERT_TRUE(Write("figure.png", {10, 10}).ok());
  EXPECT_EQ(cv::imread(folder_.Path("figure.png")).cols, 8 + 168);
}

TEST_F(FigureTest, APictureBeyondAllBoundsIsRefused) {
  options_.panel_width_px = 40000;
  EXPECT_THAT(Write("figure.png").message(), HasSubstr("is too large; give fewer frames"));
}

TEST_F(FigureTest, StoppedOnRequestItLeavesTheOldOne) {
  folder_.Write("figure.svg", "the old one");
  const Status stopped =
      WriteFigure(Request(), options_, {10, 14}, folder_.Path("figure.svg"), [](std::string_view task, int done, int) {
        return task != "figure" || done < 1;
      }).status();
  EXPECT_EQ(stopped.code(), ErrorCode::kInterrupted);
  EXPECT_THAT(stopped.message(), testing::HasSubstr("nothing was written"));
  EXPECT_EQ(folder_.Read("figure.svg"), "the old one");
}

TEST_F(FigureTest, AFilmThatIsStoppedIsWholeUpToThere) {
  ASSERT_TRUE(WriteFilm(Request(), options_, folder_.Path("film.mp4"), [](int done, int) { return done < 2; }).ok());
  cv::VideoCapture film(folder_.Path("film.mp4"));
  int frames = 0;
  while (film.grab()) ++frames;
  EXPECT_EQ(frames, 2);
}

TEST_F(FigureTest, AFilmThatIsStoppedLeavesTheOldOne) {
  folder_.Write("film.mp4", "the old one");
  const Status stopped =
      WriteFilm(Request(), options_, folder_.Path("film.mp4"), [](int done, int) { return done < 2; }).status();
  EXPECT_EQ(stopped.code(), ErrorCode::kInterrupted);
  EXPECT_THAT(stopped.message(), testing::HasSubstr("that was there is unchanged"));
  EXPECT_EQ(folder_.Read("film.mp4"), "the old one");
  EXPECT_FALSE(std::filesystem::exists(folder_.Path("film.part.mp4")));
}

TEST_F(FigureTest, AFilmThatFailsLeavesTheOldOne) {
  folder_.Write("film.mp4", "the old one");
  folder_.Write("sequence/images/000014.png", "no image");
  EXPECT_FALSE(WriteFilm(Request(), options_, folder_.Path("film.mp4"), [](int, int) { return true; }).ok());
  EXPECT_EQ(folder_.Read("film.mp4"), "the old one");
  EXPECT_FALSE(std::filesystem::exists(folder_.Path("film.part.mp4")));
}

TEST_F(FigureTest, WithoutItsImagesItSaysSo) {
  ViewRequest request = Request();
  request.sequence_path = "";
  const auto notes = WriteFigure(request, options_, {10}, folder_.Path("figure.png"));
  ASSERT_TRUE(notes.ok()) << notes.status().message();
  ASSERT_EQ(notes->size(), 1U);
  EXPECT_THAT(notes->front(), testing::HasSubstr("the images cannot be shown"));
}

TEST_F(FigureTest, FilmsEveryFrame) {
  int told = 0;
  const auto notes = WriteFilm(Request(), options_, folder_.Path("film.mp4"), [&](int done, int frames) {
    EXPECT_EQ(done, ++told);
    EXPECT_EQ(frames, kRunFrames);
    return true;
  });
  ASSERT_TRUE(notes.ok()) << notes.status().message();
  EXPECT_TRUE(notes->empty());
  cv::VideoCapture film(folder_.Path("film.mp4"));
  ASSERT_TRUE(film.isOpened());
  EXPECT_NEAR(film.get(cv::CAP_PROP_FPS), 25, kContainerFps);
  int frames = 0;
  for (cv::Mat frame; film.read(frame); ++frames) EXPECT_EQ(frame.cols, 320);
  EXPECT_EQ(frames, kRunFrames);
}

}  // namespace
}  // namespace pliant
