// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The joint problem of one frame: the camera's pose T = cam_from_world and one displacement delta_i for every point,
// X_i(t) = X_i(t-1) + delta_i, that minimize (docs/method.md, eq. E5)
//
//   E = 0.5 * (            sum_i   rho_rep(|u_i - project(T (X_i + delta_i))|^2 / sigma_rep^2)
//              + lambda_spa sum_ij rho_spa(w_ij^2 |delta_i - delta_j|^2 / sigma_spa^2)
//              + lambda_tmp sum_i  rho_tmp(|delta_i|^2 / sigma_tmp^2)
//              + lambda_len sum_ij rho_len((|X_i + delta_i - X_j - delta_j| - rest_ij)^2 / sigma_len^2)  if asked for)
//
// with the sums over ij going over the paper's directed pairs, and rho Huber's on the squared norm: rho(s) = s up to
// chi2, 2 sqrt(chi2 s) - chi2 beyond. World frame, mm; pixels with (0, 0) at the center of the first pixel. What pose
// and displacements could share (a motion of everything at once) is settled by the temporal term: it goes to the camera
// as far as it is rigid. The calling program may add a term (frame_cost.h). Source: Gomez Rodriguez, Montiel, Tardos,
// IROS 2022 (arXiv 2204.08309), section III.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/deformation/graph.h"
#include "pliant/estimation/frame/frame_cost.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/scene/cost_term.h"

namespace pliant {

// Both are Ceres' and end in the same minimum.
enum class FrameSolver {
  kLbfgs,               // line search in variables that make the Hessian nearly the identity; fast
  kLevenbergMarquardt,  // one residual block a term, sparse Cholesky factorisation of the normal equations; as
                        // published
};

template <>
struct EnumNames<FrameSolver> {
  static constexpr std::array kNames = {
      std::pair{FrameSolver::kLbfgs, std::string_view("lbfgs")},
      std::pair{FrameSolver::kLevenbergMarquardt, std::string_view("levenberg_marquardt")}};
};

struct FrameProblemOptions {
  double lambda_spa = 1.0;  // weights of the terms
  double lambda_tmp = 1.0;
  double sigma_rep_px = 1.0;
  double sigma_spa_mm = 10.0;
  double sigma_tmp_mm = 10.0;
  double chi2_rep = 5.991;  // Huber thresholds: 95 % quantiles of chi-square with 2, 3, 3 degrees of freedom
  double chi2_spa = 7.815;
  double chi2_tmp = 7.815;
  Switch edge_length = Switch::kOff;
  double lambda_len = 1.0;
  double sigma_len_mm = 1.0;
  double chi2_len = 3.841;  // 95 % at 1 degree of freedom
  FrameSolver solver = FrameSolver::kLbfgs;
  int max_iterations = 200;
  double function_tolerance = 1e-9;  // relative change of the cost at which it has converged
  int min_points = 4;                // fewer usable points determine no pose

  void List(OptionTable& table);  // group "Optimization"
};

// Whether the pose is sought, or known and held at the initial one: then only the displacements are.
enum class FramePose { kEstimated, kHeld };

// What a frame gives to the problem. Spans are as long as there are points; nothing here is changed.
struct FrameProblemInput {
  std::span<const Eigen::Vector3d> positions;  // X_i(t-1)
  std::span<const Eigen::Vector2d> pixels;     // u_i
  std::span<const GraphEdge> edges;            // of BuildDeformationGraph(positions)
  Rigid3 initial_cam_from_world;               // where the search starts, with delta = 0
  FramePose pose = FramePose::kEstimated;
  const FrameCost* cost = nullptr;  // a term of the program's own, with what it is told; null: none
  int frame_idx = 0;
  std::span<const PointId> ids = {};  // ascending; or none
};

// What became of one point. Points outside the problem keep their position and infinite errors.
struct FramePoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // X_i + delta_i
  bool used = false;  // false: the point does not project under the initial pose (behind the camera) and was left out
  double reprojection_error_px = std::numeric_limits<double>::infinity();
  // |delta_i - weighted mean of its neighbors' delta|, the weights being w_ij^2: how much of the point's motion
  // no neighbor shares. With the published sigmas a wrong track shows here and not in the reprojection error, because
  // its displacement gives way. Zero without neighbors.
  double disagreement_mm = std::numeric_limits<double>::infinity();
};

// The terms' names, in their order, with costs of 0; that of a program's own term comes after them.
std::vector<CostTerm> NoFrameCosts();

struct FrameSolution {
  Rigid3 cam_from_world;
  std::vector<FramePoint> points;       // one a point of the input
  std::vector<CostTerm> initial_costs;  // as NoFrameCosts
  std::vector<CostTerm> costs;
  int num_used = 0;
  int iterations = 0;
  bool converged = false;
  std::string message;  // how the solver ended
};

// Solves the problem. Single-threaded; the same input gives the same bits, and depends on no earlier call.
// Fails with kMismatch for counts that differ or edges that point outside, kInvalidArgument for numbers that are not
// finite, kInsufficient for fewer than min_points points that project under the initial pose, kDegenerate when Ceres
// finds no usable solution, or the program's own term has no value at the start. Running out of iterations is no
// failure: see `converged`.
Result<FrameSolution> SolveFrameProblem(const Camera& camera, const FrameProblemInput& input,
                                        const FrameProblemOptions& options);

// The energy by term at a given pose and positions X_i + delta_i (one an input point; points that do not project under
// the initial pose are left out as in SolveFrameProblem). Fails like SolveFrameProblem, and with kInvalidArgument when
// a point that was in front of the camera is not any more.
Result<std::vector<CostTerm>> EvaluateFrameCosts(const Camera& camera, const FrameProblemInput& input,
                                                 const Rigid3& cam_from_world,
                                                 std::span<const Eigen::Vector3d> positions,
                                                 const FrameProblemOptions& options);

}  // namespace pliant
