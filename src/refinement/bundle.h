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

inline constexpr double kStartNoisePx = 0.3;  // before a solution has measured it
inline constexpr double kWrongTrack = 3.0;    // times the median track's error

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
  // The same in the view in which distances were measured, at the median distance; in proportion to it elsewhere.
  double measured_log_distance = 0.01;
};

// (F7) Logarithms of the distances in the view in which they were measured by the measured ones, a used point each, by
// the measured distance over the median one.
std::vector<double> MeasuredDistanceErrors(const Recording& recording, const std::vector<bool>& used,
                                           const BundleState& state, double median_distance);

// (F8) Their standard deviation, about zero and by the median: 0.002 to 0.1.
double MeasuredSigma(std::vector<double> errors);

// Of Cauchy's loss, in standard deviations of an error.
inline constexpr double kBundleLossScale = 2.0;

// What is solved for; the rest is held.
enum class BundlePart {
  kAll,
  kViews,   // poses and coefficients, by the points as they are
  kPoints,  // rest positions and basis shapes, by the views and nodes as they are
};

// What a solution is made of. `camera` and `recording` must outlive it.
struct BundleInput {
  const Camera& camera;
  const Recording& recording;
  std::vector<bool> used = {};  // an observation each
  BundleGraph graph = {};
  BundleSigmas sigmas = {};
  double distance = 1;  // median, of the points from the cameras
  BundlePart part = BundlePart::kAll;
  // (F9) Errors of a track are alike in all its views, since its patch drifts: all of them count as one measurement.
  bool one_measurement_per_track = false;
  // By which share the cost still falls when the solution ends: what is left changes depths by less than their noise.
  double function_tolerance = 1e-3;
};

struct BundleSummary {
  double initial_cost = 0;
  double final_cost = 0;
};

// A scene that deforms, with the best `rank` shapes for the motions that the positions of the start have.
BundleState DeformingStart(const Recording& recording, int rank, int nodes_in_view);
BundleGraph MakeGraph(const BundleState& state, int neighbors);

// Solves for `state`; the first view stays. `callback` gets the cost after every iteration; false ends the solution
// with the best so far. Fails with kDegenerate where there is no usable step.
Result<BundleSummary> SolveBundle(const BundleInput& input, int max_iterations,
                                  const std::function<bool(double)>& callback, BundleState* state);

struct BundleCovariance {
  // An observation of the recording each: of the log distance from the camera; 0 where its point is not in the problem.
  std::vector<double> log_distance_sigmas;
  std::vector<PoseCovariance> poses;  // of the views; the first is zero, for it is the world
};

// (F9) How certain a solution for all is, with one measurement per track. Fails with kDegenerate where the terms do not
// determine their variables.
Result<BundleCovariance> CovarianceOfBundle(const BundleInput& input, const BundleState& state);

// The views of every point, of its used observations.
std::vector<int> CountViews(const Recording& recording, const std::vector<bool>& used);

// Mean square error of every point's used observations, px^2; 0 where it has none.
std::vector<double> MeanSquareErrors(const Recording& recording, const std::vector<bool>& used,
                                     const std::vector<Eigen::Vector2d>& errors_px);

// Of the points from the cameras, over the observations.
double MedianDistance(const Recording& recording);

// Standard deviation of a pixel coordinate, from the median error of the used observations; at least 0.02 px (F8).
double NoisePx(const std::vector<Eigen::Vector2d>& errors_px, const std::vector<bool>& used);

// Error of every observation, px; one that does not project has the image's width.
std::vector<Eigen::Vector2d> ReprojectionErrors(const Camera& camera, const Recording& recording,
                                                const BundleState& state);

}  // namespace pliant
