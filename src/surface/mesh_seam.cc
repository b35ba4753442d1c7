// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "surface/mesh_seam.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace pliant {
namespace {

constexpr double kMinArea = 0.05;  // of a triangle in the image, in cells of the raster

// Twice the area, positive where the corners turn from x to y.
double TurnOf(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (c.x() - a.x()) * (b.y() - a.y());
}

}  // namespace

bool DirectedEdges::ContainsAnyOf(const Triangle& triangle) const {
  return Contains(triangle[0], triangle[1]) || Contains(triangle[1], triangle[2]) || Contains(triangle[2], triangle[0]);
}

void DirectedEdges::Add(const Triangle& triangle) {
  for (std::size_t k = 0; k < 3; ++k) edges_.insert(KeyOf(triangle[k], triangle[(k + 1) % 3]));
}

MeshSeam::MeshSeam(const PlacedMesh& placed, std::span<const Triangle> triangles, const std::vector<bool>& counts,
                   double largest_step)
    : step_px_(placed.step_px),
      columns_(placed.raster.depth.cols),
      rows_(placed.raster.depth.rows),
      largest_step_(largest_step),
      border_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)),
      covering_of_(border_.size()) {
  const auto is_there = [&](const Triangle& triangle) {
    return std::ranges::all_of(triangle, [&](std::int32_t v) { return counts[static_cast<std::size_t>(v)]; });
  };
  for (const Triangle& triangle : triangles) {
    if (!is_there(triangle)) continue;
    edges_.Add(triangle);
    Corners corners;
    bool in_image = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(triangle[k]);
      in_image = in_image && placed.pixels[v] && placed.depths[v] > 0.0;
      if (in_image) corners[k] = {*placed.pixels[v], 1.0 / placed.depths[v]};
    }
    if (in_image) Cover(corners);
  }
  std::vector<bool> is_at_border(counts.size(), false);
  for (const Triangle& triangle : triangles) {
    if (!is_there(triangle)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t from = triangle[k];
      const std::int32_t to = triangle[(k + 1) % 3];
      if (edges_.Contains(to, from)) continue;
      is_at_border[static_cast<std::size_t>(from)] = true;
      is_at_border[static_cast<std::size_t>(to)] = true;
    }
  }
  for (std::size_t v = 0; v < is_at_border.size(); ++v) {
    if (!is_at_border[v] || !placed.pixels[v] || !(placed.depths[v] > 0.0)) continue;
    const Eigen::Vector2d node = *placed.pixels[v] / step_px_;
    if (node.x() < -0.5 || node.y() < -0.5 || node.x() >= columns_ - 0.5 || node.y() >= rows_ - 0.5) continue;
    border_[CellOf(*placed.pixels[v])].push_back(static_cast<std::int32_t>(v));
  }
}

std::size_t MeshSeam::CellOf(const Eigen::Vector2d& pixel) const {
  const int column = std::clamp(static_cast<int>(std::lround(pixel.x() / step_px_)), 0, columns_ - 1);
  const int row = std::clamp(static_cast<int>(std::lround(pixel.y() / step_px_)), 0, rows_ - 1);
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
}

void MeshSeam::Cover(const Corners& corners) {
  Eigen::Vector2d least = corners[0].pixel;
  Eigen::Vector2d largest = least;
  for (const Corner& corner : corners) {
    least = least.cwiseMin(corner.pixel);
    largest = largest.cwiseMax(corner.pixel);
  }
  const Eigen::Vector2d last(columns_ - 1, rows_ - 1);
  least /= step_px_;
  largest /= step_px_;
  if (largest.x() < -0.5 || largest.y() < -0.5 || least.x() > last.x() + 0.5 || least.y() > last.y() + 0.5) return;
  const Eigen::Vector2i first = least.cwiseMax(0.0).cwiseMin(last).array().round().cast<int>();
  const Eigen::Vector2i end = largest.cwiseMax(0.0).cwiseMin(last).array().round().cast<int>();
  for (int row = first.y(); row <= end.y(); ++row)
    for (int column = first.x(); column <= end.x(); ++column)
      covering_of_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                   static_cast<std::size_t>(column)]
          .push_back(covering_.size());
  covering_.push_back(corners);
}

// Whether a triangle of the same surface lies there.
bool MeshSeam::Covers(const Eigen::Vector2d& pixel, double inverse_depth) const {
  return std::ranges::any_of(covering_of_[CellOf(pixel)], [&](std::size_t t) {
    const auto& [a, b, c] = covering_[t];
    const double area = TurnOf(a.pixel, b.pixel, c.pixel);
    const double of_a = TurnOf(pixel, b.pixel, c.pixel) / area;
    const double of_b = TurnOf(a.pixel, pixel, c.pixel) / area;
    const double of_c = 1.0 - of_a - of_b;
    if (!(of_a > 0.0 && of_b > 0.0 && of_c > 0.0)) return false;
    const double there = of_a * a.inverse_depth + of_b * b.inverse_depth + of_c * c.inverse_depth;
    return std::abs(there - inverse_depth) <= largest_step_ * inverse_depth;
  });
}

std::vector<std::int32_t> MeshSeam::BorderAround(int column, int row, int reach) const {
  std::vector<std::int32_t> vertices;
  for (int y = std::max(0, row - reach); y <= std::min(rows_ - 1, row + reach); ++y)
    for (int x = std::max(0, column - reach); x <= std::min(columns_ - 1, column + reach); ++x) {
      const auto& here =
          border_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x)];
      vertices.insert(vertices.end(), here.begin(), here.end());
    }
  return vertices;
}

bool MeshSeam::Take(const Triangle& triangle, const PlacedMesh& placed) {
  if (edges_.ContainsAnyOf(triangle)) return false;
  Corners corners;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto v = static_cast<std::size_t>(triangle[k]);
    if (!placed.pixels[v] || !(placed.depths[v] > 0.0)) return false;
    corners[k] = {*placed.pixels[v], 1.0 / placed.depths[v]};
  }
  // The grid's triangles turn from y to x.
  if (TurnOf(corners[0].pixel, corners[1].pixel, corners[2].pixel) > -2.0 * kMinArea * step_px_ * step_px_)
    return false;
  const auto covered_at = [&](double of_a, double of_b, double of_c) {
    return Covers(of_a * corners[0].pixel + of_b * corners[1].pixel + of_c * corners[2].pixel,
                  of_a * corners[0].inverse_depth + of_b * corners[1].inverse_depth + of_c * corners[2].inverse_depth);
  };
  constexpr double kFar = 1.0 / 6;
  constexpr double kNear = 2.0 / 3;
  if (covered_at(1.0 / 3, 1.0 / 3, 1.0 / 3) || covered_at(kNear, kFar, kFar) || covered_at(kFar, kNear, kFar) ||
      covered_at(kFar, kFar, kNear))
    return false;
  edges_.Add(triangle);
  Cover(corners);
  return true;
}

}  // namespace pliant
