// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "estimation/window/light_depth.h"

#include <cmath>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

namespace pliant {
namespace {

constexpr double kSameSurface = 0.01;   // of logarithms of distances: what the correction for tilt leaves
constexpr double kOtherSurface = 0.05;  // a tilted plane is no sphere: by up to some tenths

TEST(LightDepth, ATiltedSurfaceIsDarkerNotFurther) {
  // A plane at 60 degrees: brightness = cosine / distance^2, response of gamma 2.2.
  std::vector<Eigen::Vector3d> positions;
  std::vector<double> light;
  const Eigen::Vector3d normal = Eigen::Vector3d(0, std::sin(1.0), -std::cos(1.0));
  for (int k = 0; k < 100; ++k) {
    const Eigen::Vector3d ray = Eigen::Vector3d(0.06 * (k % 10) - 0.27, 0.06 * (k / 10.0) - 0.27, 1).normalized();
    positions.push_back(-50.0 / normal.dot(ray) * ray);
    light.push_back(std::log(positions.back().norm()) - 0.4 * std::log(std::abs(normal.dot(ray))));
  }
  EXPECT_LT(CompareWithLight(positions, light).error, kSameSurface);
  // A surface at the same rays that is another one does not fit.
  std::vector<Eigen::Vector3d> flat;
  for (const Eigen::Vector3d& position : positions) flat.push_back(50 * position.normalized());
  EXPECT_GT(CompareWithLight(flat, light).error, kOtherSurface);
  light.resize(10);
  positions.resize(10);
  EXPECT_EQ(CompareWithLight(positions, light).error, 0);
}

}  // namespace
}  // namespace pliant
