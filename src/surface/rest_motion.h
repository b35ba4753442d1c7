// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Where undeformed positions are in a frame, by the tracked points around them.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pliant/scene/frame_report.h"
#include "pliant/surface/tracked_mesh.h"

namespace pliant {

// (V10) A displacement for every undeformed position: an affine motion fitted to the nearest tracked points that the
// frame has, the nearer ones counting more.
class RestMotion {
 public:
  // Nothing with fewer than kMinPoints points (sparse_surface.h) that have an undeformed position.
  static std::optional<RestMotion> Create(const RestPositions& rest, std::span<const PointObservation> observations);

  // World frame, map units; one result a position. The same on any number of threads.
  std::vector<Eigen::Vector3d> Displacements(std::span<const Eigen::Vector3d> rest, int threads) const;
  // The undeformed positions of points that are at `now` in the frame.
  std::vector<Eigen::Vector3d> Undeformed(std::span<const Eigen::Vector3d> now, int threads) const;
  // How far tracked points are off that are held out, map units; median.
  double error() const { return error_; }

 private:
  RestMotion(std::vector<Eigen::Vector3d> rest, std::vector<Eigen::Vector3d> displacements)
      : rest_(std::move(rest)), displacements_(std::move(displacements)) {}
  double HeldOutError() const;

  std::vector<Eigen::Vector3d> rest_;
  std::vector<Eigen::Vector3d> displacements_;
  int neighbors_ = 0;  // that tell the best of points that are held out
  double error_ = 0;
};

}  // namespace pliant
