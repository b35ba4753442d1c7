// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "pliant/base/options.h"
#include "pliant/datasets/run_sequence.h"
#include "pliant/io/run_reader.h"
#include "python/arrays.h"
#include "python/bind.h"
#include "python/calibration.h"
#include "python/errors.h"
#include "python/observations.h"

namespace py = pybind11;

namespace pliant::python {
namespace {

py::object Table(const char* name) { return py::module_::import("pliant.tables").attr(name); }

// `value(row)` of every row.
template <class T, class Rows, class Value>
py::array_t<T> Column(const Rows& rows, const Value& value) {
  std::vector<T> column;
  column.reserve(rows.size());
  for (const auto& row : rows) column.push_back(value(row));
  return ArrayOf(std::move(column));
}

py::dict FrameColumns(const Run& run) {
  const std::vector<RunFrame>& frames = run.frames;
  py::dict columns;
  const auto count = [&](const char* name, int RunFrame::*member) {
    columns[name] = Column<std::int32_t>(frames, [&](const RunFrame& frame) { return frame.*member; });
  };
  count("frame_idx", &RunFrame::frame_idx);
  columns["timestamp"] = Column<double>(frames, [](const RunFrame& frame) { return frame.timestamp_s; });
  py::list states;
  for (const RunFrame& frame : frames) states.append(std::string(EnumName(frame.state)));
  columns["state"] = py::module_::import("numpy").attr("array")(states, py::arg("dtype") = "U24");
  count("submap", &RunFrame::submap);
  count("tracked", &RunFrame::tracked);
  count("optimized", &RunFrame::optimized);
  count("lost", &RunFrame::lost);
  count("added", &RunFrame::added);
  columns["median_reprojection_error_px"] =
      Column<double>(frames, [](const RunFrame& frame) { return frame.median_reprojection_error_px; });
  py::dict costs;
  for (std::size_t k = 0; !frames.empty() && k < frames.front().costs.size(); ++k)
    costs[py::str(frames.front().costs[k].name)] =
        Column<double>(frames, [&](const RunFrame& frame) { return frame.costs[k].value; });
  columns["costs"] = costs;
  py::dict stage_ms;
  for (std::size_t k = 0; k < run.stage_names.size(); ++k)
    stage_ms[py::str(run.stage_names[k])] =
        Column<double>(frames, [&](const RunFrame& frame) { return frame.stage_ms[k]; });
  columns["stage_ms"] = stage_ms;
  columns["latency_ms"] = Column<double>(frames, [](const RunFrame& frame) { return frame.latency_ms; });
  return columns;
}

py::dict PoseColumns(const std::vector<RunPose>& poses) {
  std::vector<double> world_from_cam;
  std::vector<double> cam_from_world;
  for (const RunPose& pose : poses) {
    AppendMatrix(pose.world_from_cam, &world_from_cam);
    AppendMatrix(pose.world_from_cam.Inverse(), &cam_from_world);
  }
  py::dict columns;
  columns["frame_idx"] = Column<std::int32_t>(poses, [](const RunPose& pose) { return pose.frame_idx.value_or(-1); });
  columns["timestamp"] = Column<double>(poses, [](const RunPose& pose) { return pose.timestamp_s; });
  columns["world_from_cam"] = ArrayOf(std::move(world_from_cam), {4, 4});
  columns["cam_from_world"] = ArrayOf(std::move(cam_from_world), {4, 4});
  columns["submap"] = Column<std::int32_t>(poses, [](const RunPose& pose) { return pose.submap; });
  return columns;
}

// (Frames, Poses).
py::tuple ReadRunTables(const std::string& path) {
  const Run run = ValueOf([&] {
    const py::gil_scoped_release release;
    return ReadRun(path);
  }());
  return py::make_tuple(Table("Frames")(**FrameColumns(run)), Table("Poses")(**PoseColumns(run.poses)));
}

// Hardly a row of a run is shorter.
constexpr std::size_t kBytesOfRow = 48;

Result<ObservationColumns> ReadColumns(const std::string& path) {
  auto reader = ObservationReader::Open(path);
  if (!reader.ok()) return reader.status();
  ObservationColumns columns;
  std::error_code error;
  if (const auto bytes = std::filesystem::file_size(path + "/observations.csv", error); !error)
    columns.Reserve(bytes / kBytesOfRow);
  while (true) {
    const auto frame = reader->Next();
    if (!frame.ok()) return frame.status();
    if (!frame->has_value()) return columns;
    columns.Append((*frame)->frame_idx, (*frame)->observations);
  }
}

py::object ReadObservations(const std::string& path) {
  ObservationColumns columns = ValueOf([&] {
    const py::gil_scoped_release release;
    return ReadColumns(path);
  }());
  return columns.Take();
}

Result<RunMap> ReadKnownMap(const std::string& path) {
  const auto run = ReadRun(path);
  if (!run.ok()) return run.status();
  return KnownMapOfRun(path, SequenceOfRun(path), *run);
}

// (camera or None, {frame: image name}, Points).
py::tuple ReadMap(const std::string& path) {
  const RunMap map = ValueOf([&] {
    const py::gil_scoped_release release;
    return ReadKnownMap(path);
  }());
  std::vector<std::int64_t> ids;
  std::vector<double> positions;
  std::vector<std::uint8_t> rgb;
  for (const auto& [id, point] : map.points) {
    ids.push_back(id.value);
    positions.insert(positions.end(), point.position.data(), point.position.data() + 3);
    rgb.insert(rgb.end(), point.rgb.begin(), point.rgb.end());
  }
  py::object camera = py::none();
  if (map.camera) camera = py::cast(Calibration{*map.camera});
  return py::make_tuple(
      camera, map.names,
      Table("Points")(ArrayOf(std::move(ids)), ArrayOf(std::move(positions), {3}), ArrayOf(std::move(rgb), {3})));
}

}  // namespace

void ObservationColumns::Reserve(std::size_t rows) {
  frame_idx_.reserve(rows);
  point_id_.reserve(rows);
  pixel_.reserve(2 * rows);
  position_.reserve(3 * rows);
  ssim_.reserve(rows);
  sigma_.reserve(rows);
}

// Millions of rows come: each column grows once a frame, and is then written in place.
void ObservationColumns::Append(int frame_idx, std::span<const PointObservation> observations) {
  const std::size_t before = point_id_.size();
  const std::size_t count = before + observations.size();
  frame_idx_.resize(count, frame_idx);
  point_id_.resize(count);
  pixel_.resize(2 * count);
  position_.resize(3 * count);
  ssim_.resize(count);
  sigma_.resize(count);
  for (std::size_t row = before; const PointObservation& seen : observations) {
    point_id_[row] = seen.id.value;
    std::copy_n(seen.pixel.data(), 2, &pixel_[2 * row]);
    std::copy_n(seen.position.data(), 3, &position_[3 * row]);
    ssim_[row] = seen.ssim;
    sigma_[row] = seen.sigma;
    ++row;
  }
}

py::object ObservationColumns::Take() {
  return Table("Observations")(ArrayOf(std::move(frame_idx_)), ArrayOf(std::move(point_id_)),
                               ArrayOf(std::move(pixel_), {2}), ArrayOf(std::move(position_), {3}),
                               ArrayOf(std::move(ssim_)), ArrayOf(std::move(sigma_)));
}

void BindRun(py::module_& module) {
  module.def("read_run", &ReadRunTables, py::arg("path"));
  module.def("read_observations", &ReadObservations, py::arg("path"));
  module.def("read_map", &ReadMap, py::arg("path"));
}

}  // namespace pliant::python
