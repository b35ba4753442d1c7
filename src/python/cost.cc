// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "python/cost.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "python/arrays.h"

namespace py = pybind11;

namespace pliant::python {
namespace {

// The columns of CostFrame of extensions.py.
py::tuple CostFrameOf(const FrameCostInput& input) {
  std::vector<std::int64_t> ids;
  for (const PointId id : input.ids) ids.push_back(id.value);
  std::vector<double> pixels;
  for (const Eigen::Vector2d& pixel : input.pixels) pixels.insert(pixels.end(), {pixel.x(), pixel.y()});
  std::vector<std::int32_t> edges;
  std::vector<double> weight;
  std::vector<double> rest_length;
  for (const GraphEdge& edge : input.edges) {
    edges.insert(edges.end(), {edge.i, edge.j});
    weight.push_back(edge.weight);
    rest_length.push_back(edge.rest_length_mm);
  }
  return py::make_tuple(input.frame_idx, ArrayOf(std::move(ids)), PositionsArray(input.positions),
                        PositionsArray(input.previous), ArrayOf(std::move(pixels), {2}), ArrayOf(std::move(edges), {2}),
                        ArrayOf(std::move(weight)), ArrayOf(std::move(rest_length)),
                        MatrixOf(input.initial_cam_from_world));
}

class PythonCost final : public FrameCost {
 public:
  PythonCost(py::handle evaluate, std::string name, Callbacks* callbacks)
      : evaluate_(evaluate), name_(std::move(name)), callbacks_(callbacks) {}

  std::string_view name() const override { return name_; }

  bool Evaluate(const FrameCostInput& input, FrameCostValue* value) const override {
    callbacks_->Call([&] {
      const auto answer = py::cast<py::tuple>(evaluate_(*CostFrameOf(input)));
      const auto residuals = py::cast<py::array_t<double>>(answer[0]);
      const auto row = py::cast<py::array_t<std::int32_t>>(answer[1]);
      const auto column = py::cast<py::array_t<std::int32_t>>(answer[2]);
      const auto entry = py::cast<py::array_t<double>>(answer[3]);
      const auto r = residuals.unchecked<1>();
      for (py::ssize_t k = 0; k < r.shape(0); ++k) value->residuals.push_back(r(k));
      const auto of_row = row.unchecked<1>();
      const auto of_column = column.unchecked<1>();
      const auto of_entry = entry.unchecked<1>();
      value->jacobian.reserve(static_cast<std::size_t>(of_entry.shape(0)));
      for (py::ssize_t k = 0; k < of_entry.shape(0); ++k)
        value->jacobian.push_back({of_row(k), of_column(k), of_entry(k)});
    });
    return !callbacks_->failed();
  }

 private:
  py::handle evaluate_;
  std::string name_;
  Callbacks* callbacks_;
};

}  // namespace

std::shared_ptr<const FrameCost> FrameCostOf(const py::dict& given, Callbacks* callbacks) {
  const py::handle cost = given["cost"];
  if (cost.is_none()) return nullptr;
  return std::make_shared<PythonCost>(cost, py::cast<std::string>(given["cost_name"]), callbacks);
}

}  // namespace pliant::python
