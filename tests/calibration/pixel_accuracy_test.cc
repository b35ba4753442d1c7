// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "calibration/pixel_accuracy.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace pliant {
namespace {

constexpr double kRounding = 1e-9;

// As if the points determined one parameter only, and the views another.
ParamsCovariance CovarianceOf(Eigen::Index size, Eigen::Index of_points, double sigma, Eigen::Index of_views,
                              double views_sigma) {
  ParamsCovariance covariance{Eigen::MatrixXd::Zero(size, size), Eigen::MatrixXd::Zero(size, size)};
  covariance.of_points(of_points, of_points) = sigma * sigma;
  covariance.of_views(of_views, of_views) = views_sigma * views_sigma;
  return covariance;
}

TEST(PixelAccuracy, GrowsWithTheDistanceFromTheCenterByTheFocalLength) {
  const Camera camera = Camera::Create("SIMPLE_PINHOLE", 641, 481, std::vector<double>{500, 320, 240}).value();
  const ParamsCovariance covariance = CovarianceOf(3, 0, 2.0, 1, 0.5);
  const auto sigma_at = [&](const Eigen::Vector2d& pixel) {
    return PixelSigma(ProjectByParams(camera, *camera.Unproject(pixel)).value(), covariance);
  };
  EXPECT_NEAR(sigma_at({0, 0}), 2.0 * 400 / 500, kRounding);  // 400 px from the center
  EXPECT_NEAR(sigma_at({320, 240}), 0.5, kRounding);          // that of the center itself
  EXPECT_EQ(covariance.Sigmas(), (std::vector<double>{2.0, 0.5, 0.0}));
}

TEST(PixelAccuracy, KnowsTheDerivativesOfEveryModel) {
  const std::vector<std::pair<std::string, std::vector<double>>> cameras = {
      {"SIMPLE_PINHOLE", {520, 321, 238}},
      {"PINHOLE", {900, 880, 310, 251}},
      {"SIMPLE_RADIAL", {480, 330, 236, -0.15}},
      {"RADIAL", {450, 315, 244, -0.28, 0.07}},
      {"OPENCV", {470, 465, 325, 231, -0.25, 0.06, 0.001, -0.0008}},
      {"OPENCV_FISHEYE", {260, 262, 322, 243, -0.02, 0.004, -0.001, 0.0002}}};
  const Eigen::Vector3d ray(0.3, -0.2, 1);
  for (const auto& [model, params] : cameras) {
    const Camera camera = Camera::Create(model, 640, 480, params).value();
    const PixelByParams by_params = ProjectByParams(camera, ray).value();
    EXPECT_LT((by_params.pixel - *camera.Project(ray)).norm(), kRounding) << model;
    for (std::size_t i = 0; i < params.size(); ++i) {
      constexpr double kStep = 1e-6;
      std::vector<double> changed = params;
      changed[i] += kStep;
      const Eigen::Vector2d pixel = *Camera::Create(model, 640, 480, changed).value().Project(ray);
      // Linear up to a step's share of the second derivatives.
      EXPECT_LT(((pixel - by_params.pixel) / kStep - by_params.jacobian.col(static_cast<Eigen::Index>(i))).norm(), 1e-2)
          << model << " " << i;
    }
  }
}

TEST(PixelAccuracy, ComparesCamerasWhereOneSeesNoRay) {
  // The first one folds over before the corner.
  const Camera first = Camera::Create("SIMPLE_RADIAL", 480, 360, std::vector<double>{330, 243, 176, -0.19}).value();
  const Camera second = Camera::Create("RADIAL", 480, 360, std::vector<double>{330, 243, 176, -0.2, 0.03}).value();
  ASSERT_FALSE(first.Unproject({0, 0}));
  const auto gap = GapAt({0, 0}, first, second, CovarianceOf(5, 0, 1, 0, 1));
  ASSERT_TRUE(gap);
  EXPECT_GT(gap->px, 5);
  EXPECT_EQ(BorderPixels(480, 360).size(), 8u);
}

}  // namespace
}  // namespace pliant
