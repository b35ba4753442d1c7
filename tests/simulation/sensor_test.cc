// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Motion blur, drops, debris, and the second camera: what an image shows beyond the scene itself.
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pliant/simulation/simulator.h"
#include "simulation/small_scene.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using simulation_test::kChord_px;
using simulation_test::kRayDepth_mm;
using simulation_test::Make;
using simulation_test::Median;
using simulation_test::Pinhole160;
using simulation_test::SamePixels;
using simulation_test::SmallScene;

constexpr double kMeanOfImages = 0.8;  // levels: rounding gives 0.25; a mean of overexposed pixels is no pixel's mean
constexpr double kBlurMatters = 2.5;   // an instant is this much farther from the mean than the blurred image
constexpr double kStays = 0.5;         // of what covers one frame covers the next as well
constexpr double kMinBubbles = 0.002;  // shares of the image
constexpr double kMaxBubbles = 0.25;
constexpr double kMinTool = 0.05;
constexpr double kMaxTool = 0.4;
constexpr double kDefocused = 0.3;          // of the pixels change where all of the image is blurred
constexpr std::size_t kMinCompared = 5000;  // of 11,200 pixels
constexpr double kMinDisparity_px = 5.0;    // or the mirrored camera would look the same
constexpr double kSameLevel = 2.5;          // gray levels: fine texture between pixels; hidden ones are fewer than half
constexpr double kSensorChord_mm = 0.02;    // as kChord_px, at 25 mm and a focal length of about 25 px a mm
constexpr double kInverseModel_px = 1e-6;   // of the inverse model, which is iterative
constexpr std::size_t kMinRatios = 500;     // pixels that are neither dark nor bright in both images
constexpr double kResampled = 0.03;         // relative; fine texture is sampled at other points

// Gray levels that are linear in light, the same exposure in every frame, no noise.
SimulationOptions LinearScene(TrajectoryKind kind, int frames) {
  SimulationOptions options = SmallScene(kind, frames);
  options.sensor.gamma = 1.0;
  options.sensor.exposure = 0.4;
  options.sensor.exposure_time_s = 1000;
  options.sensor.gain_jitter = 0;
  options.sensor.noise_levels = 0;
  options.light.specular = 0;
  return options;
}

cv::Mat ToFloat(const cv::Mat& image) {
  cv::Mat out;
  image.convertTo(out, CV_32FC3);
  return out;
}

// Mean absolute difference in gray levels.
double Difference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(ToFloat(a), ToFloat(b), cv::NORM_L1) / static_cast<double>(3 * a.total());
}

// What a shutter of 30 ms sees is the mean of what instants within it see.
void ExpectBlurIsTheMeanOfInstants(SimulationOptions options) {
  options.sensor.samples = 16;
  options.sensor.shutter_s = 0.03;
  const SimulatedFrame blurred = Make(options).Render(3);  // at 0.1 s, from 0.085 s to 0.115 s
  options.sensor.shutter_s = 0;
  const SimulatedFrame instant = Make(options).Render(3);
  EXPECT_TRUE(SamePixels(blurred.depth, instant.depth));

  options.trajectory.fps = 800;
  options.trajectory.frames = 93;
  Simulator fine = Make(options);
  cv::Mat mean = cv::Mat::zeros(instant.image.size(), CV_32FC3);
  constexpr int kFirst = 68;  // 0.085 s
  constexpr int kLast = 92;   // 0.115 s
  for (int i = kFirst; i <= kLast; ++i) {
    const double weight = (i == kFirst || i == kLast ? 0.5 : 1.0) / (kLast - kFirst);  // the trapezium rule
    mean += weight * ToFloat(fine.Render(i).image);
  }
  EXPECT_LT(Difference(blurred.image, mean), kMeanOfImages);
  EXPECT_GT(Difference(instant.image, mean), kBlurMatters * Difference(blurred.image, mean));
}

TEST(Sensor, BlurOfAMovingCameraIsTheMeanOfInstants) {
  SimulationOptions options = LinearScene(TrajectoryKind::kInsert, 4);
  options.trajectory.speed_mm_s = 150;
  options.scene.length_mm = 250;  // the same tube for both frame rates
  ExpectBlurIsTheMeanOfInstants(options);
}

// The camera moves too, so that a motion of the wrong sign shows.
TEST(Sensor, BlurOfMovingMaterialIsTheMeanOfInstants) {
  SimulationOptions options = LinearScene(TrajectoryKind::kInsert, 4);
  options.trajectory.speed_mm_s = 100;
  options.scene.length_mm = 250;
  options.trajectory.tremor_mm = 0;
  options.trajectory.tremor_deg = 0;
  options.deformation.amplitude_mm = 8;
  options.deformation.omega_rad_s = 10;
  options.deformation.wavelength_mm = 400;
  ExpectBlurIsTheMeanOfInstants(options);
}

TEST(Sensor, RefusesAShutterThatIsOpenLongerThanAFrame) {
  SimulationOptions options = SmallScene(TrajectoryKind::kHold, 1);
  options.sensor.shutter_s = 0.05;
  EXPECT_THAT(Simulator::Create(options).status().message(), testing::HasSubstr("longer than a frame"));
}

// Pixels that differ by more than three levels.
cv::Mat Changed(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat changed(a.size(), CV_8UC1);
  for (int y = 0; y < a.rows; ++y) {
    for (int x = 0; x < a.cols; ++x) {
      const cv::Vec3i d = cv::Vec3i(a.at<cv::Vec3b>(y, x)) - cv::Vec3i(b.at<cv::Vec3b>(y, x));
      changed.at<std::uint8_t>(y, x) = std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2])}) > 3 ? 255 : 0;
    }
  }
  return changed;
}

// Something covers a part of the image, stays nearly where it was until the next frame, and is in no truth.
void ExpectCovers(double SimulationOptions::Sensor::*amount) {
  SimulationOptions options = LinearScene(TrajectoryKind::kSway, 82);
  Simulator clear = Make(options);
  options.sensor.*amount = 5;
  options.threads = 1;
  Simulator covered = Make(options);
  options.threads = 3;
  Simulator again = Make(options);
  double share = 0;
  for (const int frame_idx : {0, 40, 80}) {
    const SimulatedFrame there = covered.Render(frame_idx);
    EXPECT_TRUE(SamePixels(there.image, again.Render(frame_idx).image));
    EXPECT_TRUE(SamePixels(there.depth, clear.Render(frame_idx).depth));
    const cv::Mat now = Changed(there.image, clear.Render(frame_idx).image);
    const cv::Mat next = Changed(covered.Render(frame_idx + 1).image, clear.Render(frame_idx + 1).image);
    share += cv::countNonZero(now) / static_cast<double>(now.total()) / 3;
    EXPECT_GT(cv::countNonZero(now & next), kStays * cv::countNonZero(now)) << frame_idx;
    EXPECT_GT(cv::countNonZero(now ^ next), 0) << "nothing moves in frame " << frame_idx;
  }
  EXPECT_GT(share, kMinBubbles);
  EXPECT_LT(share, kMaxBubbles);
}

TEST(Sensor, DropsCoverPartOfTheImageAndNoTruth) { ExpectCovers(&SimulationOptions::Sensor::drops); }

TEST(Sensor, DebrisCoversPartOfTheImageAndNoTruth) { ExpectCovers(&SimulationOptions::Sensor::debris); }

// Each interruption has its time, covers what it should then and nothing otherwise, and is in no truth.
TEST(Sensor, InterruptionsComeByTheClock) {
  SimulationOptions options = LinearScene(TrajectoryKind::kSway, 31);
  Simulator clear = Make(options);
  options.interruption.blackout_period_s = 0.3;  // frames 9 to 11, 18 to 20, ...
  options.interruption.blackout_s = 0.1;
  Simulator dark = Make(options);
  options.interruption.blackout_period_s = 0;
  options.interruption.tool_period_s = 0.5;  // frames 15 to 23
  options.interruption.tool_s = 0.3;
  Simulator tool = Make(options);
  options.interruption.tool_period_s = 0;
  options.interruption.blur_period_s = 0.4;  // frames 12 to 14, ...
  options.interruption.blur_s = 0.1;
  Simulator blurred = Make(options);
  for (const int frame_idx : {0, 8, 9, 11, 12, 14, 15, 19, 23, 24}) {
    const SimulatedFrame open = clear.Render(frame_idx);
    const auto share = [&](Simulator& simulator) {
      const SimulatedFrame frame = simulator.Render(frame_idx);
      EXPECT_TRUE(SamePixels(frame.depth, open.depth)) << frame_idx;
      return cv::countNonZero(Changed(frame.image, open.image)) / static_cast<double>(open.depth.total());
    };
    const bool is_dark = frame_idx % 9 < 3 && frame_idx >= 9;
    if (is_dark)
      EXPECT_EQ(cv::norm(dark.Render(frame_idx).image, cv::NORM_INF), 0) << frame_idx;
    else
      EXPECT_EQ(share(dark), 0) << frame_idx;
    const double covered = share(tool);
    if (frame_idx == 19) {
      EXPECT_GT(covered, kMinTool);
      EXPECT_LT(covered, kMaxTool);
    } else if (frame_idx < 15 || frame_idx > 23) {
      EXPECT_EQ(covered, 0) << frame_idx;
    }
    const double sharper = share(blurred);
    if (frame_idx == 12 || frame_idx == 14 || frame_idx == 24)
      EXPECT_GT(sharper, kDefocused) << frame_idx;
    else
      EXPECT_EQ(sharper, 0) << frame_idx;
  }
}

TEST(Sensor, TheRightCameraSeesTheSceneShiftedByTheDisparity) {
  SimulationOptions options = SmallScene(TrajectoryKind::kSway, 10);
  options.camera.baseline_mm = 4.0;
  options.sensor.noise_levels = 0;
  options.light.specular = 0;  // highlights lie where light and view meet, in each image elsewhere
  options.deformation.amplitude_mm = 2.0;
  Simulator simulator = Make(options);
  const SimulatedFrame frame = simulator.Render(9);
  ASSERT_EQ(frame.right.size(), frame.image.size());
  const Pinhole160 pinhole;
  std::vector<double> differences;
  std::vector<double> differences_mirrored;  // with the right camera on the other side
  std::vector<double> disparities;
  for (int y = 4; y < 116; ++y) {
    for (int x = 30; x < 130; ++x) {
      const double z = frame.depth.at<float>(y, x);
      if (!(z > 0)) continue;
      const double disparity = pinhole.focal * 4.0 / z;
      const auto level_at = [&](double u) {
        const int left = static_cast<int>(std::floor(u));
        const double t = u - left;
        return (1 - t) * frame.right.at<cv::Vec3b>(y, left)[1] + t * frame.right.at<cv::Vec3b>(y, left + 1)[1];
      };
      const double level = frame.image.at<cv::Vec3b>(y, x)[1];
      disparities.push_back(disparity);
      differences.push_back(std::abs(level_at(x - disparity) - level));
      differences_mirrored.push_back(std::abs(level_at(x + disparity) - level));
    }
  }
  ASSERT_GT(disparities.size(), kMinCompared);
  EXPECT_GT(Median(disparities), kMinDisparity_px);
  EXPECT_LT(Median(differences), kSameLevel);
  EXPECT_GT(Median(differences_mirrored), 3 * Median(differences));
}

TEST(Sensor, MaterialLiesInTheRightImageAtTheDisparity) {
  SimulationOptions options = SmallScene(TrajectoryKind::kSway, 10);
  options.camera.baseline_mm = 4.0;
  options.deformation.amplitude_mm = 2.0;
  Simulator simulator = Make(options);
  const Pinhole160 pinhole;
  const std::vector<Eigen::Vector2d> pixels = {{40, 30}, {80.5, 100.25}, {120, 40}, {60, 90}};
  const auto hits = simulator.HitsAt(9, pixels);
  std::vector<MaterialPoint> points;
  for (const auto& hit : hits) points.push_back(hit.value().point);
  const auto right = simulator.Observe(9, points, Eye::kRight);
  const Rigid3 right_from_left =
      simulator.WorldFromCamera(9, Eye::kRight).Inverse() * simulator.WorldFromCamera(9, Eye::kLeft);
  EXPECT_LT((right_from_left.translation - Eigen::Vector3d(-4, 0, 0)).norm(), kLengthRoundOff_mm);
  int visible = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d expected(pixels[i].x() - pinhole.focal * 4.0 / hits[i]->depth_mm, pixels[i].y());
    EXPECT_LT((right[i].pixel - expected).norm(), kChord_px);
    EXPECT_NEAR(right[i].depth_mm, hits[i]->depth_mm, kRayDepth_mm);
    if (right[i].visibility != Visibility::kVisible) continue;
    ++visible;
    const auto seen = simulator.HitsAt(9, std::vector{right[i].pixel}, Eye::kRight)[0];
    EXPECT_LT((seen.value().point_in_world - hits[i]->point_in_world).norm(), kSensorChord_mm);
  }
  EXPECT_GT(visible, 0);
}

TEST(Sensor, RefusesAPairThatIsNotRectified) {
  SimulationOptions options = SmallScene(TrajectoryKind::kHold, 1);
  options.camera.baseline_mm = 4.0;
  options.camera.model = CameraModelId::kOpenCvFisheye;
  EXPECT_THAT(Simulator::Create(options).status().message(), testing::HasSubstr("rectified"));
}

// The models' formulas once more: OpenCV's, for a point in the camera frame.
Eigen::Vector2d ProjectOpenCv(const std::vector<double>& p, const Eigen::Vector3d& x) {
  const double a = x.x() / x.z();
  const double b = x.y() / x.z();
  const double r2 = a * a + b * b;
  const double radial = 1 + p[4] * r2 + p[5] * r2 * r2;
  return {p[0] * (a * radial + 2 * p[6] * a * b + p[7] * (r2 + 2 * a * a)) + p[2],
          p[1] * (b * radial + p[6] * (r2 + 2 * b * b) + 2 * p[7] * a * b) + p[3]};
}

Eigen::Vector2d ProjectFisheye(const std::vector<double>& p, const Eigen::Vector3d& x) {
  const double r = std::hypot(x.x(), x.y());
  const double t = std::atan2(r, x.z());
  const double t2 = t * t;
  const double d = t * (1 + t2 * (p[4] + t2 * (p[5] + t2 * (p[6] + t2 * p[7]))));
  return {p[0] * d * x.x() / r + p[2], p[1] * d * x.y() / r + p[3]};
}

// Truth, depth and image of a camera model against its formula and a pinhole at the same position.
template <class Project>
void ExpectModelIsRendered(SimulationOptions options, CameraModelId model, const std::vector<double>& params,
                           const Project& project) {
  options.sensor.noise_levels = 0;
  options.sensor.vignetting = 0;
  options.sensor.gain_jitter = 0;
  const SimulatedFrame straight = Make(options).Render(1);
  options.camera.model = model;
  for (const double p : params) options.camera.params += (options.camera.params.empty() ? "" : ",") + FormatDouble(p);
  Simulator simulator = Make(options);
  const SimulatedFrame frame = simulator.Render(1);
  const Rigid3 cam_from_world = simulator.WorldFromCamera(1).Inverse();

  std::vector<Eigen::Vector2d> pixels;
  for (int y = 3; y < 120; y += 12)
    for (int x = 3; x < 160; x += 12) pixels.emplace_back(x, y);
  const auto hits = simulator.HitsAt(1, pixels);
  std::size_t compared = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!hits[i]) continue;
    ++compared;
    const Eigen::Vector3d in_cam = cam_from_world * hits[i]->point_in_world;
    EXPECT_LT((project(params, in_cam) - pixels[i]).norm(), kInverseModel_px);
    EXPECT_NEAR(hits[i]->depth_mm, in_cam.z(), kLengthRoundOff_mm);
    const double depth = frame.depth.at<float>(static_cast<int>(pixels[i].y()), static_cast<int>(pixels[i].x()));
    EXPECT_NEAR(depth, in_cam.z(), kRayDepth_mm);
  }
  EXPECT_GT(compared, pixels.size() / 2);

  // The same position has the same look in both images, up to the exposure that each chose.
  const Pinhole160 pinhole;
  std::vector<double> ratios;
  for (int y = 20; y < 100; y += 2) {
    for (int x = 20; x < 140; x += 2) {
      const double z = straight.depth.at<float>(y, x);
      const Eigen::Vector2d pixel = project(params, pinhole.BackProject(x, y, z));
      const auto there = simulation_test::SmoothLevel(frame.image, pixel);
      const int here = straight.image.at<cv::Vec3b>(y, x)[1];
      if (there && here > 20 && here < 230) ratios.push_back(*there / here);
    }
  }
  ASSERT_GT(ratios.size(), kMinRatios);
  const double exposure = Median(ratios);
  for (double& ratio : ratios) ratio = std::abs(ratio / exposure - 1);
  EXPECT_LT(Median(ratios), kResampled);
}

TEST(Sensor, AnOpenCvCameraIsRenderedByItsFormula) {
  const std::vector<double> params = {112, 114, 80.5, 58, -0.2, 0.05, 0.003, -0.002};
  ExpectModelIsRendered(SmallScene(TrajectoryKind::kHold, 2), CameraModelId::kOpenCv, params, ProjectOpenCv);
}

TEST(Sensor, AFisheyeIsRenderedByItsFormula) {
  const std::vector<double> params = {70, 71, 80.5, 58, -0.03, 0.004, -0.001, 0.0002};
  ExpectModelIsRendered(SmallScene(TrajectoryKind::kHold, 2), CameraModelId::kOpenCvFisheye, params, ProjectFisheye);
}

}  // namespace
}  // namespace pliant
