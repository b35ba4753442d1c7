// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <array>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "pliant/base/options.h"
#include "pliant/pipeline/image_tracker.h"
#include "python/arrays.h"
#include "python/bind.h"
#include "python/calibration.h"
#include "python/callbacks.h"
#include "python/errors.h"
#include "python/extensions.h"
#include "python/observations.h"
#include "python/options.h"

namespace py = pybind11;

namespace pliant::python {
namespace {

constexpr double kDefaultFps = 30.0;

// From one thread at a time, and not from what it calls itself; holds the interpreter's lock when it begins and ends.
class Busy {
 public:
  explicit Busy(bool* busy) : busy_(busy) {
    if (*busy) RaiseValueError("the tracker is busy with another image; call it from one thread");
    *busy = true;
  }
  ~Busy() { *busy_ = false; }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;

 private:
  bool* busy_;
};

// Numbers the images and gives them times.
class PythonTracker {
 public:
  PythonTracker(const Calibration& calibration, const py::object& options, const std::string& preset,
                const py::iterable& examples, const py::dict& extensions)
      : fps_(calibration.fps.value_or(kDefaultFps)),
        tracker_(Create(calibration, OptionsOf(options, MakeTrackOptions(EnumOf<Preset>(preset, "preset"))), examples,
                        extensions)) {}

  std::vector<FrameReport> Process(const py::object& image, const py::object& mask, const py::object& timestamp,
                                   const py::object& depth_prior) {
    if (finished_) RaiseValueError("the tracker is finished; make another one for other images");
    const Busy busy(&busy_);
    SequenceFrame frame = FrameOf(next_idx_, image, "the image");
    frame.mask = MaskOf(mask);
    frame.depth_prior = DepthPriorOf(depth_prior);
    frame.timestamp_s = timestamp.is_none() ? next_idx_ / fps_ : NumberOf(timestamp, "timestamp");
    auto reports = [&] {
      const py::gil_scoped_release release;
      return tracker_.Process(frame);
    }();
    RaiseFromCallback();
    if (reports.ok()) ++next_idx_;
    return ValueOf(std::move(reports));
  }

  std::vector<FrameReport> Finish() {
    const Busy busy(&busy_);
    if (std::exchange(finished_, true)) return {};
    auto reports = [&] {
      const py::gil_scoped_release release;
      return tracker_.Finish();
    }();
    RaiseFromCallback();
    return reports;
  }

  std::string state() const { return std::string(EnumName(tracker_.state())); }
  std::size_t held_count() const { return tracker_.held_count(); }
  double working_scale() const { return tracker_.working_image().scale; }

 private:
  static SequenceFrame FrameOf(int frame_idx, const py::handle& image, const std::string& title) {
    std::array<char, 32> name;
    std::snprintf(name.data(), name.size(), "%06d.png", frame_idx);
    SequenceFrame frame;
    frame.frame_idx = frame_idx;
    frame.name = name.data();
    frame.image = ImageOf(image, title);
    return frame;
  }

  // A frame without the answer of an extension is no frame to go on from.
  void RaiseFromCallback() {
    if (callbacks_.failed()) finished_ = true;
    callbacks_.RaiseError();
  }

  ImageTracker Create(const Calibration& calibration, const TrackOptions& options, const py::iterable& examples,
                      const py::dict& given) {
    std::vector<SequenceFrame> frames;
    for (const py::handle image : examples)
      frames.push_back(FrameOf(static_cast<int>(frames.size()), image, "example " + std::to_string(frames.size())));
    const TrackerExtensions extensions = ExtensionsOf(given, options.tracker, &callbacks_);
    return ValueOf([&] {
      const py::gil_scoped_release release;
      return ImageTracker::Create(calibration.camera, calibration.photometric, options, frames, extensions);
    }());
  }

  bool busy_ = false;
  double fps_;
  Callbacks callbacks_;
  ImageTracker tracker_;
  int next_idx_ = 0;
  bool finished_ = false;
};

template <class Value>
py::dict DictOf(const std::vector<std::pair<std::string, Value>>& pairs) {
  py::dict dict;
  for (const auto& [name, value] : pairs) dict[py::str(name)] = value;
  return dict;
}

py::object Pose(const FrameReport& report) {
  return report.cam_from_world ? py::object(MatrixOf(*report.cam_from_world)) : py::none();
}

py::object InversePose(const FrameReport& report) {
  return report.cam_from_world ? py::object(MatrixOf(report.cam_from_world->Inverse())) : py::none();
}

py::object ObservationsOf(const FrameReport& report) {
  ObservationColumns columns;
  columns.Append(report.frame_idx, report.observations);
  return columns.Take();
}

py::dict CostsOf(const FrameReport& report) {
  py::dict costs;
  for (const CostTerm& term : report.costs) costs[py::str(term.name)] = term.value;
  return costs;
}

void BindReport(py::module_& module) {
  py::class_<FrameReport>(module, "FrameReport", "What is known of one frame when it is final.")
      .def_readonly("frame_idx", &FrameReport::frame_idx, "Number of the frame, from 0.")
      .def_readonly("name", &FrameReport::name, "Name of the image.")
      .def_readonly("timestamp", &FrameReport::timestamp_s, "Seconds.")
      .def_property_readonly(
          "state", [](const FrameReport& r) { return std::string(EnumName(r.state)); },
          "waiting_for_reference, initializing, ambiguous, tracking, provisional or lost (docs/concepts.md).")
      .def_readonly("note", &FrameReport::note, "Why the state is what it is: a sentence, or empty.")
      .def_readonly("submap", &FrameReport::submap, "The map that pose and points are in: each has its own world.")
      .def_property_readonly("cam_from_world", &Pose,
                             "(4, 4) float64, or None: no pose. point_in_cam = cam_from_world @ point_in_world.")
      .def_property_readonly("world_from_cam", &InversePose, "The inverse of cam_from_world, or None.")
      .def_property_readonly("observations", &ObservationsOf,
                             "pliant.Observations of this frame, sorted by point_id; empty where there is no pose.")
      .def_readonly("tracked", &FrameReport::tracked, "Points followed into this frame.")
      .def_readonly("optimized", &FrameReport::optimized, "Points of the solution.")
      .def_readonly("lost", &FrameReport::lost, "Points given up in this frame.")
      .def_readonly("added", &FrameReport::added, "Points new in this frame.")
      .def_property_readonly(
          "losses", [](const FrameReport& r) { return DictOf(r.losses); }, "Points given up, by reason.")
      .def_property_readonly("costs", &CostsOf, "Cost terms at the solution, by name.")
      .def_property_readonly(
          "stage_ms", [](const FrameReport& r) { return DictOf(r.stage_ms); }, "Wall time, ms, by stage.")
      .def_readonly("median_reprojection_error_px", &FrameReport::median_reprojection_error_px, "Pixels.")
      .def("__repr__", [](const FrameReport& r) {
        return "<pliant.FrameReport " + r.name + ": " + std::string(EnumName(r.state)) + ", " +
               std::to_string(r.observations.size()) + " points>";
      });
}

}  // namespace

void BindTracker(py::module_& module) {
  BindReport(module);
  py::class_<PythonTracker>(
      module, "Tracker",
      "The tracker of pliant.Tracker, which makes `extensions` of what the program gives, and holds them: "
      "a cycle through them is one that Python finds.")
      .def(py::init<const Calibration&, const py::object&, const std::string&, const py::iterable&, const py::dict&>(),
           py::arg("camera"), py::arg("options"), py::arg("preset"), py::arg("examples"), py::arg("extensions"))
      .def("process", &PythonTracker::Process, py::arg("image"), py::arg("mask") = py::none(),
           py::arg("timestamp") = py::none(), py::arg("depth_prior") = py::none(),
           "The reports that became final with this image, in order of time; each image is reported once.\n\n"
           "image: uint8 (height, width), or (height, width, 3) in the order blue, green, red, of the camera's size; "
           "it is copied. mask: uint8 or bool (height, width), 0: ignore this pixel. timestamp: seconds; without it "
           "number / fps of the camera (30 where it has none). depth_prior: float32 or float64 (height, width), the "
           "depth of another program, up to a scale and a shift (options DepthPrior); 0 or NaN: none.\n\n"
           "From the reference image on reports are held back until there is a map, which gives these frames too "
           "their poses and points.")
      .def("finish", &PythonTracker::Finish, "No more images come: the reports that are held back.")
      .def_property_readonly("state", &PythonTracker::state, "The state after the last image.")
      .def_property_readonly("held", &PythonTracker::held_count, "How many reports are held back.")
      .def_property_readonly("working_scale", &PythonTracker::working_scale,
                             "Size of the images that points are tracked in, by that of the given ones.");
}

}  // namespace pliant::python
