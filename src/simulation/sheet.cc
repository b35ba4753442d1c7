// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The sheet of the scenes `surface` and `lobes`, seen from above (from smaller y). Over the ground (x, z) it lies at
//   y = height + x^2 / (2 R) - hills(x, z) - relief(x, z)
// that is, it bulges towards the camera and falls away to the sides. Two lobes are one sheet with a pleat along z: the
// lower lobe runs on below the upper one to the crease, where the sheet turns, comes back as the upper lobe's underside
// and goes round its rim onto its upper side. The crease lies hidden, and there the two come apart as they move.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <tbb/parallel_for.h>

#include "pliant/base/random.h"
#include "simulation/noise.h"
#include "simulation/surface.h"

namespace pliant::simulation {
namespace {

constexpr double kFallRadiusMm = 150.0;   // R
constexpr double kSwellRadiusMm = 100.0;  // the sheet swells from a line this far below it
constexpr double kRimShare = 0.4;         // thickness of the upper lobe at its rim, by the step
constexpr double kHiddenMm = 16.0;        // of the lower lobe below the upper one

class Sheet {
 public:
  Sheet(const SimulationOptions::Scene& options, double height_mm, double length_mm)
      : options_(options), height_mm_(height_mm), length_mm_(length_mm) {
    Random random = Random(static_cast<std::uint64_t>(options.seed)).Child("sheet");
    for (std::uint32_t& seed : seeds_) seed = static_cast<std::uint32_t>(random.Next());
  }

  // The sheet over the ground; the parts have hills of their own.
  double Height(double x, double z, int part) const {
    const Eigen::Vector3d position(x, 100.0 * part, z);
    const double hills = 13.0 * GradientNoise((position / 75.0).cast<float>(), seeds_[0]) +
                         4.0 * GradientNoise((position / 30.0).cast<float>(), seeds_[1]);
    return height_mm_ + x * x / (2.0 * kFallRadiusMm) - hills - ReliefMm(position, options_.relief_mm, seeds_[2]);
  }
  // Where the upper lobe ends: a line that winds along the way.
  double RimX(double z) const {
    return 4.0 + 26.0 * GradientNoise(Eigen::Vector3f(0.5F, 0.5F, static_cast<float>(z / 90.0)), seeds_[3]) +
           7.0 * GradientNoise(Eigen::Vector3f(0.5F, 0.5F, static_cast<float>(z / 24.0)), seeds_[3] + 1);
  }
  // The upper lobe's upper side: above what lies below it by the step, with its own hills and relief further in.
  double UpperHeight(double x, double z) const {
    const double inside = std::clamp((RimX(z) - x) / 40.0, 0.0, 1.0);
    const double own = inside * inside * (3.0 - 2.0 * inside);
    return (1.0 - own) * Height(x, z, 0) + own * Height(x, z, 1) - options_.lobe_step_mm;
  }

  int Columns() const {
    const double across_mm = options_.width_mm + (options_.kind == SceneKind::kLobes ? RoundRimMm() + kHiddenMm : 0.0);
    return static_cast<int>(std::ceil(across_mm / options_.mesh_step_mm)) + 1;
  }
  int Rows() const { return static_cast<int>(std::ceil((length_mm_ + height_mm_) / options_.mesh_step_mm)) + 1; }
  double Z(int row) const { return -height_mm_ + (length_mm_ + height_mm_) * row / (Rows() - 1); }
  // Columns run towards smaller x, so that the normals point up.
  Eigen::Vector3d PositionAt(int row, double column_share) const {
    const double x = (0.5 - column_share) * options_.width_mm;
    return {x, Height(x, Z(row), 0), Z(row)};
  }

  // How many columns belong to the lower lobe.
  int LowerColumns() const { return Columns() * 9 / 20; }
  Eigen::Vector3d LobePosition(int row, int column) const {
    const double z = Z(row);
    const double half = 0.5 * options_.width_mm;
    const double rim_x = RimX(z);
    const double crease_x = rim_x - kHiddenMm;
    const int lower = LowerColumns();
    if (column < lower) {
      const double x = half + (crease_x - half) * column / (lower - 1);
      return {x, Height(x, z, 0), z};
    }
    // Along the upper lobe: the underside, half a circle, the upper side.
    const double radius = 0.5 * kRimShare * options_.lobe_step_mm;
    const double upper_mm = kHiddenMm + std::numbers::pi * radius + (rim_x + half);
    double way = upper_mm * (column - lower) / (Columns() - lower - 1);
    if (way < kHiddenMm) {
      const double x = crease_x + way;
      return {x, UpperHeight(x, z) + 2.0 * radius, z};
    }
    way -= kHiddenMm;
    if (way < std::numbers::pi * radius) {
      const double angle = way / radius;
      return {rim_x + radius * std::sin(angle), UpperHeight(rim_x, z) + radius + radius * std::cos(angle), z};
    }
    const double x = rim_x - (way - std::numbers::pi * radius);
    return {x, UpperHeight(x, z), z};
  }

 private:
  double RoundRimMm() const { return std::numbers::pi * 0.5 * kRimShare * options_.lobe_step_mm + kHiddenMm; }

  const SimulationOptions::Scene& options_;
  double height_mm_;
  double length_mm_;
  std::array<std::uint32_t, 4> seeds_{};
};

}  // namespace

double LobeGapMm(const SimulationOptions::Scene& options) { return (1.0 - kRimShare) * options.lobe_step_mm; }

Surface MakeSheet(const SimulationOptions::Scene& options, double height_mm, double length_mm) {
  const Sheet sheet(options, height_mm, length_mm);
  const bool lobes = options.kind == SceneKind::kLobes;
  const int rows = sheet.Rows();
  const int columns = sheet.Columns();
  Surface surface;
  surface.grid = SurfaceGrid{rows, columns, SurfaceGrid::Sides::kOpen, (columns - 1) * options.mesh_step_mm,
                             (rows - 1) * options.mesh_step_mm};
  const std::size_t count = static_cast<std::size_t>(rows) * columns;
  surface.vertices.resize(count);
  surface.chart.resize(count);
  surface.swell_center.resize(count);
  surface.swell_along.assign(count, Eigen::Vector3f::UnitZ());
  surface.swell_radius_mm = kSwellRadiusMm;
  if (lobes) surface.part.resize(count);
  tbb::parallel_for(0, rows, [&](int row) {
    for (int column = 0; column < columns; ++column) {
      const std::size_t idx = static_cast<std::size_t>(row) * columns + column;
      const Eigen::Vector3d position =
          lobes ? sheet.LobePosition(row, column) : sheet.PositionAt(row, static_cast<double>(column) / (columns - 1));
      surface.vertices[idx] = position.cast<float>();
      surface.chart[idx] = Eigen::Vector2d(column * options.mesh_step_mm, row * options.mesh_step_mm).cast<float>();
      surface.swell_center[idx] = Eigen::Vector3d(0.0, height_mm + kSwellRadiusMm, position.z()).cast<float>();
      if (lobes) surface.part[idx] = column < sheet.LowerColumns() ? 0 : 1;
    }
  });
  FillGrid(surface);
  return surface;
}

}  // namespace pliant::simulation
