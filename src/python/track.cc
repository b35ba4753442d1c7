// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/pipeline/track.h"

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "python/bind.h"
#include "python/calibration.h"
#include "python/errors.h"
#include "python/extensions.h"
#include "python/images.h"
#include "python/interrupt.h"
#include "python/options.h"

namespace py = pybind11;

namespace pliant::python {
namespace {

class PythonObserver final : public TrackObserver {
 public:
  PythonObserver(py::object on_frame, Interrupt* interrupt) : on_frame_(std::move(on_frame)), interrupt_(interrupt) {}

  void OnStart(int /*frames*/) override {}
  void OnWarning(const std::string& sentence) override { warnings_.push_back(sentence); }
  void OnFrame(const FrameReport& report) override {
    if (!on_frame_.is_none()) interrupt_->Call([&] { on_frame_(report); });
  }
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  py::object on_frame_;
  Interrupt* interrupt_;
  std::vector<std::string> warnings_;
};

void RunAndRaise(const py::dict& input, RunRequest request, const py::object& options, const std::string& preset,
                 const py::object& on_frame, const PythonImages* images) {
  const TrackOptions track_options = OptionsOf(options, MakeTrackOptions(EnumOf<Preset>(preset, "preset")));
  Interrupt interrupt;
  PythonObserver observer(on_frame, &interrupt);
  request.stop = &interrupt.stop();
  request.command_line = {"pliant.track"};
  request.extensions = ExtensionsOf(input, track_options.tracker, &interrupt);
  const Result<RunSummary> summary = [&] {
    const py::gil_scoped_release release;
    return RunTrack(request, track_options, std::array<TrackObserver*, 1>{&observer});
  }();
  interrupt.Raise();
  // Images are read ahead: one that fails after the run's end is nobody's.
  const bool has_failed = !summary.ok() || summary->status == RunStatus::kFailed;
  if (images != nullptr && has_failed) images->Raise();
  Warn(observer.warnings());
  RaiseUnlessOk(EndOf(ValueOf(summary), request.output_path));
}

// `input`: the fields of a SequenceRequest by name, and those of ExtensionsOf.
void TrackPath(const py::dict& input, const std::string& output_path, const py::object& options,
               const std::string& preset, const py::object& on_frame) {
  RunRequest request;
  request.input = {.image_path = py::cast<std::filesystem::path>(input["image_path"]),
                   .camera_path = py::cast<std::filesystem::path>(input["camera_path"]),
                   .mask_path = py::cast<std::filesystem::path>(input["mask_path"]),
                   .start = py::cast<int>(input["start"]),
                   .end = py::cast<int>(input["end"]),
                   .stride = py::cast<int>(input["stride"])};
  request.output_path = output_path;
  request.resume = py::cast<bool>(input["resume"]);
  RunAndRaise(input, std::move(request), options, preset, on_frame, nullptr);
}

// `input`: images, camera, timestamps (a list, empty: by the camera's rate), and fields of a SequenceRequest
// and of ExtensionsOf by name.
void TrackImages(const py::dict& input, const std::string& output_path, const py::object& options,
                 const std::string& preset, const py::object& on_frame) {
  const auto& calibration = py::cast<const Calibration&>(input["camera"]);
  const auto images = std::make_shared<PythonImages>(input["images"]);
  GivenImages given{.camera = calibration.camera,
                    .photometric = calibration.photometric,
                    .timestamps_s = py::cast<std::vector<double>>(input["timestamps"]),
                    .images = images};
  given.fps = calibration.fps.value_or(given.fps);
  RunRequest request;
  request.input = {.mask_path = py::cast<std::filesystem::path>(input["mask_path"]),
                   .start = py::cast<int>(input["start"]),
                   .end = py::cast<int>(input["end"]),
                   .stride = py::cast<int>(input["stride"]),
                   .given = std::make_shared<GivenImages>(std::move(given))};
  request.output_path = output_path;
  RunAndRaise(input, std::move(request), options, preset, on_frame, images.get());
}

}  // namespace

void BindTrack(py::module_& module) {
  module.def("track_path", &TrackPath);
  module.def("track_images", &TrackImages);
}

}  // namespace pliant::python
