// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The two problems that the tracker solves: one frame, and the window of a first map.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "pliant/deformation/graph.h"
#include "pliant/estimation/frame/frame_problem.h"
#include "pliant/estimation/window/deforming_window.h"
#include "python/arrays.h"
#include "python/bind.h"
#include "python/calibration.h"
#include "python/cost.h"
#include "python/errors.h"
#include "python/options.h"

namespace py = pybind11;

namespace pliant::python {
namespace {

constexpr double kUnitLength = 1e-6;  // as OpenGV's solvers ask for
constexpr double kSamePose = 1e-6;

bool IsIdentity(const Rigid3& pose) {
  return pose.RotationMatrix().isIdentity(kSamePose) && pose.translation.norm() < kSamePose;
}

py::dict Costs(const std::vector<CostTerm>& costs) {
  py::dict dict;
  for (const CostTerm& term : costs) dict[py::str(term.name)] = term.value;
  return dict;
}

// (cam_from_world, positions, used, reprojection_error_px, disagreement, costs, initial_costs, iterations, converged).
py::tuple SolveFrame(const Calibration& calibration, const py::object& positions, const py::object& pixels,
                     const py::object& cam_from_world, const py::object& rest_positions, bool held,
                     const py::object& options, const py::dict& cost) {
  const auto points = VectorsOf(positions, "positions");
  const auto seen = PointsOf(pixels, 2, "pixels");
  std::vector<Eigen::Vector2d> at;
  for (py::ssize_t i = 0; i < seen.shape(0); ++i) at.emplace_back(seen.at(i, 0), seen.at(i, 1));
  const auto rest =
      rest_positions.is_none() ? std::vector<Eigen::Vector3d>() : VectorsOf(rest_positions, "rest_positions");
  const Rigid3 start = RigidOf(cam_from_world, "cam_from_world");
  GraphOptions graph_options;
  FrameProblemOptions frame_options;
  OptionTable table;
  graph_options.List(table);
  frame_options.List(table);
  SetOptions(options, &table);
  Callbacks callbacks;
  const auto frame_cost = FrameCostOf(cost, &callbacks);
  std::vector<PointId> ids;
  for (std::size_t i = 0; i < points.size(); ++i) ids.push_back(PointId{static_cast<std::int64_t>(i)});
  auto solved = [&]() -> Result<FrameSolution> {
    const py::gil_scoped_release release;
    const auto graph = BuildDeformationGraph(points, rest, graph_options);
    if (!graph.ok()) return graph.status();
    const FrameProblemInput input{.positions = points,
                                  .pixels = at,
                                  .edges = graph->edges,
                                  .initial_cam_from_world = start,
                                  .pose = held ? FramePose::kHeld : FramePose::kEstimated,
                                  .cost = frame_cost.get(),
                                  .ids = ids};
    return SolveFrameProblem(calibration.camera, input, frame_options);
  }();
  callbacks.RaiseError();
  const FrameSolution solution = ValueOf(std::move(solved));
  std::vector<Eigen::Vector3d> moved;
  py::array_t<bool> used(static_cast<py::ssize_t>(solution.points.size()));
  std::vector<double> errors_px;
  std::vector<double> disagreements;
  bool* used_row = used.mutable_data();
  for (const FramePoint& point : solution.points) {
    moved.push_back(point.position);
    *used_row++ = point.used;
    errors_px.push_back(point.reprojection_error_px);
    disagreements.push_back(point.disagreement_mm);
  }
  return py::make_tuple(MatrixOf(solution.cam_from_world), PositionsArray(moved), used, ArrayOf(std::move(errors_px)),
                        ArrayOf(std::move(disagreements)), Costs(solution.costs), Costs(solution.initial_costs),
                        solution.iterations, solution.converged);
}

std::vector<int> IndicesOf(const py::handle& array, std::size_t count, std::size_t end, const std::string& what) {
  if (py::isinstance<py::array>(array) && py::cast<py::array>(array).dtype().kind() == 'f')
    RaiseTypeError(what + " has to be whole numbers; these are floats");
  const auto indices = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!indices || indices.ndim() != 1 || indices.shape(0) != static_cast<py::ssize_t>(count))
    RaiseValueError(what + " has to be a list of as many whole numbers as there are rays");
  std::vector<int> result;
  for (py::ssize_t k = 0; k < indices.shape(0); ++k) {
    if (indices.at(k) < 0 || indices.at(k) >= static_cast<std::int64_t>(end))
      RaiseValueError(what + " has " + std::to_string(indices.at(k)) + " in it, and there are " + std::to_string(end));
    result.push_back(static_cast<int>(indices.at(k)));
  }
  return result;
}

// `start`: times, cams_from_world, points, rays, view_idx, point_idx. (cams_from_world, points, coefficients, shapes,
// log_depth_sigma, cost, residual_correlation).
py::tuple SolveWindow(const py::dict& start, double focal_px, bool deforming, const py::object& options) {
  DeformingWindow window;
  window.times = NumbersOf(start["times"], "times");
  const auto poses = py::cast<py::array>(start["cams_from_world"]);
  if (poses.ndim() != 3 || poses.shape(0) != static_cast<py::ssize_t>(window.times.size()))
    RaiseValueError("cams_from_world has to be an array of shape (views, 4, 4), a pose for each of the times");
  for (py::ssize_t v = 0; v < poses.shape(0); ++v)
    window.cams_from_world.push_back(RigidOf(poses[py::int_(v)], "cams_from_world of view " + std::to_string(v)));
  window.points_in_world = VectorsOf(start["points"], "points");
  const auto rays = VectorsOf(start["rays"], "rays");
  if (!window.cams_from_world.empty() && !IsIdentity(window.cams_from_world.front()))
    RaiseValueError("the first of cams_from_world is not the identity; points are in the first view");
  if (!std::ranges::all_of(rays, [](const Eigen::Vector3d& ray) { return std::abs(ray.norm() - 1.0) < kUnitLength; }))
    RaiseValueError("rays has vectors that are not of length 1; give those of pliant.Camera.unproject");
  const auto views = IndicesOf(start["view_idx"], rays.size(), window.times.size(), "view_idx");
  const auto points = IndicesOf(start["point_idx"], rays.size(), window.points_in_world.size(), "point_idx");
  for (std::size_t k = 0; k < rays.size(); ++k)
    window.observations.push_back({.view_idx = views[k], .point_idx = points[k], .ray = rays[k]});
  if (!(focal_px > 0) || !std::isfinite(focal_px)) RaiseValueError("focal_px has to be a number above 0");
  const auto window_options = OptionsOf<DeformingWindowOptions>(options);
  const DeformingSolution solution = ValueOf([&] {
    const py::gil_scoped_release release;
    return deforming ? SolveDeformingWindow(window, focal_px, window_options)
                     : SolveRigidWindow(window, focal_px, window_options);
  }());
  const DeformingWindow& solved = solution.window;
  std::vector<double> matrices;
  for (const Rigid3& pose : solved.cams_from_world) AppendMatrix(pose, &matrices);
  const auto rank = static_cast<py::ssize_t>(solved.coefficients.rows());
  py::array_t<double> coefficients({rank, static_cast<py::ssize_t>(solved.times.size())});
  for (py::ssize_t r = 0; r < rank; ++r)
    for (py::ssize_t v = 0; v < coefficients.shape(1); ++v) coefficients.mutable_at(r, v) = solved.coefficients(r, v);
  py::array_t<double> shapes({static_cast<py::ssize_t>(solved.points_in_world.size()), py::ssize_t{3}, rank});
  for (std::size_t i = 0; rank > 0 && i < solved.shapes.size(); ++i)
    for (py::ssize_t k = 0; k < 3; ++k)
      for (py::ssize_t r = 0; r < rank; ++r)
        shapes.mutable_at(static_cast<py::ssize_t>(i), k, r) = solved.shapes[i](k, r);
  std::vector<double> sigmas;
  for (std::size_t i = 0; i < solved.points_in_world.size(); ++i) sigmas.push_back(solution.LogDepthSigma(i));
  return py::make_tuple(ArrayOf(std::move(matrices), {4, 4}), PositionsArray(solved.points_in_world), coefficients,
                        shapes, ArrayOf(std::move(sigmas)), solution.cost, solution.residual_correlation);
}

}  // namespace

void BindSolvers(py::module_& module) {
  module.def("solve_frame", &SolveFrame);
  module.def("cost_names", [] {
    std::vector<std::string> names;
    for (const CostTerm& term : NoFrameCosts()) names.push_back(term.name);
    return names;
  });
  module.def("solve_window", &SolveWindow);
}

}  // namespace pliant::python
