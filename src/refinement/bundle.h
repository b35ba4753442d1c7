// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// One solution of a refinement: poses, points and, unless its rank is 0, how the points move.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/estimation/window/shape_basis.h"
#include "pliant/refinement/refine_recording.h"

namespace pliant {

struct BundleState {
  std::vector<Rigid3> cams_from_world;
  std::vector<Eigen::Vector3d> rest_positions;
  Eigen::MatrixXd coefficients;          // temporal, R x views, no unit; no rows: a rigid scene
  std::vector<Eigen::Matrix3Xd> shapes;  // basis shapes, 3 x R a point, map units
  SurfaceNodes nodes;

  int rank() const { return static_cast<int>(coefficients.rows()); }
  Eigen::Vector3d Position(int point_idx, int view_idx) const;
};

// Which nodes are around a point, and which are neighbors: by the positions at the start.
struct BundleGraph {
  std::vector<NodesOfPoint> nodes_of_point;
  std::vector<std::pair<int, int>> edges;  // directed, to the nearest nodes
};

// Standard deviations of the terms (F2 to F7).
struct BundleSigmas {
  double noise_px = 1;
  double gradient = 0.3;       // of the difference of neighbors' basis shapes, by their distance
  double size = 0.2;           // of a node's basis shape, by the median distance
  double acceleration = 0.02;  // of a temporal coefficient, 1/frame^2
  double log_distance = 0.2;   // of a point, from the start's
};

struct BundleSummary {
  double initial_cost = 0;
  double final_cost = 0;
};

// A scene that deforms, with the best `rank` shapes for the motions that the positions of the start have.
BundleState DeformingStart(const Recording& recording, const RefineOptions& options);
BundleGraph MakeGraph(const BundleState& state, int neighbors);

// Solves for `state`, by the observations in `used`; the first view stays. `distance` is the median distance of the
// points from the cameras. `callback` gets the cost after every iteration; false ends the solution with the best so
// far. Fails with kDegenerate where there is no usable step.
Result<BundleSummary> SolveBundle(const Camera& camera, const Recording& recording, const std::vector<bool>& used,
                                  const BundleGraph& graph, const BundleSigmas& sigmas, double distance,
                                  int max_iterations, const std::function<bool(double)>& callback, BundleState* state);

// Error of every observation, px; one that does not project has the image's width.
std::vector<Eigen::Vector2d> ReprojectionErrors(const Camera& camera, const Recording& recording,
                                                const BundleState& state);

}  // namespace pliant
