// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Rays against the posed mesh (Embree 3). Embree finds the triangle; where on it, and how far, is computed here in
// double precision, so that truth does not depend on the vector unit that Embree chose.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/status.h"
#include "pliant/simulation/simulator.h"
#include "simulation/surface.h"

namespace pliant::simulation {

struct RayHit {
  static constexpr std::uint32_t kNone = 0xffffffffU;
  MaterialPoint point{kNone, 0.0, 0.0};
  double distance_mm = 0;  // along the unit ray
  bool hit() const { return point.triangle_idx != kNone; }
};

struct Ray {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  // unit; zero: no ray
};

class RayScene {
 public:
  enum class Vertices { kFixed, kMoving };

  // Fails with kInsufficient when the ray tracer cannot be started.
  static Result<RayScene> Create(const Surface& surface, Vertices vertices);
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;
  ~RayScene();

  // New positions for all vertices (in their order); for a scene of moving vertices.
  void Move(std::span<const Eigen::Vector3f> vertices);

  // The first triangle on each ray. May be called from several threads at once.
  void Intersect(std::span<const Ray> rays, std::span<RayHit> hits) const;
  // The same for rays from one `origin`.
  void Intersect(const Eigen::Vector3d& origin, std::span<const Eigen::Vector3d> directions,
                 std::span<RayHit> hits) const;

  // Calls `visit` with every triangle that is nearer to `center` than `radius_mm`, and a few more, in no order that
  // means anything. May be called from several threads at once.
  void VisitNear(const Eigen::Vector3d& center, double radius_mm,
                 const std::function<void(std::uint32_t triangle_idx)>& visit) const;

 private:
  struct State;
  explicit RayScene(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pliant::simulation
