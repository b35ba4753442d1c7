// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/ray_table.h"

#include <cmath>

namespace pliant::simulation {

RayTable::RayTable(const Camera& camera, int samples)
    : samples_per_side_(static_cast<int>(std::sqrt(static_cast<double>(samples)))), width_(camera.width()) {
  // A grid turned by the angle of tangent 1/2: no two samples share a row or a column, so steep edges get all steps.
  const int n = samples_per_side_;
  std::vector<Eigen::Vector2d> offsets;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double a = (i + 0.5) / n - 0.5;
      const double b = (j + 0.5) / n - 0.5;
      offsets.emplace_back(n == 1 ? 0.0 : a + b / n, n == 1 ? 0.0 : b - a / n);
    }
  }
  offsets.emplace_back(0.0, 0.0);
  std::vector<Eigen::Vector2d> pixels(static_cast<std::size_t>(width_) * offsets.size());
  rays_.reserve(pixels.size() * camera.height());
  for (int y = 0; y < camera.height(); ++y) {
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const std::size_t x = i / offsets.size();
      pixels[i] = Eigen::Vector2d(static_cast<double>(x), y) + offsets[i % offsets.size()];
    }
    for (const auto& ray : camera.Unproject(pixels))
      rays_.push_back(ray ? Eigen::Vector3f(ray->cast<float>()) : Eigen::Vector3f(Eigen::Vector3f::Zero()));
  }
}

std::span<const Eigen::Vector3f> RayTable::Row(int y) const {
  const std::size_t row = static_cast<std::size_t>(width_) * rays_per_pixel();
  return std::span(rays_).subspan(y * row, row);
}

Eigen::Vector3d RayTable::Center(int x, int y) const {
  return Row(y)[static_cast<std::size_t>(x + 1) * rays_per_pixel() - 1].cast<double>();
}

}  // namespace pliant::simulation
