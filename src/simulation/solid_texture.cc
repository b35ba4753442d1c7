// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/solid_texture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <Eigen/Geometry>

#include "simulation/closest_point.h"

namespace pliant::simulation {
namespace {

constexpr float kCellMm = 2.0F;
constexpr double kVesselStepMm = 0.4;  // of a growing vessel
constexpr float kSoftEdgeMm = 0.1F;    // a vessel lies in the wall, not on it

struct Foot {
  Eigen::Vector3d position;
  Eigen::Vector3d normal;
};

// The nearest position of the surface within a step or two.
std::optional<Foot> FootOnSurface(const Surface& surface, const RayScene& at_rest, const Eigen::Vector3d& x) {
  double least_sq = std::numeric_limits<double>::infinity();
  std::uint32_t best = 0;
  Eigen::Vector3d position;
  at_rest.VisitNear(x, 2.0 * kVesselStepMm, [&](std::uint32_t idx) {
    const auto& t = surface.triangles[idx];
    const Corners corners = {surface.vertices[t[0]].cast<double>(), surface.vertices[t[1]].cast<double>(),
                             surface.vertices[t[2]].cast<double>()};
    const Eigen::Vector3d candidate = ClosestPoint(corners, x);
    const double distance_sq = (candidate - x).squaredNorm();
    // Ties (on an edge) go to the first triangle, in whatever order they come.
    if (distance_sq > least_sq || (distance_sq == least_sq && idx > best)) return;
    least_sq = distance_sq;
    best = idx;
    position = candidate;
  });
  if (std::isinf(least_sq)) return std::nullopt;
  const auto& t = surface.triangles[best];
  return Foot{position,
              (surface.normals[t[0]] + surface.normals[t[1]] + surface.normals[t[2]]).cast<double>().normalized()};
}

// Places spread evenly over the surface by lot.
class Sower {
 public:
  explicit Sower(const Surface& surface) : surface_(surface) {
    double sum = 0;
    for (const auto& t : surface.triangles) {
      const Eigen::Vector3f ab = surface.vertices[t[1]] - surface.vertices[t[0]];
      const Eigen::Vector3f ac = surface.vertices[t[2]] - surface.vertices[t[0]];
      sum += 0.5 * ab.cross(ac).norm();
      sums_mm2_.push_back(sum);
    }
  }
  double area_mm2() const { return sums_mm2_.back(); }
  Foot Draw(Random& random) const {
    const auto it = std::upper_bound(sums_mm2_.begin(), sums_mm2_.end() - 1, random.Uniform(0, area_mm2()));
    const auto& t = surface_.triangles[it - sums_mm2_.begin()];
    return {surface_.vertices[t[0]].cast<double>(), surface_.normals[t[0]].cast<double>()};
  }

 private:
  const Surface& surface_;
  std::vector<double> sums_mm2_;
};

struct SurfaceTwig {
  Foot foot;
  Eigen::Vector3d heading;  // unit, along the surface
  double width_mm;
};

void Turn(SurfaceTwig& twig, double rad) { twig.heading = Eigen::AngleAxisd(rad, twig.foot.normal) * twig.heading; }

}  // namespace

SolidTexture::SolidTexture(const SimulationOptions::Texture& options, int seed, const Surface& surface,
                           const RayScene& at_rest)
    : contrast_(static_cast<float>(options.contrast)),
      mottling_(options, Random(static_cast<std::uint64_t>(seed)).Child("texture").Child("mottling")) {
  Grow(options, Random(static_cast<std::uint64_t>(seed)).Child("texture").Child("vessels"), surface, at_rest);
}

// As the vessels of the chart's map (blood_map.cc), with steps along the surface.
void SolidTexture::Grow(const SimulationOptions::Texture& options, Random random, const Surface& surface,
                        const RayScene& at_rest) {
  constexpr double kTreesPerMm2 = 1.0 / 900.0;
  constexpr double kThinnestMm = 0.09;
  const Sower sower(surface);
  const int trees = static_cast<int>(options.vessels * kTreesPerMm2 * sower.area_mm2());
  std::vector<SurfaceTwig> pending;
  for (int tree = 0; tree < trees; ++tree) {
    const Foot root = sower.Draw(random);
    SurfaceTwig stem{root, root.normal.unitOrthogonal(), random.Uniform(0.25, 0.6)};
    Turn(stem, random.Uniform(0, 2 * std::numbers::pi));
    pending.push_back(stem);
    while (!pending.empty()) {
      SurfaceTwig twig = pending.back();
      pending.pop_back();
      double turning = 0;
      while (twig.width_mm > kThinnestMm) {
        turning = 0.9 * turning + random.Normal(0.08);
        Turn(twig, turning * 0.5);
        const auto next = FootOnSurface(surface, at_rest, twig.foot.position + kVesselStepMm * twig.heading);
        // The surface ends here, or turns back on itself.
        if (!next || (next->position - twig.foot.position).norm() < 0.2 * kVesselStepMm) break;
        Store({twig.foot.position.cast<float>(), next->position.cast<float>(), static_cast<float>(0.5 * twig.width_mm),
               static_cast<float>(std::min(1.0, 0.25 + twig.width_mm * 1.4))});
        twig.foot = *next;
        twig.heading = (twig.heading - twig.heading.dot(next->normal) * next->normal).normalized();
        twig.width_mm *= 0.988;
        if (random.Uniform() >= 0.05) continue;
        const double side = random.Uniform() < 0.5 ? -1.0 : 1.0;
        SurfaceTwig branch = twig;
        Turn(branch, side * random.Uniform(0.4, 1.1));
        branch.width_mm *= random.Uniform(0.5, 0.8);
        pending.push_back(branch);
        Turn(twig, -side * 0.15);
      }
    }
  }
}

std::uint64_t SolidTexture::Cell(const Eigen::Vector3i& cell) {
  const auto bits = [](int i) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(i) & 0x1fffffU); };
  return bits(cell.x()) | (bits(cell.y()) << 21) | (bits(cell.z()) << 42);
}

void SolidTexture::Store(const Segment& segment) {
  const float reach = segment.half_width_mm + 3.0F * kSoftEdgeMm;
  const Eigen::Vector3i low =
      ((segment.from.cwiseMin(segment.to).array() - reach) / kCellMm).floor().matrix().cast<int>();
  const Eigen::Vector3i high =
      ((segment.from.cwiseMax(segment.to).array() + reach) / kCellMm).floor().matrix().cast<int>();
  for (int z = low.z(); z <= high.z(); ++z)
    for (int y = low.y(); y <= high.y(); ++y)
      for (int x = low.x(); x <= high.x(); ++x)
        cells_[Cell({x, y, z})].push_back(static_cast<std::uint32_t>(segments_.size()));
  segments_.push_back(segment);
}

float SolidTexture::At(const Eigen::Vector3f& position, float footprint_mm) const {
  float vessel = 0;
  const Eigen::Vector3i cell = (position / kCellMm).array().floor().matrix().cast<int>();
  if (const auto it = cells_.find(Cell(cell)); it != cells_.end()) {
    for (const std::uint32_t idx : it->second) {
      const Segment& s = segments_[idx];
      const Eigen::Vector3f way = s.to - s.from;
      const float t = std::clamp((position - s.from).dot(way) / way.squaredNorm(), 0.0F, 1.0F);
      const float distance = (s.from + t * way - position).norm();
      // A soft edge, and less of a vessel that is narrower than what is averaged over.
      const float inside = std::clamp((s.half_width_mm - distance) / (2.0F * kSoftEdgeMm) + 0.5F, 0.0F, 1.0F);
      const float width = 2.0F * s.half_width_mm;
      vessel = std::max(vessel, inside * s.blood * std::min(1.0F, width / std::max(footprint_mm, 1e-3F)));
    }
  }
  return contrast_ * (kMottlingBlood * mottling_.At(position, footprint_mm) + kVesselBlood * vessel);
}

}  // namespace pliant::simulation
