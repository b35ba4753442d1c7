// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "pliant/deformation/graph.h"
#include "pliant/estimation/two_view/relative_pose.h"
#include "pliant/geometry/triangulation.h"
#include "python/arrays.h"
#include "python/bind.h"
#include "python/errors.h"
#include "python/options.h"

namespace py = pybind11;

namespace pliant::python {
namespace {

// (points_in_cam0, whether there is one).
py::tuple TriangulateRays(const py::object& cam1_from_cam0, const py::object& rays0, const py::object& rays1,
                          const std::string& method) {
  const Rigid3 motion = RigidOf(cam1_from_cam0, "cam1_from_cam0");
  const auto from0 = VectorsOf(rays0, "rays0");
  const auto from1 = VectorsOf(rays1, "rays1");
  if (from0.size() != from1.size())
    RaiseValueError("rays0 has " + std::to_string(from0.size()) + " rows and rays1 has " +
                    std::to_string(from1.size()) + "; give as many");
  const auto chosen = EnumOf<TriangulationMethod>(method, "method");
  std::vector<double> points;
  py::array_t<bool> ok(static_cast<py::ssize_t>(from0.size()));
  bool* ok_row = ok.mutable_data();
  {
    const py::gil_scoped_release release;
    for (const TriangulatedPoint& point : Triangulate(chosen, motion, from0, from1)) {
      *ok_row++ = point.ok();
      for (int k = 0; k < 3; ++k) points.push_back(point.ok() ? point.point_in_cam0[k] : std::nan(""));
    }
  }
  return py::make_tuple(ArrayOf(std::move(points), {3}), ok);
}

// (cam1_from_cam0, inliers).
py::tuple RelativePoseOf(const py::object& rays0, const py::object& rays1, double focal_px, const py::dict& choices) {
  const auto from0 = VectorsOf(rays0, "rays0");
  const auto from1 = VectorsOf(rays1, "rays1");
  if (!(focal_px > 0) || !std::isfinite(focal_px)) RaiseValueError("focal_px has to be a number above 0");
  RelativePoseOptions options;
  options.solver = EnumOf<RelativePoseSolver>(py::cast<std::string>(choices["solver"]), "solver");
  options.robust = EnumOf<RobustLoop>(py::cast<std::string>(choices["robust"]), "robust");
  options.max_error_px = py::cast<double>(choices["max_error_px"]);
  options.max_iterations = py::cast<int>(choices["max_iterations"]);
  const Random random(py::cast<std::uint64_t>(choices["seed"]));
  if (!(options.max_error_px > 0) || options.max_iterations < 1)
    RaiseValueError("max_error_px has to be above 0 and max_iterations at least 1");
  const RelativePose pose = ValueOf([&] {
    const py::gil_scoped_release release;
    return EstimateRelativePose(from0, from1, focal_px, random, options);
  }());
  py::array_t<bool> inliers(static_cast<py::ssize_t>(pose.inliers.size()));
  std::ranges::transform(pose.inliers, inliers.mutable_data(), [](char inlier) { return inlier != 0; });
  return py::make_tuple(MatrixOf(pose.cam1_from_cam0), inliers);
}

// (edges, weight, rest_length, multiplicity).
py::tuple DeformationGraphOf(const py::object& positions, const py::object& rest_positions, const py::object& options) {
  const auto now = VectorsOf(positions, "positions");
  const auto rest =
      rest_positions.is_none() ? std::vector<Eigen::Vector3d>() : VectorsOf(rest_positions, "rest_positions");
  const auto graph_options = OptionsOf<GraphOptions>(options);
  const DeformationGraph graph = ValueOf([&] {
    const py::gil_scoped_release release;
    return BuildDeformationGraph(now, rest, graph_options);
  }());
  std::vector<std::int32_t> edges;
  std::vector<double> weight;
  std::vector<double> rest_length;
  std::vector<std::int32_t> multiplicity;
  for (const GraphEdge& edge : graph.edges) {
    edges.insert(edges.end(), {edge.i, edge.j});
    weight.push_back(edge.weight);
    rest_length.push_back(edge.rest_length_mm);
    multiplicity.push_back(edge.multiplicity);
  }
  return py::make_tuple(ArrayOf(std::move(edges), {2}), ArrayOf(std::move(weight)), ArrayOf(std::move(rest_length)),
                        ArrayOf(std::move(multiplicity)));
}

}  // namespace

void BindKernels(py::module_& module) {
  module.def("triangulate", &TriangulateRays);
  module.def("relative_pose", &RelativePoseOf);
  module.def("deformation_graph", &DeformationGraphOf);
}

}  // namespace pliant::python
