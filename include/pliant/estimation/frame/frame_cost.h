// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A term that the calling program adds to the joint problem of a frame (frame_problem.h):
//   E = ... + 0.5 * |r(X_1 + delta_1, ..., X_N + delta_N)|^2,
// with residuals r of its own making: any number, of any points, in units of their standard deviations. World frame,
// map units (mm). It depends on the camera's pose only through the points.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/ids.h"
#include "pliant/deformation/graph.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

// What a term is asked about: the points of the problem, without those that do not project under the initial pose.
// Spans have one entry a point.
struct FrameCostInput {
  int frame_idx = 0;
  std::span<const PointId> ids;                // ascending; empty where the problem was given none
  std::span<const Eigen::Vector3d> positions;  // X_i + delta_i, where it is asked
  std::span<const Eigen::Vector3d> previous;   // X_i, in the frame before
  std::span<const Eigen::Vector2d> pixels;     // where they are seen, px
  std::span<const GraphEdge> edges;            // of the deformation graph, between these points
  Rigid3 initial_cam_from_world;               // where the search for the pose starts
};

struct FrameCostValue {
  // dr_row / d(coordinate column % 3 of point column / 3). Entries of the same place add up.
  struct Entry {
    int row = 0;
    int column = 0;
    double value = 0;
  };
  std::vector<double> residuals;
  std::vector<Entry> jacobian;  // what is not named is zero
};

class FrameCost {
 public:
  virtual ~FrameCost() = default;

  // Letters, digits and underscores: the column cost_<name> of frames.csv. Not one of NoFrameCosts.
  virtual std::string_view name() const = 0;

  // The residuals, as many in every call of one frame, and their derivatives. Asked again and again while a frame is
  // solved, from one thread. False where there is no answer: the solver then refuses the step.
  virtual bool Evaluate(const FrameCostInput& input, FrameCostValue* value) const = 0;
};

}  // namespace pliant
