// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/surface/mesh_raster.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pliant {
namespace {

constexpr double kOnEdge = 1e-3;  // px, and of a triangle: what rounding puts outside of it

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// Corners in pixels of the raster, and their inverse depths, which are linear in the image.
struct RasterCorners {
  std::array<Eigen::Vector2d, 3> at;
  std::array<double, 3> inverse_depth;
};

void Draw(const RasterCorners& corners, std::int32_t index, MeshRaster* raster) {
  const auto& [a, b, c] = corners.at;
  const double area = Cross(b - a, c - a);
  if (!(std::abs(area) > 0.0)) return;
  const Eigen::Vector2d least = a.cwiseMin(b).cwiseMin(c).array() - kOnEdge;
  const Eigen::Vector2d largest = a.cwiseMax(b).cwiseMax(c).array() + kOnEdge;
  const int left = std::max(0, static_cast<int>(std::ceil(std::max(-1.0, least.x()))));
  const int top = std::max(0, static_cast<int>(std::ceil(std::max(-1.0, least.y()))));
  const int right = static_cast<int>(std::floor(std::min(largest.x(), raster->depth.cols - 1.0)));
  const int bottom = static_cast<int>(std::floor(std::min(largest.y(), raster->depth.rows - 1.0)));
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) {
      const Eigen::Vector2d p(x, y);
      const double of_a = Cross(b - p, c - p) / area;
      const double of_b = Cross(c - p, a - p) / area;
      const double of_c = 1.0 - of_a - of_b;
      if (of_a < -kOnEdge || of_b < -kOnEdge || of_c < -kOnEdge) continue;
      const double inverse =
          of_a * corners.inverse_depth[0] + of_b * corners.inverse_depth[1] + of_c * corners.inverse_depth[2];
      const auto depth = static_cast<float>(1.0 / inverse);
      float& nearest = raster->depth.at<float>(y, x);
      if (nearest > 0.0F && nearest <= depth) continue;
      nearest = depth;
      raster->triangle.at<std::int32_t>(y, x) = index;
    }
}

}  // namespace

MeshRaster RasterizeMesh(std::span<const std::optional<Eigen::Vector2d>> pixels, std::span<const double> depths,
                         std::span<const std::array<std::int32_t, 3>> triangles, cv::Size size, double step) {
  MeshRaster raster{cv::Mat(size, CV_32F, cv::Scalar(0)), cv::Mat(size, CV_32S, cv::Scalar(kNoTriangle))};
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    RasterCorners corners;
    bool is_seen = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(triangles[t][k]);
      is_seen = is_seen && pixels[v] && depths[v] > 0.0;
      if (!is_seen) break;
      corners.at[k] = *pixels[v] / step;
      corners.inverse_depth[k] = 1.0 / depths[v];
    }
    if (is_seen) Draw(corners, static_cast<std::int32_t>(t), &raster);
  }
  return raster;
}

}  // namespace pliant
