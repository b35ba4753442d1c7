// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The scenes, their deformation and the camera's paths. What is expected is worked out here again.
#include <cmath>
#include <complex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/simulation/simulator.h"
#include "simulation/small_scene.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using simulation_test::ExpectSameBytesOnFourThreads;
using simulation_test::kMinSeen;
using simulation_test::Make;
using simulation_test::Median;
using simulation_test::Pinhole160;
using simulation_test::SmallScene;
using simulation_test::SmoothDepth;
using simulation_test::WarpErrors;
using testing::HasSubstr;

constexpr std::size_t kMinWarpedAtFolds = 160U * 120U / 6U;  // pixels that both views see; folds and lobes hide many
constexpr double kCoarseInterpolation_mm = 0.05;  // of depth between pixels a millimeter apart on a curved, uneven wall
constexpr int kFilled = 160 * 120 * 85 / 100;     // pixels; above the horizon there is nothing
constexpr double kHills_mm = 12.0;                // hills of a centimeter, seen at a slant
constexpr std::size_t kMinPoints = 200;           // of a grid of 374
constexpr double kRayRest_mm = 1e-5;              // the hit of a ray in floats, mapped back to rest
constexpr double kRayRest10_mm = 1e-4;            // the same for hits further away, to and from the axis
constexpr double kOneDirection = 1e-4;            // of unit vectors from pokes of half a millimeter and more
constexpr double kPoked_mm = 3.0;                 // of 5 mm, at the nearest point of the grid
constexpr double kUp = -0.7;                      // y points down; the sheet's normal points to the camera
constexpr double kSomeMotion_mm = 0.5;            // or nothing would have been tested
constexpr int kMinOnALobe = 100;                  // points of the grid: each lobe is in view
constexpr double kOneOfTwo_mm = 1e-6;             // the two motions differ by millimeters
constexpr int kHalfOfTheRows = 60;                // the gap runs across the view
constexpr double kTremor_mm = 2.0;                // it adds a few tenths
constexpr double kNoJump_mm = 2.5;                // a loop of about 50 mm in 40 steps, with tremor

SimulationOptions Scene(SceneKind scene, TrajectoryKind trajectory, int frames) {
  SimulationOptions options = SmallScene(trajectory, frames);
  options.scene.kind = scene;
  return options;
}

std::vector<Eigen::Vector2d> PixelGrid(int step) {
  std::vector<Eigen::Vector2d> pixels;
  for (int y = 4; y < 120; y += step)
    for (int x = 4; x < 160; x += step) pixels.emplace_back(x, y);
  return pixels;
}

std::vector<MaterialPoint> PointsAt(Simulator& simulator, int frame_idx, int step) {
  std::vector<MaterialPoint> points;
  for (const auto& hit : simulator.HitsAt(frame_idx, PixelGrid(step)))
    if (hit) points.push_back(hit->point);
  return points;
}

struct SceneAndPath {
  SceneKind scene;
  TrajectoryKind path;
};

class EveryScene : public testing::TestWithParam<SceneAndPath> {};

TEST_P(EveryScene, DepthAndPosesAgreeWhereNothingDeforms) {
  Simulator simulator = Make(Scene(GetParam().scene, GetParam().path, 20));
  EXPECT_TRUE(simulator.warnings().empty());
  const std::vector<double> errors = WarpErrors(simulator, 0, 12);
  EXPECT_GT(errors.size(), kMinWarpedAtFolds);
  EXPECT_LT(Median(errors), kCoarseInterpolation_mm);
}

TEST_P(EveryScene, GivesTheSameBytesForAnyNumberOfThreads) {
  SimulationOptions options = Scene(GetParam().scene, GetParam().path, 4);
  options.deformation.amplitude_mm = 2.0;
  options.deformation.breathing_mm = 1.0;
  options.deformation.poke_mm = 2.0;
  ExpectSameBytesOnFourThreads(options, {3});
}

INSTANTIATE_TEST_SUITE_P(Scenes, EveryScene,
                         testing::Values(SceneAndPath{SceneKind::kColon, TrajectoryKind::kLoop},
                                         SceneAndPath{SceneKind::kTube, TrajectoryKind::kInsert},
                                         SceneAndPath{SceneKind::kSurface, TrajectoryKind::kInsert},
                                         SceneAndPath{SceneKind::kSurface, TrajectoryKind::kSway},
                                         SceneAndPath{SceneKind::kSurface, TrajectoryKind::kLoop},
                                         SceneAndPath{SceneKind::kLobes, TrajectoryKind::kInsert},
                                         SceneAndPath{SceneKind::kLobes, TrajectoryKind::kHold},
                                         SceneAndPath{SceneKind::kLobes, TrajectoryKind::kSway}),
                         [](const auto& parameter) {
                           return std::string(EnumName(parameter.param.scene)) + "_" +
                                  std::string(EnumName(parameter.param.path));
                         });

TEST(Scenes, TheSheetIsSeenFromItsHeightAndFillsTheView) {
  Simulator simulator = Make(Scene(SceneKind::kSurface, TrajectoryKind::kHold, 1));
  const cv::Mat depth = simulator.Render(0).depth;
  int seen = 0;
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x) seen += depth.at<float>(y, x) > 0;
  EXPECT_GT(seen, kFilled);
  // 60 mm above the ground, looking at a position 35 mm ahead.
  EXPECT_NEAR(depth.at<float>(60, 80), std::hypot(60.0, 35.0), kHills_mm);
}

TEST(Deformation, IsTheSumOfWaveBreathAndPoke) {
  SimulationOptions options = Scene(SceneKind::kSurface, TrajectoryKind::kHold, 40);
  options.deformation.amplitude_mm = 3.0;
  options.deformation.omega_rad_s = 4.0;
  options.deformation.wavelength_mm = 250.0;
  options.deformation.breathing_mm = 2.0;
  options.deformation.breathing_period_s = 3.0;
  options.deformation.poke_mm = 5.0;
  options.deformation.poke_radius_mm = 9.0;
  options.deformation.poke_period_s = 1.5;
  options.deformation.poke_place = "3,60,30";
  Simulator simulator = Make(options);
  const std::vector<MaterialPoint> points = PointsAt(simulator, 0, 7);
  ASSERT_GT(points.size(), kMinPoints);
  // Where the poke is: the position on the wall that the first camera sees on its way to poke_place.
  const Rigid3 cam_from_world = simulator.WorldFromCamera(0).Inverse();
  options.deformation = {};
  Simulator rigid = Make(options);
  const Eigen::Vector2d poked_px = Pinhole160().Project(cam_from_world * Eigen::Vector3d(3, 60, 30));
  const Eigen::Vector3d poked = rigid.RestPosition(rigid.HitsAt(0, std::vector{poked_px})[0].value().point);

  constexpr int kFrame = 20;
  const double t = kFrame / 30.0;
  const double push = 5.0 * std::pow(std::sin(M_PI * t / 1.5), 2);
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  double largest_poke = 0;
  for (const MaterialPoint& point : points) {
    const Eigen::Vector3d rest = simulator.RestPosition(point);
    Eigen::Vector3d expected = rest;
    expected.y() += 3.0 * std::sin(4.0 * t + 2.0 * M_PI / 250.0 * rest.sum());
    // The sheet swells from the line 100 mm below the ground, which is 60 mm below the way.
    expected += 2.0 * std::sin(2.0 * M_PI * t / 3.0) / 100.0 * Eigen::Vector3d(rest.x(), rest.y() - 160.0, 0.0);
    const Eigen::Vector3d poke = simulator.Position(point, kFrame) - expected;
    EXPECT_NEAR(poke.norm(), push * std::exp(-(rest - poked).squaredNorm() / (2.0 * 81.0)), kRayRest_mm);
    if (poke.norm() > 0.5 && direction.isZero()) direction = poke.normalized();
    if (poke.norm() > 0.5) {
      EXPECT_LT((poke.normalized() - direction).norm(), kOneDirection);
    }
    largest_poke = std::max(largest_poke, poke.norm());
  }
  EXPECT_GT(largest_poke, kPoked_mm);
  EXPECT_LT(direction.y(), kUp);
}

TEST(Deformation, MaterialPointsLieOnTheSurfaceThatIsSeen) {
  for (const SceneKind scene : {SceneKind::kColon, SceneKind::kSurface, SceneKind::kLobes}) {
    SimulationOptions options = Scene(scene, TrajectoryKind::kHold, 40);
    options.deformation.amplitude_mm = 2.0;
    options.deformation.breathing_mm = 2.0;
    options.deformation.poke_mm = 3.0;
    Simulator simulator = Make(options);
    const std::vector<MaterialPoint> points = PointsAt(simulator, 0, 9);
    const cv::Mat depth = simulator.Render(22).depth;
    const Rigid3 cam_from_world = simulator.WorldFromCamera(22).Inverse();
    std::vector<double> errors;
    std::vector<double> motions;
    for (const MaterialPoint& point : points) {
      const Eigen::Vector3d now = simulator.Position(point, 22);
      motions.push_back((now - simulator.Position(point, 0)).norm());
      const Eigen::Vector3d in_cam = cam_from_world * now;
      const auto seen = SmoothDepth(depth, Pinhole160().Project(in_cam), 1.0);
      if (seen && std::abs(*seen - in_cam.z()) < 1.5) errors.push_back(std::abs(*seen - in_cam.z()));
    }
    ASSERT_GT(errors.size(), kMinSeen);
    EXPECT_LT(Median(errors), kCoarseInterpolation_mm) << EnumName(scene);
    EXPECT_GT(Median(motions), kSomeMotion_mm) << EnumName(scene);
  }
}

TEST(Deformation, ATubeBreathesAwayFromItsAxis) {
  SimulationOptions options = Scene(SceneKind::kTube, TrajectoryKind::kHold, 31);
  options.scene.bend_deg_per_cm = 0;  // the axis is the z axis
  options.deformation.breathing_mm = 2.0;
  options.deformation.breathing_period_s = 4.0;
  Simulator simulator = Make(options);
  const std::vector<MaterialPoint> points = PointsAt(simulator, 0, 12);
  ASSERT_GT(points.size(), kMinSeen);
  for (const MaterialPoint& point : points) {
    const Eigen::Vector3d rest = simulator.RestPosition(point);
    const Eigen::Vector3d swollen = simulator.Position(point, 30);  // a quarter of the period: the widest
    const double radius = rest.head<2>().norm();
    EXPECT_NEAR(swollen.head<2>().norm(), radius * (1.0 + 2.0 / 25.0), kRayRest10_mm);
    EXPECT_NEAR(swollen.z(), rest.z(), kRayRest10_mm);
  }
}

TEST(Lobes, MoveEachByItsOwnWaveWithAStepBetweenThem) {
  SimulationOptions options = Scene(SceneKind::kLobes, TrajectoryKind::kHold, 40);
  options.deformation.amplitude_mm = 3.0;
  options.deformation.lobe_share = 0.5;
  options.deformation.lobe_phase_deg = 90.0;
  options.deformation.lobe_direction_deg = 30.0;
  Simulator simulator = Make(options);
  constexpr int kFrame = 15;
  const double t = kFrame / 30.0;
  const double k = 2.0 * M_PI / options.deformation.wavelength_mm;
  int lower = 0;
  int upper = 0;
  for (const MaterialPoint& point : PointsAt(simulator, 0, 5)) {
    const Eigen::Vector3d rest = simulator.RestPosition(point);
    const Eigen::Vector3d moved = simulator.Position(point, kFrame) - rest;
    const double angle = 2.5 * t + k * rest.sum();
    const Eigen::Vector3d as_lower(0.0, 3.0 * std::sin(angle), 0.0);
    const Eigen::Vector3d as_upper =
        1.5 * std::sin(angle + M_PI / 2) * Eigen::Vector3d(std::sin(M_PI / 6), std::cos(M_PI / 6), 0.0);
    const bool is_lower = (moved - as_lower).norm() < kOneOfTwo_mm;
    EXPECT_TRUE(is_lower || (moved - as_upper).norm() < kOneOfTwo_mm);
    ++(is_lower ? lower : upper);
  }
  EXPECT_GT(lower, kMinOnALobe);
  EXPECT_GT(upper, kMinOnALobe);

  const cv::Mat depth = simulator.Render(0).depth;
  int rows_with_step = 0;
  for (int y = 0; y < depth.rows; ++y) {
    double largest = 0;
    for (int x = 0; x + 1 < depth.cols; ++x)
      largest = std::max(largest, std::abs(static_cast<double>(depth.at<float>(y, x + 1) - depth.at<float>(y, x))));
    rows_with_step += largest > 5.0;
  }
  EXPECT_GT(rows_with_step, kHalfOfTheRows);
}

TEST(Paths, ALoopEndsWhereItBeganAndGoesOutAndAside) {
  for (const SceneKind scene : {SceneKind::kColon, SceneKind::kSurface}) {
    SimulationOptions options = Scene(scene, TrajectoryKind::kLoop, 41);
    options.trajectory.loop_length_mm = 20;
    options.trajectory.loop_width_mm = 4;
    Simulator simulator = Make(options);
    const Rigid3 first = simulator.WorldFromCamera(0);
    const Rigid3 last = simulator.WorldFromCamera(40);
    EXPECT_LT((first.translation - last.translation).norm(), kLengthRoundOff_mm);
    EXPECT_LT(RotationAngle(first.rotation.conjugate() * last.rotation), kAngleRoundOff_rad);
    EXPECT_NEAR((simulator.WorldFromCamera(20).translation - first.translation).norm(), 20.0, kTremor_mm);
    EXPECT_NEAR((simulator.WorldFromCamera(10).translation - simulator.WorldFromCamera(30).translation).norm(), 8.0,
                kTremor_mm);
    double longest_step = 0;
    for (int i = 0; i < 40; ++i)
      longest_step =
          std::max(longest_step,
                   (simulator.WorldFromCamera(i + 1).translation - simulator.WorldFromCamera(i).translation).norm());
    EXPECT_LT(longest_step, kNoJump_mm);
  }
}

TEST(Paths, ACameraThatFliesOffTheWayOfTheTubeIsRefused) {
  SimulationOptions options = Scene(SceneKind::kColon, TrajectoryKind::kLoop, 30);
  options.trajectory.loop_width_mm = 40;
  const std::string message = Simulator::Create(options).status().message();
  EXPECT_THAT(message, HasSubstr("the camera of frame "));
  options = Scene(SceneKind::kSurface, TrajectoryKind::kInsert, 30);
  options.trajectory.start_pose = "0,30,30,-0.70710678,0,0,0.70710678";  // looks along +y, down
  options.trajectory.speed_mm_s = 60;
  EXPECT_THAT(Simulator::Create(options).status().message(), HasSubstr("from the wall"));
  options.trajectory.speed_mm_s = 1000;
  options.trajectory.fps = 1;  // through the sheet between two frames
  EXPECT_THAT(Simulator::Create(options).status().message(),
              HasSubstr("the camera of frame 0 passes through the wall on its way to the next frame"));
  options.trajectory.start_pose = "0,120,30,0.70710678,0,0,0.70710678";  // below the sheet, looks up
  options.trajectory.speed_mm_s = 0;
  EXPECT_THAT(Simulator::Create(options).status().message(), HasSubstr("sees the wall from outside"));
  options.trajectory.start_pose = "0,30,30,1,1,1,1";
  EXPECT_THAT(Simulator::Create(options).status().message(), HasSubstr("Trajectory.start_pose"));
}

TEST(Paths, AWallThatSweepsOverACameraIsSeen) {
  SimulationOptions options = Scene(SceneKind::kSurface, TrajectoryKind::kHold, 4);
  options.trajectory.start_pose = "0,50,30,-0.70710678,0,0,0.70710678";
  options.trajectory.tremor_mm = 0;
  options.trajectory.fps = 1;
  options.deformation.poke_mm = 30;  // at 1 s; the camera is 10 mm above
  options.deformation.poke_radius_mm = 60;
  options.deformation.poke_period_s = 2;
  options.deformation.poke_place = "0,60,30";
  EXPECT_THAT(Simulator::Create(options).status().message(),
              testing::AnyOf(HasSubstr("from the wall"), HasSubstr("passes through the wall")));
}

TEST(Warnings, SayWhereTheDeformationFoldsOver) {
  SimulationOptions options = Scene(SceneKind::kSurface, TrajectoryKind::kHold, 30);
  options.deformation.amplitude_mm = 5;
  options.deformation.wavelength_mm = 20;  // A k = pi / 2
  EXPECT_THAT(Make(options).warnings(), testing::ElementsAre(HasSubstr("A k = 1.57")));
  options.deformation.wavelength_mm = 200;
  EXPECT_THAT(Make(options).warnings(), testing::IsEmpty());
  // Along y the wave leaves 1 - A k = 0.05 of a length, and breathing in takes 20 mm / 100 mm more.
  options.deformation.wavelength_mm = 2.0 * M_PI * 5 / 0.95;
  EXPECT_THAT(Make(options).warnings(), testing::IsEmpty());
  options.deformation.omega_rad_s = 8;
  options.deformation.breathing_mm = 20;
  options.deformation.breathing_period_s = 1;
  EXPECT_THAT(Make(options).warnings(), testing::ElementsAre(HasSubstr("the determinant of its gradient falls to -")));
}

TEST(Warnings, SayThatLobesRunIntoEachOther) {
  SimulationOptions options = Scene(SceneKind::kLobes, TrajectoryKind::kHold, 2);
  options.deformation.amplitude_mm = 9;
  EXPECT_THAT(Make(options).warnings(), testing::ElementsAre(HasSubstr("the lobes run into each other")));
}

}  // namespace
}  // namespace pliant
