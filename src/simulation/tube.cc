// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The tube of the scenes `colon` and `tube`. In the section at s along the centerline the wall stands at
//   r(s, v) = radius * section(s, v) - folds(s, v) + relief(s, v)
// v the angle around. Folds are arcs of rings: a bell along s, a half wave around, thrown slightly askew.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <tbb/parallel_for.h>

#include "pliant/base/random.h"
#include "simulation/noise.h"
#include "simulation/surface.h"

namespace pliant::simulation {
namespace {

struct Fold {
  double s_mm = 0;
  double depth_mm = 0;
  double width_mm = 0;  // of the bell along s
  double angle = 0;     // middle of the arc
  double half_arc = 0;  // beyond it there is no fold
  double skew_mm = 0;   // how far one end of the ring lies ahead of the other
  double skew_angle = 0;
};

class Wall {
 public:
  Wall(const SimulationOptions::Scene& options, double length_mm) : options_(options), length_mm_(length_mm) {
    noise_seed_ = static_cast<std::uint32_t>(Random(static_cast<std::uint64_t>(options.seed)).Child("relief").Next());
    if (options.kind == SceneKind::kColon) DrawFolds();
  }

  double Radius(double s, double v) const {
    double r = options_.radius_mm;
    if (options_.kind == SceneKind::kColon) {
      // Three bands of muscle run along the colon and make its section three-cornered.
      r *= 1.0 + 0.05 * std::cos(3.0 * (v - 0.004 * s));
      r -= FoldHeight(s, v);
      r += Relief(s, v);
    }
    // The far end is closed by half an ellipsoid.
    const double into_end = (s - (length_mm_ - kEndMm)) / kEndMm;
    if (into_end > 0) r *= std::sqrt(std::max(1e-4, 1.0 - into_end * into_end));
    return r;
  }

 private:
  static constexpr double kEndMm = 18.0;

  void DrawFolds() {
    Random random = Random(static_cast<std::uint64_t>(options_.seed)).Child("folds");
    for (double s = 0.4 * options_.fold_spacing_mm; s < length_mm_;
         s += options_.fold_spacing_mm * random.Uniform(0.7, 1.3)) {
      const double first_angle = random.Uniform(0.0, 2.0 * std::numbers::pi);
      const int arcs = 1 + random.Index(3);
      for (int i = 0; i < arcs; ++i) {
        Fold fold;
        fold.s_mm = s + random.Normal(0.06 * options_.fold_spacing_mm);
        fold.depth_mm = options_.fold_depth_mm * random.Uniform(0.55, 1.4);
        fold.width_mm = random.Uniform(2.2, 3.6) * std::max(1.0, fold.depth_mm / 7.0);
        fold.angle = first_angle + i * 2.0 * std::numbers::pi / arcs + random.Normal(0.2);
        fold.half_arc = (arcs == 1 ? 1.9 : 2.3 * std::numbers::pi / 2.0 / arcs) * random.Uniform(0.75, 1.1);
        fold.skew_mm = random.Uniform(0.0, 4.0);
        fold.skew_angle = random.Uniform(0.0, 2.0 * std::numbers::pi);
        folds_.push_back(fold);
      }
    }
  }

  double FoldHeight(double s, double v) const {
    // Where arcs overlap the higher one hides the lower one: a 4-norm instead of the sum.
    double height = 0;
    for (const Fold& fold : folds_) {
      const double ds = s - fold.s_mm - fold.skew_mm * std::cos(v - fold.skew_angle);
      if (std::abs(ds) > 3.5 * fold.width_mm) continue;
      const double dv = std::remainder(v - fold.angle, 2.0 * std::numbers::pi);
      if (std::abs(dv) >= fold.half_arc) continue;
      const double along = std::exp(-ds * ds / (fold.width_mm * fold.width_mm));
      const double around = std::cos(0.5 * std::numbers::pi * dv / fold.half_arc);
      const double f = fold.depth_mm * along * around;
      height += f * f * f * f;
    }
    return std::sqrt(std::sqrt(height));
  }

  double Relief(double s, double v) const {
    const double radius = options_.radius_mm;
    return ReliefMm({radius * std::cos(v), radius * std::sin(v), s}, options_.relief_mm, noise_seed_);
  }

  const SimulationOptions::Scene& options_;
  double length_mm_;
  std::uint32_t noise_seed_ = 0;
  std::vector<Fold> folds_;
};

// Places along the centerline that are one mesh step apart on the wall where it is steepest.
std::vector<double> RowPositions(const Wall& wall, double length_mm, double step_mm) {
  constexpr int kAngles = 48;
  constexpr double kSteepest = 3.0;
  std::vector<double> positions;
  for (double s = 0; s < length_mm;) {
    positions.push_back(s);
    double slope = 0;
    for (int i = 0; i < kAngles; ++i) {
      const double v = 2.0 * std::numbers::pi * i / kAngles;
      slope = std::max(slope, std::abs(wall.Radius(s + step_mm, v) - wall.Radius(s, v)) / step_mm);
    }
    slope = std::min(slope, kSteepest);
    s += step_mm / std::sqrt(1.0 + slope * slope);
  }
  positions.push_back(length_mm);
  return positions;
}

// The square root of the gradient of the nearest point on the centerline (RestPoint::swell_along).
Eigen::Vector3d SwellAlong(const Centerline& centerline, double s, const Eigen::Vector3d& from_center) {
  constexpr double kStepMm = 0.5;
  const auto tangent = [&](double at) { return centerline.WorldFromFrame(at).rotation * Eigen::Vector3d::UnitZ(); };
  const Eigen::Vector3d curvature = (tangent(s + kStepMm) - tangent(s - kStepMm)) / (2.0 * kStepMm);
  // A section that is bent more than its radius allows would have no nearest point; the bend's limit excludes it.
  return tangent(s) / std::sqrt(std::max(0.1, 1.0 - curvature.dot(from_center)));
}

}  // namespace

Surface MakeTube(const SimulationOptions::Scene& options, const Centerline& centerline, double length_mm) {
  const Wall wall(options, length_mm);
  const std::vector<double> positions = RowPositions(wall, length_mm, options.mesh_step_mm);
  Surface surface;
  const int rows = static_cast<int>(positions.size());
  const int columns =
      static_cast<int>(std::ceil(2.0 * std::numbers::pi * options.radius_mm / options.mesh_step_mm)) + 1;
  surface.grid = SurfaceGrid{rows, columns, SurfaceGrid::Sides::kClosed, 2.0 * std::numbers::pi * options.radius_mm,
                             rows * options.mesh_step_mm};
  const std::size_t count = static_cast<std::size_t>(rows) * columns;
  surface.vertices.resize(count);
  surface.chart.resize(count);
  surface.swell_center.resize(count);
  surface.swell_along.resize(count);
  surface.swell_radius_mm = options.radius_mm;
  tbb::parallel_for(0, rows, [&](int row) {
    const double s = positions[row];
    const Rigid3 world_from_frame = centerline.WorldFromFrame(s);
    for (int column = 0; column < columns; ++column) {
      // The last column is the first one again, to the bit.
      const double v = 2.0 * std::numbers::pi * (column % (columns - 1)) / (columns - 1);
      const double r = wall.Radius(s, v);
      const std::size_t idx = static_cast<std::size_t>(row) * columns + column;
      const Eigen::Vector3d position = world_from_frame * Eigen::Vector3d(r * std::cos(v), r * std::sin(v), 0.0);
      surface.vertices[idx] = position.cast<float>();
      surface.chart[idx] =
          Eigen::Vector2d(surface.grid->chart_width_mm * column / (columns - 1), row * options.mesh_step_mm)
              .cast<float>();
      surface.swell_center[idx] = world_from_frame.translation.cast<float>();
      surface.swell_along[idx] = SwellAlong(centerline, s, position - world_from_frame.translation).cast<float>();
    }
  });
  FillGrid(surface);
  return surface;
}

}  // namespace pliant::simulation
