// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The scene `mesh`, and camera paths from files. The mesh is a room whose walls one can compute by hand.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

#include "pliant/simulation/open_simulation.h"
#include "pliant/simulation/simulator.h"
#include "pliant/simulation/write_sequence.h"
#include "simulation/small_scene.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;
using simulation_test::ExpectSameBytesOnFourThreads;
using simulation_test::kMinWarped;
using simulation_test::kRayDepth_mm;
using simulation_test::Make;
using simulation_test::Median;
using simulation_test::Pinhole160;
using simulation_test::SmallScene;
using simulation_test::WarpErrors;
using testing::HasSubstr;

constexpr double kMeanLevel = 1.0;  // gray levels in the mean: lit alike, but for the rounding of the files' corners
constexpr double kSlantedInterpolation_mm = 0.03;  // between pixels on a slanted wall
constexpr double kEdgeChord_mm = 0.01;             // of an edge of 1 mm: k^2 3 A / 8 / 2
constexpr double kReddish = 1.4;                   // mucosa is red
constexpr double kTextured = 8.0;                  // gray levels; a wall of one color has shading alone
constexpr std::size_t kMinWarpedFar = 1000;        // the camera goes 10 mm ahead between the two views

// A room from -half to half, in millimeters.
const Eigen::Vector3d kHalf(25, 20, 60);

// Its corners by the bits of their number, and its six walls seen from inside.
Eigen::Vector3d RoomCorner(int i) {
  return kHalf.cwiseProduct(Eigen::Vector3d((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1));
}
const std::vector<std::array<int, 4>> kWalls = {{0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1},
                                                {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}};

class MeshSceneTest : public testing::Test {
 protected:
  MeshSceneTest()
      : folder_(fs::temp_directory_path() / ("pliant_mesh_" + std::to_string(getpid()) + "_" +
                                             testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~MeshSceneTest() override { fs::remove_all(folder_); }

  std::string Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  // Polygons, which the reader cuts; in meters.
  std::string WriteObj() const {
    std::string text;
    for (int i = 0; i < 8; ++i) text += "v " + Text(RoomCorner(i) / 1000.0) + "\n";
    for (const auto& wall : kWalls) {
      text += "f";
      for (const int i : wall) text += " " + std::to_string(i + 1);
      text += "\n";
    }
    return Write("room.obj", text);
  }
  std::string WritePly() const {
    std::string text =
        "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 6\nproperty list uchar int vertex_indices\nend_header\n";
    for (int i = 0; i < 8; ++i) text += Text(RoomCorner(i)) + "\n";
    for (const auto& wall : kWalls) {
      text += "4";
      for (const int i : wall) text += " " + std::to_string(i);
      text += "\n";
    }
    return Write("room.ply", text);
  }
  // Each triangle by itself, and with the outside for the front.
  std::string WriteStl() const {
    std::string text = "solid room\n";
    for (const auto& w : kWalls) {
      for (const auto& t : {std::array{w[0], w[2], w[1]}, std::array{w[0], w[3], w[2]}}) {
        text += "facet normal 0 0 0\nouter loop\n";
        for (const int i : t) text += "vertex " + Text(RoomCorner(i)) + "\n";
        text += "endloop\nendfacet\n";
      }
    }
    return Write("room.stl", text + "endsolid room\n");
  }
  static std::string Text(const Eigen::Vector3d& v) {
    return std::to_string(v.x()) + " " + std::to_string(v.y()) + " " + std::to_string(v.z());
  }

  SimulationOptions Room(const std::string& path, TrajectoryKind trajectory, int frames) const {
    SimulationOptions options = SmallScene(trajectory, frames);
    options.scene.kind = SceneKind::kMesh;
    options.scene.mesh_path = path;
    options.trajectory.start_pose = "2,-1,-30,0,0,0,1";
    return options;
  }
  // Depth of the room's walls at a pixel.
  static double RoomDepth(const Rigid3& world_from_cam, const Eigen::Vector2d& pixel) {
    const Eigen::Vector3d ray = Pinhole160().BackProject(pixel.x(), pixel.y(), 1.0);  // depth is the ray's parameter
    const Eigen::Vector3d direction = world_from_cam.rotation * ray;
    double nearest = 1e9;
    for (int axis = 0; axis < 3; ++axis) {
      const double wall = direction[axis] > 0 ? kHalf[axis] : -kHalf[axis];
      nearest = std::min(nearest, (wall - world_from_cam.translation[axis]) / direction[axis]);
    }
    return nearest;
  }

  fs::path folder_;
};

TEST_F(MeshSceneTest, EveryFormatGivesTheRoomsDepth) {
  for (const std::string& path : {WriteObj(), WritePly(), WriteStl()}) {
    SimulationOptions options = Room(path, TrajectoryKind::kHold, 1);
    if (path.ends_with(".obj")) options.scene.mesh_scale = 1000;
    Simulator simulator = Make(options);
    const cv::Mat depth = simulator.Render(0).depth;
    for (int y = 0; y < 120; y += 7)
      for (int x = 0; x < 160; x += 7)
        EXPECT_NEAR(depth.at<float>(y, x), RoomDepth(simulator.WorldFromCamera(0), Eigen::Vector2d(x, y)), kRayDepth_mm)
            << path << " " << x << " " << y;
  }
}

TEST_F(MeshSceneTest, IsLitFromInsideWhicheverWayItsTrianglesRun) {
  const auto level = [&](const std::string& path) {
    return cv::mean(Make(Room(path, TrajectoryKind::kHold, 1)).Render(0).image)[2];
  };
  EXPECT_NEAR(level(WritePly()), level(WriteStl()), kMeanLevel);
}

TEST_F(MeshSceneTest, DepthAndPosesAgreeOnEveryPath) {
  for (const TrajectoryKind kind : {TrajectoryKind::kInsert, TrajectoryKind::kSway, TrajectoryKind::kLoop}) {
    Simulator simulator = Make(Room(WritePly(), kind, 20));
    const std::vector<double> errors = WarpErrors(simulator, 0, 12);
    EXPECT_GT(errors.size(), kMinWarped);
    EXPECT_LT(Median(errors), kSlantedInterpolation_mm) << EnumName(kind);
  }
}

TEST_F(MeshSceneTest, CoarseWallsBendAsTheFormulaSays) {
  SimulationOptions options = Room(WritePly(), TrajectoryKind::kHold, 20);
  options.deformation.amplitude_mm = 3.0;
  options.deformation.omega_rad_s = 4.0;
  options.deformation.wavelength_mm = 80.0;
  options.scene.mesh_step_mm = 1.0;
  Simulator simulator = Make(options);
  std::vector<Eigen::Vector2d> pixels;
  for (int x = 10; x < 150; x += 10) pixels.emplace_back(x, 100.0);
  for (const auto& hit : simulator.HitsAt(19, pixels)) {
    ASSERT_TRUE(hit);
    const Eigen::Vector3d rest = simulator.RestPosition(hit->point);
    Eigen::Vector3d moved = rest;
    moved.y() += 3.0 * std::sin(4.0 * 19 / 30.0 + 2.0 * M_PI / 80.0 * rest.sum());
    EXPECT_LT((moved - hit->point_in_world).norm(), kEdgeChord_mm);
    EXPECT_LT((moved - simulator.Position(hit->point, 19)).norm(), kLengthRoundOff_mm);
  }
}

TEST_F(MeshSceneTest, GivesTheSameBytesForAnyNumberOfThreads) {
  SimulationOptions options = Room(WriteStl(), TrajectoryKind::kSway, 3);
  options.deformation.amplitude_mm = 2.0;
  ExpectSameBytesOnFourThreads(options, {2});
}

TEST_F(MeshSceneTest, CarriesTheSolidTextureOrItsOwnPicture) {
  SimulationOptions options = Room(WritePly(), TrajectoryKind::kHold, 1);
  options.light.specular = 0;
  cv::Mat mean;
  cv::Mat deviation;
  cv::meanStdDev(Make(options).Render(0).image(cv::Rect(0, 85, 160, 20)), mean, deviation);
  EXPECT_GT(mean.at<double>(2), kReddish * mean.at<double>(1));
  EXPECT_GT(deviation.at<double>(1), kTextured);

  // The floor with a picture: green on its left half, blue on its right one.
  cv::Mat picture(32, 32, CV_8UC3, cv::Scalar(20, 200, 20));
  picture(cv::Rect(16, 0, 16, 32)).setTo(cv::Scalar(200, 20, 20));
  ASSERT_TRUE(cv::imwrite((folder_ / "floor.png").string(), picture));
  Write("floor.mtl", "newmtl floor\nmap_Kd floor.png\n");
  options.scene.mesh_path =
      Write("floor.obj",
            "mtllib floor.mtl\nv -25 20 -60\nv 25 20 -60\nv 25 20 60\nv -25 20 60\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
            "usemtl floor\nf 1/1 2/2 3/3 4/4\n");
  const cv::Mat image = Make(options).Render(0).image;
  const auto& left = image.at<cv::Vec3b>(100, 50);
  const auto& right = image.at<cv::Vec3b>(100, 110);
  EXPECT_GT(left[1], 2 * left[0]);
  EXPECT_GT(right[0], 2 * right[1]);
  ASSERT_TRUE(cv::imwrite((folder_ / "floor.png").string(), cv::Mat(5001, 10000, CV_8U, cv::Scalar(7))));
  EXPECT_THAT(Simulator::Create(options).status().message(), HasSubstr("10000x5001 pixels, more than 50 million"));
  fs::remove(folder_ / "floor.png");
  EXPECT_THAT(Simulator::Create(options).status().message(), HasSubstr("floor.png"));
}

TEST_F(MeshSceneTest, SaysWhatIsWrongWithAMesh) {
  const auto message = [&](const std::string& path, double scale = 1.0) {
    SimulationOptions options = Room(path, TrajectoryKind::kHold, 1);
    options.scene.mesh_scale = scale;
    return Simulator::Create(options).status().message();
  };
  EXPECT_THAT(message(""), HasSubstr("needs Scene.mesh_path"));
  EXPECT_THAT(message((folder_ / "none.stl").string()), HasSubstr("there is no mesh file"));
  EXPECT_THAT(message(Write("text.ply", "not a mesh\n")), HasSubstr("cannot be read"));
  for (const char* end : {"", "end_headers\n", "comment end_header\n"})
    EXPECT_THAT(
        message(Write("endless.ply", std::string("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n") + end)),
        HasSubstr("endless.ply is a PLY whose header has no end"))
        << end;
  EXPECT_THAT(message(Write("points.obj", "v 0 0 0\nv 30 0 0\nv 0 40 0\n")), HasSubstr("points.obj has no faces"));
  EXPECT_THAT(message(Write("flat.obj", "v 0 0 0\nv 30 0 0\nv 60 0 0\nf 1 2 3\n")), HasSubstr("no faces"));
  EXPECT_THAT(message(Write("nan.ply",
                            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
                            "float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\nnan 0 "
                            "0\n0 30 0\n3 0 1 2\n")),
              HasSubstr("nan.ply has a vertex that is not a finite number"));
  const std::string four =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face "
      "2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n30 0 0\n30 30 0\n0 30 0\n3 0 1 2\n";
  for (const char* face : {"3 0 1 -1\n", "4 0 1 2 9999999\n", "3 0 2 4\n", "0\n"})
    EXPECT_THAT(message(Write("face.ply", four + face)), HasSubstr("face 1 of the mesh")) << face;
  EXPECT_THAT(message(WriteObj()), HasSubstr("Scene.mesh_scale"));  // meters taken for millimeters
  EXPECT_THAT(message(WritePly(), 1e5), HasSubstr("Scene.mesh_scale"));
  SimulationOptions options = Room(WritePly(), TrajectoryKind::kHold, 1);
  options.trajectory.start_pose.clear();
  EXPECT_THAT(Simulator::Create(options).status().message(), HasSubstr("Trajectory.start_pose"));
}

TEST_F(MeshSceneTest, FollowsAFileOfPosesAndFillsInBetween) {
  SimulationOptions options = Room(WritePly(), TrajectoryKind::kFile, 5);
  options.trajectory.fps = 2.0;
  options.trajectory.path = Write("poses.txt",
                                  "# time and pose\n100.0 0 0 -30 0 0 0 1\n101.0 4 2 -10 0 0 0 1\n"
                                  "102.0 4 2 -6 0 0 0.70710678 0.70710678\n");
  Simulator simulator = Make(options);
  EXPECT_LT((simulator.WorldFromCamera(0).translation - Eigen::Vector3d(0, 0, -30)).norm(), kRoundOff);
  EXPECT_LT((simulator.WorldFromCamera(1).translation - Eigen::Vector3d(2, 1, -20)).norm(), kRoundOff);
  EXPECT_LT((simulator.WorldFromCamera(4).translation - Eigen::Vector3d(4, 2, -6)).norm(), kRoundOff);
  EXPECT_NEAR(RotationAngle(simulator.WorldFromCamera(3).rotation), M_PI / 4, kAngleRoundOff_rad);
  EXPECT_GT(WarpErrors(simulator, 0, 1).size(), kMinWarpedFar);

  options.trajectory.frames = 6;
  EXPECT_THAT(Simulator::Create(options).status().message(), HasSubstr("lasts 2 s"));
  options.trajectory.path = Write("bad.txt", "0 1 2 3\n");
  EXPECT_THAT(Simulator::Create(options).status().message(), HasSubstr("bad.txt"));
  options.trajectory.path = Write("far.txt", "0 0 0 -30 0 0 0 1\n1 1e308 0 0 0 0 0 1\n9 0 0 -30 0 0 0 1\n");
  EXPECT_THAT(Simulator::Create(options).status().message(), HasSubstr("far.txt has a pose more than 1 km"));
  options.trajectory.path = Write("empty.txt", "# nothing\n");
  EXPECT_THAT(Simulator::Create(options).status().message(), HasSubstr("no pose"));
  options.trajectory.path = (folder_ / "none.txt").string();
  EXPECT_EQ(Simulator::Create(options).status().code(), ErrorCode::kNotFound);
  options.trajectory.path.clear();
  EXPECT_THAT(Simulator::Create(options).status().message(), HasSubstr("needs Trajectory.path"));
}

TEST_F(MeshSceneTest, ACameraThatGoesThroughTheWallIsRefusedWithItsFrame) {
  SimulationOptions options = Room(WritePly(), TrajectoryKind::kFile, 3);
  options.trajectory.fps = 1.0;
  options.trajectory.path = Write("out.txt", "0 0 0 -30 0 0 0 1\n1 0 0 -20 0 0 0 1\n2 0 0 200 0 0 0 1\n");
  EXPECT_THAT(Simulator::Create(options).status().message(),
              HasSubstr("the camera of frame 1 passes through the wall"));
  options.trajectory.path = Write("near.txt", "0 0 0 -30 0 0 0 1\n1 0 0 -20 0 0 0 1\n2 0 18.5 -10 0 0 0 1\n");
  EXPECT_THAT(Simulator::Create(options).status().message(),
              HasSubstr("the camera of frame 2 is 1.5 mm from the wall"));
  options.trajectory.path = Write("away.txt", "0 0 0 500 0 0 0 1\n1 0 0 500 0 0 0 1\n2 0 0 500 0 0 0 1\n");
  EXPECT_THAT(Simulator::Create(options).status().message(), HasSubstr("sees nothing of the scene"));
}

TEST_F(MeshSceneTest, ASequenceFindsItsFilesFromAnyFolder) {
  SimulationOptions options = Room("", TrajectoryKind::kFile, 2);
  WritePly();
  Write("poses.txt", "0 0 0 -30 0 0 0 1\n1 4 2 -10 0 0 0 1\n");
  const fs::path before = fs::current_path();
  fs::current_path(folder_);
  options.scene.mesh_path = "room.ply";
  options.trajectory.path = "./poses.txt";
  const Status status = WriteSequence(options, folder_ / "sequence");
  fs::current_path(before);
  ASSERT_TRUE(status.ok()) << status.message();
  Result<Simulator> again = OpenSimulation(folder_ / "sequence");
  ASSERT_TRUE(again.ok()) << again.status().message();
  EXPECT_EQ(again->options().scene.mesh_path, (folder_ / "room.ply").string());
  EXPECT_EQ(again->options().trajectory.path, (folder_ / "poses.txt").string());
}

}  // namespace
}  // namespace pliant
