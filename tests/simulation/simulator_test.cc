// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/simulation/simulator.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "simulation/small_scene.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using simulation_test::ExpectSameBytesOnFourThreads;
using simulation_test::kChord_px;
using simulation_test::kMinSeen;
using simulation_test::kMinWarped;
using simulation_test::kRayDepth_mm;
using simulation_test::Make;
using simulation_test::Median;
using simulation_test::Pinhole160;
using simulation_test::SamePixels;
using simulation_test::SmallScene;
using simulation_test::SmoothDepth;
using simulation_test::WarpErrors;

constexpr double kInterpolation_mm = 0.03;  // of depth between pixels 0.5 mm apart on a curved, uneven wall
constexpr double kChord_mm = 1e-3;  // a hit lies on the moved triangle, the material on a wave: the chord over 0.8 mm
constexpr double kMoved_mm = 4.0;   // the amplitude, from rest to either side
constexpr double kSameMaterial_mm = 0.05;  // what is hit beside a point that is partly hidden would be millimeters away
constexpr int kMinOccluded = 10;           // a fold hides some of the grid's points
constexpr double kLight = 0.03;            // relative: half a gray level of 60 is 2 % of linear light
constexpr double kNoiseLevels = 0.15;      // 10,000 samples fix a deviation of 4 to 1 %; rounding to levels adds 1 %
constexpr int kLit = 20;                   // gray levels
constexpr float kAhead_mm = 20.0F;         // the tube goes on ahead

TEST(Simulator, DepthAndPosesOfARigidSceneAgree) {
  for (const TrajectoryKind kind : {TrajectoryKind::kInsert, TrajectoryKind::kSway}) {
    Simulator simulator = Make(SmallScene(kind, 20));
    const std::vector<double> errors = WarpErrors(simulator, 0, 19);
    EXPECT_GT(errors.size(), kMinWarped);
    EXPECT_LT(Median(errors), kInterpolation_mm) << EnumName(kind);
  }
}

TEST(Simulator, MaterialPointsFollowTheFormulaAndAreSeenAtTheirDepth) {
  SimulationOptions options = SmallScene(TrajectoryKind::kHold, 40);
  options.deformation.amplitude_mm = 4.0;
  options.deformation.omega_rad_s = 5.0;
  options.deformation.wavelength_mm = 300.0;
  Simulator simulator = Make(options);
  const Pinhole160 pinhole;
  std::vector<Eigen::Vector2d> pixels;
  for (int y = 6; y < 120; y += 9)
    for (int x = 6; x < 160; x += 9) pixels.emplace_back(x, y);
  const auto hits = simulator.HitsAt(0, pixels);
  const int later = 25;
  const cv::Mat depth = simulator.Render(later).depth;
  const Rigid3 cam_from_world = simulator.WorldFromCamera(later).Inverse();
  std::vector<double> depth_errors;
  double largest_motion = 0;
  for (const auto& hit : hits) {
    if (!hit) continue;
    const Eigen::Vector3d rest = simulator.RestPosition(hit->point);
    const auto formula = [&](double t) {
      return Eigen::Vector3d(rest.x(), rest.y() + 4.0 * std::sin(5.0 * t + 2.0 * M_PI / 300.0 * rest.sum()), rest.z());
    };
    EXPECT_LT((formula(0.0) - hit->point_in_world).norm(), kChord_mm);
    EXPECT_LT((formula(later / 30.0) - simulator.Position(hit->point, later)).norm(), kLengthRoundOff_mm);
    largest_motion = std::max(largest_motion, (formula(later / 30.0) - formula(0.0)).norm());
    const Eigen::Vector3d in_cam = cam_from_world * formula(later / 30.0);
    const auto seen = SmoothDepth(depth, pinhole.Project(in_cam), 1.0);
    if (seen && std::abs(*seen - in_cam.z()) < 1.5) depth_errors.push_back(std::abs(*seen - in_cam.z()));
  }
  EXPECT_GT(largest_motion, kMoved_mm);
  ASSERT_GT(depth_errors.size(), kMinSeen);
  EXPECT_LT(Median(depth_errors), kInterpolation_mm);
}

TEST(Simulator, ObservesMaterialPointsWhereItHitThem) {
  SimulationOptions options = SmallScene(TrajectoryKind::kSway, 30);
  options.deformation.amplitude_mm = 3.0;
  Simulator simulator = Make(options);
  const std::vector<Eigen::Vector2d> pixels = {{20, 20}, {80.5, 100.25}, {140, 30}, {30, 90}};
  const auto hits = simulator.HitsAt(7, pixels);
  std::vector<MaterialPoint> points;
  for (const auto& hit : hits) points.push_back(hit.value().point);
  const auto seen = simulator.Observe(7, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(seen[i].visibility, Visibility::kVisible);
    EXPECT_LT((seen[i].pixel - pixels[i]).norm(), kChord_px);
    EXPECT_NEAR(seen[i].depth_mm, hits[i]->depth_mm, kRayDepth_mm);
  }
  // Later on some pixels show other material; a point that is called visible must be what the camera hits there.
  int visible = 0;
  for (const MaterialObservation& later : simulator.Observe(29, points)) {
    if (later.visibility != Visibility::kVisible) continue;
    ++visible;
    const auto hit = simulator.HitsAt(29, std::vector{later.pixel})[0];
    ASSERT_TRUE(hit);
    EXPECT_LT((hit->point_in_world - later.point_in_world).norm(), kSameMaterial_mm);
  }
  EXPECT_GT(visible, 0);
}

TEST(Simulator, PointsBehindAFoldAreOccluded) {
  Simulator simulator = Make(SmallScene(TrajectoryKind::kInsert, 61));
  std::vector<Eigen::Vector2d> pixels;
  for (int y = 10; y < 110; y += 4)
    for (int x = 10; x < 150; x += 4) pixels.emplace_back(x, y);
  std::vector<MaterialPoint> points;
  for (const auto& hit : simulator.HitsAt(60, pixels))
    if (hit) points.push_back(hit->point);
  int occluded = 0;
  const auto seen = simulator.Observe(0, points);
  for (const MaterialObservation& point : seen) {
    if (point.visibility != Visibility::kOccluded) continue;
    ++occluded;
    const auto hit = simulator.HitsAt(0, std::vector{point.pixel})[0];
    EXPECT_LT(hit.value().depth_mm, point.depth_mm);
  }
  EXPECT_GT(occluded, kMinOccluded);
}

TEST(Simulator, GivesTheSameBytesForAnyNumberOfThreads) {
  SimulationOptions options = SmallScene(TrajectoryKind::kInsert, 4);
  options.deformation.amplitude_mm = 2.0;
  ExpectSameBytesOnFourThreads(options, {3, 0});
}

TEST(Simulator, AFrameDoesNotDependOnTheOrderOfRendering) {
  SimulationOptions options = SmallScene(TrajectoryKind::kSway, 6);
  options.deformation.amplitude_mm = 2.0;
  Simulator simulator = Make(options);
  const SimulatedFrame first = simulator.Render(5);
  simulator.Render(1);
  const SimulatedFrame again = simulator.Render(5);
  EXPECT_TRUE(SamePixels(first.image, again.image));
  EXPECT_TRUE(SamePixels(first.depth, again.depth));
}

TEST(Simulator, TheSeedChangesTheScene) {
  SimulationOptions options = SmallScene(TrajectoryKind::kHold, 1);
  const SimulatedFrame one = Make(options).Render(0);
  options.scene.seed = 2;
  const SimulatedFrame two = Make(options).Render(0);
  EXPECT_FALSE(SamePixels(one.image, two.image));
  EXPECT_FALSE(SamePixels(one.depth, two.depth));
}

TEST(Simulator, LightFallsWithTheSquareOfTheDistance) {
  SimulationOptions options = SmallScene(TrajectoryKind::kHold, 1);
  options.scene.kind = SceneKind::kTube;
  options.scene.bend_deg_per_cm = 0;
  options.texture.contrast = 0;
  options.light.specular = 0;
  options.light.ambient = 0;
  options.sensor.noise_levels = 0;
  options.sensor.vignetting = 0;
  options.sensor.blur_px = 0;
  options.trajectory.tremor_mm = 0;
  options.trajectory.tremor_deg = 0;
  Simulator simulator = Make(options);
  const SimulatedFrame frame = simulator.Render(0);
  // On the axis of a straight round tube a wall at distance d is met at cosine radius / d: level^gamma ~ 1 / d^3.
  const Pinhole160 pinhole;
  const auto light_times_cube = [&](int x) {
    const double distance = pinhole.BackProject(x, 60, frame.depth.at<float>(60, x)).norm();
    return std::pow(frame.image.at<cv::Vec3b>(60, x)[2] / 255.0, 2.2) * distance * distance * distance;
  };
  EXPECT_NEAR(light_times_cube(28) / light_times_cube(45), 1.0, kLight);
}

TEST(Simulator, NoiseHasTheDeviationAskedFor) {
  SimulationOptions options = SmallScene(TrajectoryKind::kHold, 1);
  options.sensor.noise_levels = 0;
  const cv::Mat clean = Make(options).Render(0).image;
  options.sensor.noise_levels = 4.0;
  const cv::Mat noisy = Make(options).Render(0).image;
  std::vector<double> differences;
  for (int y = 0; y < clean.rows; ++y)
    for (int x = 0; x < clean.cols; ++x)
      if (const int level = clean.at<cv::Vec3b>(y, x)[1]; level > 20 && level < 230)
        differences.push_back(noisy.at<cv::Vec3b>(y, x)[1] - level);
  const double mean = std::accumulate(differences.begin(), differences.end(), 0.0) / differences.size();
  double power = 0;
  for (const double d : differences) power += (d - mean) * (d - mean);
  EXPECT_NEAR(std::sqrt(power / differences.size()), 4.0, kNoiseLevels);
  EXPECT_NEAR(mean, 0.0, kNoiseLevels);
}

TEST(Simulator, TextureCarriesCorners) {
  SimulationOptions options = SmallScene(TrajectoryKind::kHold, 1);
  options.camera.width = 320;
  options.camera.height = 240;
  options.texture = {};
  options.light.specular = 0;  // highlights raise the level that corners are measured by
  cv::Mat gray;
  cv::cvtColor(Make(options).Render(0).image, gray, cv::COLOR_BGR2GRAY);
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(gray, corners, 500, 0.01, 5);
  EXPECT_EQ(corners.size(), 500U);
}

TEST(Simulator, AFisheyeSeesBesideItself) {
  SimulationOptions options = SmallScene(TrajectoryKind::kHold, 1);
  options.camera.model = CameraModelId::kOpenCvFisheye;
  options.camera.horizontal_fov_deg = 200;
  options.trajectory.start_mm = 60;
  Simulator simulator = Make(options);
  const auto hits = simulator.HitsAt(0, std::vector<Eigen::Vector2d>{{1, 59.5}, {79.5, 59.5}});
  ASSERT_TRUE(hits[0] && hits[1]);
  EXPECT_LT(hits[0]->depth_mm, 0);
  const SimulatedFrame frame = simulator.Render(0);
  EXPECT_EQ(frame.depth.at<float>(60, 1), 0.0F);  // there is light, but no depth in front of the camera
  EXPECT_GT(frame.image.at<cv::Vec3b>(60, 1)[2], kLit);
  EXPECT_GT(frame.depth.at<float>(60, 80), kAhead_mm);
}

TEST(Simulator, RefusesACameraThatTouchesTheWallAndNamesTheFrame) {
  SimulationOptions options = SmallScene(TrajectoryKind::kSway, 60);
  options.trajectory.sway_amplitude_mm = 40.0;
  const Result<Simulator> simulator = Simulator::Create(options);
  ASSERT_FALSE(simulator.ok());
  EXPECT_EQ(simulator.status().code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(simulator.status().message(), testing::HasSubstr("the camera of frame "));

  options = SmallScene(TrajectoryKind::kHold, 1);
  options.trajectory.start_mm = 9000;
  options.scene.length_mm = 100;
  EXPECT_THAT(Simulator::Create(options).status().message(), testing::HasSubstr("has left the lumen"));
}

TEST(Simulator, RefusesOptionsOutOfRange) {
  SimulationOptions options = SmallScene(TrajectoryKind::kHold, 1);
  options.scene.radius_mm = -1;
  EXPECT_THAT(Simulator::Create(options).status().message(), testing::HasSubstr("Scene.radius_mm"));
  options = SmallScene(TrajectoryKind::kHold, 1);
  options.camera.params = "100,100";
  EXPECT_EQ(Simulator::Create(options).status().code(), ErrorCode::kInvalidArgument);
}

TEST(Simulator, RefusesACameraThatNoMemoryHolds) {
  SimulationOptions options = SmallScene(TrajectoryKind::kHold, 1);
  options.camera.width = 8192;
  options.camera.height = 8192;
  options.sensor.samples = 64;
  EXPECT_THAT(Simulator::Create(options).status().message(), testing::HasSubstr("8192x8192"));
}

}  // namespace
}  // namespace pliant
