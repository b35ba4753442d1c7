// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/simulation/material_truth.h"

#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "simulation/small_scene.h"
#include "support/text_pipe.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;
using simulation_test::kChord_px;
using simulation_test::Make;
using simulation_test::Pinhole160;
using simulation_test::SmallScene;
using testing::HasSubstr;

constexpr double kPixelRoundOff_px = 1e-6;  // positions to round-off, divided by a depth that may be small

class MaterialTruthTest : public testing::Test {
 protected:
  MaterialTruthTest()
      : folder_(fs::temp_directory_path() / ("pliant_truth_" + std::to_string(getpid()) + "_" +
                                             testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::create_directories(folder_);
  }
  ~MaterialTruthTest() override { fs::remove_all(folder_); }

  fs::path Write(const std::string& text) const {
    std::ofstream(folder_ / "points.csv") << text;
    return folder_ / "points.csv";
  }

  fs::path folder_;
};

TEST_F(MaterialTruthTest, PathsStartAtTheirPixelAndFollowTheFormula) {
  SimulationOptions options = SmallScene(TrajectoryKind::kSway, 12);
  options.deformation.amplitude_mm = 3.0;
  options.deformation.omega_rad_s = 5.0;
  options.deformation.wavelength_mm = 300.0;
  Simulator simulator = Make(options);
  // Frames out of order, so that answers must find their questions again.
  const std::vector<FramePixel> starts = {{7, {30, 20}}, {0, {60.5, 80.25}}, {7, {120, 90}}, {3, {20, 100}}};
  const auto paths = FollowMaterial(simulator, starts);
  ASSERT_TRUE(paths.ok()) << paths.status().message();
  ASSERT_EQ(paths->size(), 4U);
  const Pinhole160 pinhole;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const MaterialPath& path = (*paths)[i];
    ASSERT_TRUE(path.point);
    ASSERT_EQ(path.observations.size(), 12U);
    const MaterialObservation& first = path.observations[starts[i].frame_idx];
    EXPECT_EQ(first.visibility, Visibility::kVisible);
    EXPECT_LT((first.pixel - starts[i].pixel).norm(), kChord_px);
    const Eigen::Vector3d rest = simulator.RestPosition(*path.point);
    for (int k = 0; k < 12; ++k) {
      const Eigen::Vector3d moved(rest.x(), rest.y() + 3.0 * std::sin(5.0 * k / 30.0 + 2.0 * M_PI / 300.0 * rest.sum()),
                                  rest.z());
      EXPECT_LT((path.observations[k].point_in_world - moved).norm(), kLengthRoundOff_mm);
      const Eigen::Vector3d in_cam = simulator.WorldFromCamera(k).Inverse() * moved;
      EXPECT_LT((path.observations[k].pixel - pinhole.Project(in_cam)).norm(), kPixelRoundOff_px);
    }
  }
}

TEST_F(MaterialTruthTest, TheFileHasARowAPointAndFrame) {
  MaterialObservation seen;
  seen.point_in_world = {1.5, -2, 3};
  seen.pixel = {10.25, 20};
  seen.depth_mm = 33;
  seen.visibility = Visibility::kOccluded;
  MaterialObservation behind;
  behind.point_in_world = {0, 0, -5};
  behind.depth_mm = -30;
  std::vector<MaterialPath> paths(2);
  paths[1].point = MaterialPoint{};
  paths[1].observations = {seen, behind};
  const fs::path path = folder_ / "paths.csv";
  ASSERT_TRUE(WriteMaterialPaths(path, paths).ok());
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  EXPECT_EQ(text.str(),
            "point,frame,u_px,v_px,x,y,z,depth_mm,visibility\n"
            "1,0,10.25,20,1.5,-2,3,33,occluded\n"
            "1,1,,,0,0,-5,-30,outside\n");
  EXPECT_EQ(WriteMaterialPaths(folder_ / "nowhere/paths.csv", paths).code(), ErrorCode::kUnwritable);
  if (fs::exists("/dev/full")) {  // a disk without room
    EXPECT_EQ(WriteMaterialPaths("/dev/full", paths).code(), ErrorCode::kUnwritable);
  }
}

TEST_F(MaterialTruthTest, ReadsPointsByTheNamesOfTheirColumns) {
  const auto points = ReadFramePixels(Write("frame,point_id,u_px,v_px,ssim\n3,17,1.5,2,0.9\r\n\n0,4,-0.25,7e1,1\n"));
  ASSERT_TRUE(points.ok()) << points.status().message();
  ASSERT_EQ(points->size(), 2U);
  EXPECT_EQ((*points)[0].frame_idx, 3);
  EXPECT_EQ((*points)[0].pixel, Eigen::Vector2d(1.5, 2));
  EXPECT_EQ((*points)[1].pixel, Eigen::Vector2d(-0.25, 70));
}

TEST_F(MaterialTruthTest, NamesTheLineThatIsWrong) {
  EXPECT_EQ(ReadFramePixels(folder_ / "nowhere.csv").status().code(), ErrorCode::kNotFound);
  EXPECT_THAT(ReadFramePixels(Write("")).status().message(), HasSubstr("points.csv:1"));
  EXPECT_THAT(ReadFramePixels(Write("frame,x,y\n")).status().message(), HasSubstr("no column u_px"));
  EXPECT_THAT(ReadFramePixels(Write("frame,u_px,v_px\n0,1,2\n0,1\n")).status().message(), HasSubstr("points.csv:3"));
  EXPECT_THAT(ReadFramePixels(Write("frame,u_px,v_px\n0.5,1,2\n")).status().message(), HasSubstr("points.csv:2"));
}

TEST_F(MaterialTruthTest, DoesNotReadPointsFromAPipe) {
  const TextPipe pipe(folder_ / "pipe", "frame,u_px,v_px\n0,1,2\nthe end\n");
  EXPECT_THAT(ReadFramePixels(folder_ / "pipe").status().message(), HasSubstr("pipe' is a pipe or a device"));
  EXPECT_TRUE(pipe.IsUnread());
}

TEST_F(MaterialTruthTest, RefusesFramesAndPixelsThatAreNotThere) {
  Simulator simulator = Make(SmallScene(TrajectoryKind::kHold, 2));
  const auto message = [&](const FramePixel& start) {
    const auto paths = FollowMaterial(simulator, std::vector<FramePixel>{{0, {5, 5}}, start});
    EXPECT_EQ(paths.status().code(), ErrorCode::kInvalidArgument);
    return paths.status().message();
  };
  EXPECT_THAT(message({2, {5, 5}}), HasSubstr("point 2 is in frame 2, and the sequence has the frames 0 to 1"));
  EXPECT_THAT(message({-1, {5, 5}}), HasSubstr("frame -1"));
  EXPECT_THAT(message({0, {160, 5}}), HasSubstr("outside the image of 160 x 120"));
  EXPECT_THAT(message({0, {5, std::numeric_limits<double>::quiet_NaN()}}), HasSubstr("outside"));
}

TEST_F(MaterialTruthTest, TheGridCoversTheImage) {
  const Simulator simulator = Make(SmallScene(TrajectoryKind::kHold, 1));
  const std::vector<FramePixel> grid = PixelGrid(simulator.camera(), 0, 40);
  ASSERT_EQ(grid.size(), 12U);
  EXPECT_EQ(grid.front().pixel, Eigen::Vector2d(20, 20));
  EXPECT_EQ(grid.back().pixel, Eigen::Vector2d(140, 100));
}

}  // namespace
}  // namespace pliant
