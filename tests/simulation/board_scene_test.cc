// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The scene and the camera path `board`: photographs that give the camera back.
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "pliant/calibration/calibrate_camera.h"
#include "pliant/simulation/simulator.h"
#include "simulation/small_scene.h"

namespace pliant {
namespace {

using simulation_test::ExpectSameBytesOnFourThreads;
using simulation_test::Make;
using testing::HasSubstr;

const CalibrationBoard kSmallBoard = {BoardKind::kChessboard, 7, 5, 3.0};

// A photograph a second of a board of 7x5 corners, without what moves.
SimulationOptions Photographs(int frames) {
  SimulationOptions options;
  options.scene.kind = SceneKind::kBoard;
  options.scene.board = "chessboard:7x5:3";
  options.sensor.shutter_s = 0;
  options.trajectory.kind = TrajectoryKind::kBoard;
  options.trajectory.fps = 1;
  options.trajectory.frames = frames;
  return options;
}

cv::Mat GrayOf(Simulator& simulator, int frame_idx) {
  cv::Mat gray;
  cv::cvtColor(simulator.Render(frame_idx).image, gray, cv::COLOR_BGR2GRAY);
  return gray;
}

struct Lens {
  CameraModelId model;
  std::string params;
};
const Lens kDistorted = {CameraModelId::kOpenCv, "400,398,321,244,-0.27,0.07,0.0008,-0.0006"};

TEST(BoardScene, EveryViewShowsTheWholeBoardWhateverTheLens) {
  for (const auto& [model, params] : {Lens{CameraModelId::kSimplePinhole, "560,320,240"},
                                      {CameraModelId::kPinhole, "610,608,322,236"},
                                      {CameraModelId::kSimpleRadial, "520,316,243,-0.18"},
                                      {CameraModelId::kRadial, "480,325,238,-0.3,0.09"},
                                      kDistorted,
                                      {CameraModelId::kOpenCvFisheye, "290,291,318,241,-0.03,0.006,-0.002,0.0003"}}) {
    SimulationOptions options = Photographs(12);
    options.camera.model = model;
    options.camera.params = params;
    const Simulator simulator = Make(options);
    for (int i = 0; i < simulator.frame_count(); ++i) {
      const Rigid3 cam_from_board = simulator.WorldFromCamera(i).Inverse();
      for (const Eigen::Vector3d& point : kSmallBoard.Points()) {
        const auto pixel = simulator.camera().Project(cam_from_board * point);
        ASSERT_TRUE(pixel && simulator.camera().Contains(*pixel, 1.0)) << EnumName(model) << " view " << i;
      }
    }
  }
}

TEST(BoardScene, PhotographsGiveTheCameraBack) {
  constexpr int kViews = 10;
  SimulationOptions options = Photographs(kViews);
  options.camera.model = kDistorted.model;
  options.camera.params = kDistorted.params;
  Simulator simulator = Make(options);
  std::vector<BoardView> views;
  for (int i = 0; i < kViews; ++i)
    if (const auto view = FindBoard(GrayOf(simulator, i), kSmallBoard)) views.push_back(*view);
  ASSERT_GE(views.size(), 8u);
  const auto found = CalibrateCamera(kSmallBoard, views, 640, 480, ModelChoice::kOpenCv, 1);
  ASSERT_TRUE(found.ok()) << found.status().message();
  EXPECT_NEAR(found->camera.params()[0], 400, 0.003 * 400);
  EXPECT_NEAR(found->camera.params()[2], 321, 1.0);
  EXPECT_NEAR(found->camera.params()[3], 244, 1.0);
  EXPECT_LT(found->rms_px, 0.1);
}

TEST(BoardScene, PointsOfOtherBoardsAreWhereTheyProject) {
  constexpr double kNear_px = 0.5;  // the middle of an ellipse is not where the circle's center is seen
  for (const std::string name : {"circles:7x6:5", "acircles:4x9:2.5"}) {
    const CalibrationBoard board = ParseBoard(name).value();
    SimulationOptions options = Photographs(3);
    options.scene.board = name;
    Simulator simulator = Make(options);
    const std::vector<Eigen::Vector3d> points = board.Points();
    int found = 0;
    for (int i = 0; i < simulator.frame_count(); ++i) {
      const auto view = FindBoard(GrayOf(simulator, i), board);
      if (!view) continue;
      ++found;
      const Rigid3 cam_from_board = simulator.WorldFromCamera(i).Inverse();
      const auto distance = [&](std::size_t point, std::size_t seen) {
        return (*simulator.camera().Project(cam_from_board * points[point]) - view->pixels[seen]).norm();
      };
      const std::size_t last = points.size() - 1;
      const bool turned = distance(0, 0) > distance(0, last);
      for (std::size_t k = 0; k <= last; ++k) EXPECT_LT(distance(k, turned ? last - k : k), kNear_px) << name;
    }
    EXPECT_GE(found, 2) << name;
  }
}

TEST(BoardScene, MarkersOfACharucoBoardAreSeen) {
  const CalibrationBoard board = ParseBoard("charuco:8x5:10:7:5X5_100").value();
  if (!CheckBoardIsSupported(board).ok()) GTEST_SKIP() << "OpenCV came without its module aruco";
  SimulationOptions options = Photographs(2);
  options.scene.board = "charuco:8x5:10:7:5X5_100";
  Simulator simulator = Make(options);
  for (int i = 0; i < 2; ++i) {
    const auto view = FindBoard(GrayOf(simulator, i), board);
    ASSERT_TRUE(view.has_value()) << i;
    EXPECT_GE(view->pixels.size(), 14u) << i;
    const Rigid3 cam_from_board = simulator.WorldFromCamera(i).Inverse();
    for (std::size_t k = 0; k < view->pixels.size(); ++k) {
      const Eigen::Vector3d point = board.Points()[view->point_ids[k]];
      EXPECT_LT((*simulator.camera().Project(cam_from_board * point) - view->pixels[k]).norm(), 0.3) << i;
    }
  }
}

TEST(BoardScene, TheCameraStandsStillInEveryViewAndMovesBetween) {
  SimulationOptions options = Photographs(61);
  options.trajectory.fps = 30;
  options.trajectory.tremor_mm = 0;
  options.trajectory.tremor_deg = 0;
  const Simulator simulator = Make(options);
  const auto moved_mm = [&](int frame_idx) {
    return (simulator.WorldFromCamera(frame_idx + 1).translation - simulator.WorldFromCamera(frame_idx).translation)
        .norm();
  };
  for (const int view : {0, 30}) {
    EXPECT_GT(moved_mm(view + 15), 0.1);
    EXPECT_LT(moved_mm(view), 0.1 * moved_mm(view + 15));
    EXPECT_LT(moved_mm(view + 29), 0.1 * moved_mm(view + 15));
  }
}

TEST(BoardScene, BothCamerasOfAPairSeeTheBoard) {
  SimulationOptions options = Photographs(8);
  options.camera.baseline_mm = 4.3;
  const Simulator simulator = Make(options);
  for (int i = 0; i < simulator.frame_count(); ++i)
    for (const Eigen::Vector3d& point : kSmallBoard.Points()) {
      const auto pixel = simulator.camera().Project(simulator.WorldFromCamera(i, Eye::kRight).Inverse() * point);
      ASSERT_TRUE(pixel && simulator.camera().Contains(*pixel, 1.0)) << i;
    }
}

TEST(BoardScene, AnotherSeedGivesOtherViewsAndTheSameOneTheSameBytes) {
  SimulationOptions options = Photographs(2);
  options.camera.width = 160;
  options.camera.height = 120;
  ExpectSameBytesOnFourThreads(options, {0, 1});
  const Rigid3 first = Make(options).WorldFromCamera(0);
  options.scene.seed = 2;
  EXPECT_GT((Make(options).WorldFromCamera(0).translation - first.translation).norm(), 1.0);
}

TEST(BoardScene, SaysWhatIsWrong) {
  const auto message = [](const SimulationOptions& options) {
    const auto simulator = Simulator::Create(options);
    EXPECT_EQ(simulator.status().code(), ErrorCode::kInvalidArgument);
    return simulator.ok() ? std::string() : simulator.status().message();
  };
  SimulationOptions options = Photographs(2);
  options.scene.board = "chessboard:7:3";
  EXPECT_THAT(message(options), HasSubstr("has no size such as 9x6"));
  options.scene.board = "charuco:8x5:10:7:5X5_101";
  EXPECT_THAT(message(options), testing::AnyOf(HasSubstr("did you mean 5X5_100"), HasSubstr("cannot find ChArUco")));
  options.scene.board = "chessboard:7x5:0.1";
  EXPECT_THAT(message(options),
              HasSubstr("does not see all of the chessboard of 7x5 inner corners (0.1 mm apart) from anywhere"));
  options = Photographs(2);
  options.trajectory.kind = TrajectoryKind::kInsert;
  EXPECT_THAT(message(options), HasSubstr("give Trajectory.kind board"));
  options = Photographs(2);
  options.scene.kind = SceneKind::kColon;
  EXPECT_THAT(message(options), HasSubstr("give Scene.kind board"));
}

}  // namespace
}  // namespace pliant
