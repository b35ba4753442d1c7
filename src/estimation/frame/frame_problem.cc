// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/frame/frame_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "estimation/frame/frame_solvers.h"
#include "estimation/frame/frame_terms.h"
#include "pliant/residuals/reprojection.h"

namespace pliant {
namespace {

Status CheckInput(const FrameProblemInput& input) {
  const std::size_t count = input.positions.size();
  if (input.pixels.size() != count)
    return {ErrorCode::kMismatch, "the joint problem was given " + std::to_string(count) + " positions but " +
                                      std::to_string(input.pixels.size()) + " pixels"};
  if (!input.ids.empty() && input.ids.size() != count)
    return {ErrorCode::kMismatch, "the joint problem was given " + std::to_string(count) + " positions but " +
                                      std::to_string(input.ids.size()) + " point ids"};
  bool finite = input.initial_cam_from_world.rotation.coeffs().allFinite() &&
                input.initial_cam_from_world.translation.allFinite();
  for (const Eigen::Vector3d& position : input.positions) finite = finite && position.allFinite();
  for (const Eigen::Vector2d& pixel : input.pixels) finite = finite && pixel.allFinite();
  for (const GraphEdge& edge : input.edges) {
    if (edge.i < 0 || edge.i >= edge.j || edge.j >= static_cast<int>(count) || edge.multiplicity < 1 ||
        edge.multiplicity > 2)
      return {ErrorCode::kMismatch, "an edge of the deformation graph (" + std::to_string(edge.i) + ", " +
                                        std::to_string(edge.j) + ") does not belong to these " + std::to_string(count) +
                                        " points"};
    finite = finite && std::isfinite(edge.weight) && std::isfinite(edge.rest_length_mm);
  }
  if (!finite)
    return {ErrorCode::kInvalidArgument,
            "the joint problem was given a position, a pixel, an edge or a pose that is not a finite number"};
  return Status::Ok();
}

// The problem without the points that do not project under the initial pose, and without their edges.
Result<FrameData> BuildData(const Camera& camera, const FrameProblemInput& input, const FrameProblemOptions& options) {
  if (Status status = CheckInput(input); !status.ok()) return status;
  FrameData data;
  data.camera = &camera;
  data.options = options;
  data.pose_is = input.pose;
  data.cost = input.cost;
  data.frame_idx = input.frame_idx;
  std::vector<int> number(input.positions.size(), -1);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < input.positions.size(); ++i) {
    if (!camera.Project(input.initial_cam_from_world * input.positions[i])) continue;
    number[i] = data.num_points();
    data.input_idx.push_back(static_cast<int>(i));
    data.positions.push_back(input.positions[i]);
    data.pixels.push_back(input.pixels[i]);
    if (!input.ids.empty()) data.ids.push_back(input.ids[i]);
    sum += input.positions[i];
  }
  if (data.num_points() < options.min_points)
    return {ErrorCode::kInsufficient,
            "only " + std::to_string(data.num_points()) + " of " + std::to_string(input.positions.size()) +
                " points lie in front of the camera; the joint problem needs " + std::to_string(options.min_points)};
  data.pose = PoseIncrement(input.initial_cam_from_world, sum / data.num_points());
  for (GraphEdge edge : input.edges) {
    edge.i = number[edge.i];
    edge.j = number[edge.j];
    if (edge.i >= 0 && edge.j >= 0) data.edges.push_back(edge);
  }
  const auto by_points = [](const GraphEdge& a, const GraphEdge& b) {
    return std::pair(a.i, a.j) < std::pair(b.i, b.j);
  };
  if (!std::is_sorted(data.edges.begin(), data.edges.end(), by_points))
    std::sort(data.edges.begin(), data.edges.end(), by_points);
  return data;
}

// Each point's pixel error at a pose and positions at which all project.
std::vector<double> PixelErrors(const FrameData& data, const Rigid3& cam_from_world,
                                const std::vector<Eigen::Vector3d>& positions) {
  std::vector<double> errors_px;
  data.camera->Visit([&]<class Model>(const Model& model) {
    const ReprojectionKernel<Model> kernel(model, data.options.sigma_rep_px);
    Eigen::Vector2d residual;
    for (int i = 0; i < data.num_points(); ++i) {
      const Eigen::Vector3d in_cam = cam_from_world * positions[i];
      const bool projects = kernel.template Residual<double>(data.pixels[i], in_cam, &residual);
      errors_px.push_back(projects ? residual.norm() * data.options.sigma_rep_px
                                   : std::numeric_limits<double>::infinity());
    }
  });
  return errors_px;
}

// How much of each displacement no neighbor shares (FramePoint::disagreement_mm).
std::vector<double> Disagreements(const FrameData& data, const std::vector<Eigen::Vector3d>& positions) {
  std::vector<Eigen::Vector3d> sums(positions.size(), Eigen::Vector3d::Zero());
  std::vector<double> weights(positions.size(), 0.0);
  const auto add = [&](int to, int from, double weight) {
    sums[to] += weight * (positions[from] - data.positions[from]);
    weights[to] += weight;
  };
  for (const GraphEdge& edge : data.edges) {
    add(edge.i, edge.j, edge.weight * edge.weight);
    add(edge.j, edge.i, edge.weight * edge.weight);
  }
  std::vector<double> disagreements(positions.size(), 0.0);
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (weights[i] > 0.0) disagreements[i] = (positions[i] - data.positions[i] - sums[i] / weights[i]).norm();
  return disagreements;
}

}  // namespace

void FrameProblemOptions::List(OptionTable& table) {
  table.BeginGroup("Optimization", "the joint problem of camera pose and deformation, solved once a frame");
  table.Add("lambda_spa", &lambda_spa, "-", "weight of the spatial term: close points move alike", 0.0, 1e9);
  table.Add("lambda_tmp", &lambda_tmp, "-", "weight of the temporal term: points move slowly", 1e-9, 1e9);
  table.Add("sigma_rep_px", &sigma_rep_px, "px", "standard deviation of a measured pixel", 1e-3, 1e3);
  table.Add("sigma_spa_mm", &sigma_spa_mm, "mm", "standard deviation of neighbors' difference in motion a frame", 1e-6,
            1e6);
  table.Add("sigma_tmp_mm", &sigma_tmp_mm, "mm", "standard deviation of a point's motion a frame", 1e-6, 1e6);
  table.Add("chi2_rep", &chi2_rep, "-", "Huber threshold on the squared reprojection residual (95 %, 2 dof)", 1e-3,
            1e6);
  table.Add("chi2_spa", &chi2_spa, "-", "Huber threshold on the squared spatial residual (95 %, 3 dof)", 1e-3, 1e6);
  table.Add("chi2_tmp", &chi2_tmp, "-", "Huber threshold on the squared temporal residual (95 %, 3 dof)", 1e-3, 1e6);
  table.AddChoice("edge_length", &edge_length, "whether edges are held to their rest length (local isometry)");
  table.Add("lambda_len", &lambda_len, "-", "weight of the edge-length term", 0.0, 1e9);
  table.Add("sigma_len_mm", &sigma_len_mm, "mm", "standard deviation of an edge's length around its rest length", 1e-6,
            1e6);
  table.Add("chi2_len", &chi2_len, "-", "Huber threshold on the squared edge-length residual (95 %, 1 dof)", 1e-3, 1e6);
  table.AddChoice("solver", &solver, "both end in the same minimum; lbfgs is many times faster");
  table.Add("max_iterations", &max_iterations, "iterations", "limit of the solver", 1, 100000);
  table.Add("function_tolerance", &function_tolerance, "ratio", "relative change of the cost at convergence", 0.0, 1.0);
  table.Add("min_points", &min_points, "points", "fewer usable points give no solution", 4, 10000);
}

Result<FrameSolution> SolveFrameProblem(const Camera& camera, const FrameProblemInput& input,
                                        const FrameProblemOptions& options) {
  const auto data = BuildData(camera, input, options);
  if (!data.ok()) return data.status();
  const FrameTerms terms = MakeFrameTerms(*data);
  auto initial_costs = FrameCosts(terms, input.initial_cam_from_world, data->positions);
  if (!initial_costs)  // all points project there
    return {ErrorCode::kDegenerate, "the term of the program's own has no value at the start of the joint problem"};
  const auto estimate = options.solver == FrameSolver::kLbfgs ? SolveFrameByLbfgs(*data, terms)
                                                              : SolveFrameByLevenbergMarquardt(*data, terms);
  if (!estimate.ok()) return estimate.status();

  auto costs = FrameCosts(terms, estimate->cam_from_world, estimate->positions);
  if (!costs) return {ErrorCode::kDegenerate, "the joint problem's solution puts a point behind the camera"};
  FrameSolution solution;
  solution.initial_costs = *std::move(initial_costs);
  solution.costs = *std::move(costs);
  solution.cam_from_world = estimate->cam_from_world;
  solution.num_used = data->num_points();
  solution.iterations = estimate->iterations;
  solution.converged = estimate->converged;
  solution.message = estimate->message;
  solution.points.resize(input.positions.size());
  for (std::size_t i = 0; i < input.positions.size(); ++i) solution.points[i].position = input.positions[i];
  const std::vector<double> errors_px = PixelErrors(*data, estimate->cam_from_world, estimate->positions);
  const std::vector<double> disagreements = Disagreements(*data, estimate->positions);
  for (int i = 0; i < data->num_points(); ++i)
    solution.points[data->input_idx[i]] = {estimate->positions[i], true, errors_px[i], disagreements[i]};
  return solution;
}

Result<std::vector<CostTerm>> EvaluateFrameCosts(const Camera& camera, const FrameProblemInput& input,
                                                 const Rigid3& cam_from_world,
                                                 std::span<const Eigen::Vector3d> positions,
                                                 const FrameProblemOptions& options) {
  const auto data = BuildData(camera, input, options);
  if (!data.ok()) return data.status();
  if (positions.size() != input.positions.size())
    return {ErrorCode::kMismatch, "the joint problem has " + std::to_string(input.positions.size()) + " points, but " +
                                      std::to_string(positions.size()) + " positions were given"};
  std::vector<Eigen::Vector3d> used;
  for (const int i : data->input_idx) used.push_back(positions[i]);
  auto costs = FrameCosts(MakeFrameTerms(*data), cam_from_world, used);
  if (!costs) return {ErrorCode::kInvalidArgument, "a point of the joint problem does not project at the given pose"};
  return *std::move(costs);
}

}  // namespace pliant
