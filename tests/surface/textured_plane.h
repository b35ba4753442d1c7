// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A slanted plane whose material slides within it, so that its images move while its depth does not, before a camera
// that moves sideways: images, points and truth by formulas alone.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "pliant/base/random.h"
#include "pliant/surface/dense_depth.h"

namespace pliant::test {

struct TexturedPlane {
  double slide_mm = 4;         // of the material along y, from one view to the next, at most
  double baseline_mm = 2;      // from one view to the next
  double noise_levels = 0;     // of the images
  double texture_levels = 40;  // amplitude; the right quarter of the plane has none

  static constexpr int kWidth = 320;
  static constexpr int kHeight = 240;
  static constexpr double kFlatFrom_mm = 14;  // along x

  Camera camera =
      Camera::Create(CameraModelId::kPinhole, kWidth, kHeight, std::array{300.0, 300.0, 159.5, 119.5}).value();

  double Slide(double x, int view) const { return slide_mm * view * std::sin(x / 12.0); }
  Rigid3 Pose(int view) const {
    return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(-baseline_mm * view, -0.2 * baseline_mm * view, 0.0)};
  }

  // Where a pixel's ray meets the plane z = 50 + 0.3 x, world frame.
  Eigen::Vector3d PointOn(double u, double v, int view) const {
    const Eigen::Vector3d center = Pose(view).OriginInSource();
    const Eigen::Vector3d ray((u - 159.5) / 300.0, (v - 119.5) / 300.0, 1.0);
    const double depth = (50.0 + 0.3 * center.x()) / (1.0 - 0.3 * ray.x());
    return center + depth * ray;
  }

  double TextureAt(double x, double y) const {
    if (x > kFlatFrom_mm) return 0.0;
    return std::sin(1.9 * x + 0.7 * y) + std::sin(-1.1 * x + 2.3 * y + 1.0) + std::sin(2.9 * x - 1.7 * y + 2.0) +
           std::sin(0.5 * x + 3.1 * y) * std::cos(3.3 * x);
  }

  cv::Mat Image(int view) const {
    Random random(static_cast<std::uint64_t>(view + 100));
    cv::Mat image(kHeight, kWidth, CV_8U);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const Eigen::Vector3d at = PointOn(x, y, view);
        const double level = 120.0 + texture_levels * TextureAt(at.x(), at.y() - Slide(at.x(), view));
        image.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(level + noise_levels * random.Normal());
      }
    return image;
  }

  // Points of a grid of pixels of view 0, where the material has them in the view.
  std::vector<PointObservation> Points(int view) const {
    std::vector<PointObservation> points;
    for (int v = 8; v < kHeight; v += 24)
      for (int u = 8; u < kWidth; u += 24) {
        Eigen::Vector3d at = PointOn(u, v, 0);
        at.y() += Slide(at.x(), view);
        PointObservation point{PointId{v * kWidth + u}, {}, at, 1.0};
        point.sigma = 0.05;
        const auto pixel = camera.Project(Pose(view) * at);
        if (!pixel || !camera.Contains(*pixel)) continue;
        point.pixel = *pixel;
        points.push_back(point);
      }
    return points;
  }

  SurfaceView View(int view) const {
    return {Image(view), cv::Mat(kHeight, kWidth, CV_8U, cv::Scalar(255)), Pose(view), Points(view)};
  }
  std::vector<SurfaceView> Neighbors() const { return {View(-2), View(-1), View(1), View(2)}; }
};

}  // namespace pliant::test
