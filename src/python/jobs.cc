// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <filesystem>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "pliant/base/job_progress.h"
#include "pliant/evaluation/compare_runs.h"
#include "pliant/evaluation/evaluate_run.h"
#include "pliant/evaluation/report.h"
#include "pliant/evaluation/stir_error.h"
#include "pliant/exchange/export.h"
#include "pliant/exchange/import.h"
#include "pliant/pipeline/calibrate_images.h"
#include "pliant/pipeline/join_runs.h"
#include "pliant/pipeline/refine_run.h"
#include "pliant/pipeline/surface_run.h"
#include "pliant/simulation/write_sequence.h"
#include "pliant/viewer/calibration_figure.h"
#include "pliant/viewer/comparison_figure.h"
#include "pliant/viewer/figure.h"
#include "pliant/viewer/output.h"
#include "pliant/viewer/report.h"
#include "python/arrays.h"
#include "python/bind.h"
#include "python/calibration.h"
#include "python/errors.h"
#include "python/interrupt.h"
#include "python/options.h"

namespace py = pybind11;

namespace pliant::python {
namespace {

using Texts = std::vector<std::string>;

// The texts of `request`, by the names of their fields.
std::string Text(const py::dict& request, const char* name) { return py::cast<std::string>(request[name]); }
Texts AllTexts(const py::dict& request, const char* name) { return py::cast<Texts>(request[name]); }

// Calls the library without the GIL, and raises what a callback or a signal left.
template <class Job>
auto WithoutGil(Interrupt* interrupt, const Job& job) {
  auto result = [&] {
    const py::gil_scoped_release release;
    return job();
  }();
  interrupt->Raise();
  return result;
}

// Tells Python how far a job is; ends it when that raises, or on Ctrl-C.
JobProgress Telling(const py::object& on_progress, Interrupt* interrupt) {
  return [&on_progress, interrupt](std::string_view task, int done, int total) {
    if (!on_progress.is_none()) interrupt->Call([&] { on_progress(std::string(task), done, total); });
    return !interrupt->stop().load();
  };
}

void Simulate(const std::string& output_path, const py::object& options, const std::string& realism,
              const py::object& on_progress) {
  const auto simulation = OptionsOf(options, MakeSimulationOptions(EnumOf<Realism>(realism, "realism")));
  Interrupt interrupt;
  Texts warnings;
  const Status status = WithoutGil(&interrupt, [&] {
    auto simulator = Simulator::Create(simulation);
    if (!simulator.ok()) return simulator.status();
    warnings = simulator->warnings();
    return WriteSequence(*simulator, output_path, [&](int done, int total) {
      if (!on_progress.is_none()) interrupt.Call([&] { on_progress(done, total); });
      return interrupt.stop() ? SimulationContinue::kStop : SimulationContinue::kYes;
    });
  });
  Warn(warnings);
  RaiseUnlessOk(status);
}

ExistingFile ExistingOf(const py::dict& request) {
  return py::cast<bool>(request["overwrite"]) ? ExistingFile::kOverwrite : ExistingFile::kKeep;
}

// The camera, a standard deviation a parameter, and what else the calibration says of itself.
py::dict CalibrationDict(const CalibrateSummary& summary) {
  std::vector<std::tuple<std::string, std::string, std::optional<double>>> images;
  for (const CalibrationImage& image : summary.images) {
    const bool is_view = image.view_idx >= 0;
    const auto view = static_cast<std::size_t>(image.view_idx);
    images.emplace_back(image.name, EnumName(image.use),
                        is_view ? std::optional(summary.calibration.views[view].rms_px) : std::nullopt);
  }
  using py::literals::operator""_a;
  return py::dict("camera"_a = Calibration{summary.calibration.camera}, "sigmas"_a = summary.calibration.sigmas,
                  "error_px"_a = summary.calibration.rms_px, "covered_share"_a = summary.covered_share,
                  "advice"_a = summary.advice, "images"_a = images);
}

py::dict Calibrate(const py::dict& request, const py::object& options, const py::object& on_progress) {
  const auto calibrate_options = OptionsOf<CalibrateOptions>(options);
  const std::string figure = Text(request, "figure");
  if (!figure.empty()) RaiseUnlessOk(CheckEnding(ViewOutput::kFigure, figure, "figure"));
  RaiseUnlessOk(CheckCalibrationOutput(figure, ExistingOf(request)));
  const CalibrateRequest calibrate_request{.image_path = Text(request, "image_path"),
                                           .board = ValueOf(ParseBoard(Text(request, "board"))),
                                           .output_path = Text(request, "output_path"),
                                           .existing = ExistingOf(request)};
  Interrupt interrupt;
  const auto summary = ValueOf(WithoutGil(&interrupt, [&] {
    return CalibrateImages(calibrate_request, calibrate_options, Telling(on_progress, &interrupt));
  }));
  if (!figure.empty()) RaiseUnlessOk(WriteCalibrationFigure(summary, figure));
  return CalibrationDict(summary);
}

// Both cameras, alone and together.
py::dict CalibrateStereoPairs(const py::dict& request, const py::object& options, const py::object& on_progress) {
  const auto calibrate_options = OptionsOf<CalibrateOptions>(options);
  const CalibrateRequest calibrate_request{.image_path = Text(request, "image_path"),
                                           .board = ValueOf(ParseBoard(Text(request, "board"))),
                                           .output_path = Text(request, "output_path"),
                                           .right_path = Text(request, "right_path"),
                                           .pairs = EnumOf<PairLayout>(Text(request, "pairs"), "pairs"),
                                           .existing = ExistingOf(request)};
  Interrupt interrupt;
  const auto summary = ValueOf(WithoutGil(&interrupt, [&] {
    return CalibratePairs(calibrate_request, calibrate_options, Telling(on_progress, &interrupt));
  }));
  const StereoCameras& stereo = summary.stereo;
  using py::literals::operator""_a;
  return py::dict("left"_a = CalibrationDict(summary.left), "right"_a = CalibrationDict(summary.right),
                  "left_camera"_a = Calibration{stereo.left}, "right_camera"_a = Calibration{stereo.right},
                  "right_from_left"_a = MatrixOf(stereo.right_from_left), "baseline_mm"_a = stereo.BaselineMm(),
                  "baseline_sigma_mm"_a = stereo.baseline_sigma_mm, "error_px"_a = stereo.rms_px);
}

void Refine(const py::dict& request, const py::object& options, const py::object& on_progress) {
  const auto refine_options = OptionsOf<RefineOptions>(options);
  Interrupt interrupt;
  const RefineRequest refine_request{.run_path = Text(request, "run_path"),
                                     .sequence_path = Text(request, "sequence_path"),
                                     .camera_path = Text(request, "camera_path"),
                                     .output_path = Text(request, "output_path"),
                                     .command_line = {"pliant.refine"},
                                     .stop = &interrupt.stop()};
  const auto summary = ValueOf(WithoutGil(&interrupt, [&] {
    return RefineRun(refine_request, refine_options, [&](const RefinementProgress& at) {
      if (!on_progress.is_none()) interrupt.Call([&] { on_progress(std::string(at.stage), at.share, at.cost); });
    });
  }));
  Texts left;
  for (const SubmapRefinement& submap : summary.submaps)
    if (!submap.failure.empty())
      left.push_back("submap " + std::to_string(submap.submap) +
                     " is as it was, since it cannot be refined: " + submap.failure);
  Warn(left);
}

void Surface(const py::dict& request, const std::vector<int>& frames, const py::object& options,
             const py::object& on_progress) {
  const auto surface_options = OptionsOf<SurfaceRunOptions>(options);
  Interrupt interrupt;
  const SurfaceRequest surface_request{.run_path = Text(request, "run_path"),
                                       .sequence_path = Text(request, "sequence_path"),
                                       .camera_path = Text(request, "camera_path"),
                                       .mask_path = Text(request, "mask_path"),
                                       .output_path = Text(request, "output_path"),
                                       .frames = frames,
                                       .command_line = {"pliant.surface"},
                                       .stop = &interrupt.stop()};
  const auto summary = ValueOf(WithoutGil(&interrupt, [&] {
    return MakeSurface(surface_request, surface_options,
                       [&](SurfaceStage stage, int done, int total, double /*known_share*/) {
                         if (on_progress.is_none()) return;
                         const char* name = stage == SurfaceStage::kDepth ? "depth" : "mesh";
                         interrupt.Call([&] { on_progress(name, done, total); });
                       });
  }));
  Warn(summary.warnings);
}

// evaluation.json.
std::string Evaluate(const py::dict& request, const py::object& options, const py::object& on_progress) {
  const auto evaluation_options = OptionsOf<EvaluationOptions>(options);
  const EvaluationRequest evaluation_request{
      .run_path = Text(request, "run_path"),
      .sequence_path = Text(request, "sequence_path"),
      .camera_path = Text(request, "camera_path"),
      .sfm_path = Text(request, "sfm_path"),
      .surface_path = Text(request, "surface_path"),
      .other_runs = AllTexts(request, "other_runs"),
      .track_file = {.path = Text(request, "tracks_path"),
                     .pixel_origin = EnumOf<PixelOrigin>(Text(request, "tracks_pixel_origin"), "tracks_pixel_origin")}};
  const std::string output_path = Text(request, "output_path");
  Interrupt interrupt;
  const auto evaluation = ValueOf(WithoutGil(&interrupt, [&] {
    return EvaluateRun(evaluation_request, evaluation_options, Telling(on_progress, &interrupt));
  }));
  if (!output_path.empty()) RaiseUnlessOk(WriteEvaluation(evaluation, output_path));
  return EvaluationJson(evaluation);
}

// stir.json.
std::string EvaluateStirFiles(const std::string& tracked, const std::string& start, const std::string& end,
                              const std::string& output_path) {
  Interrupt interrupt;
  const auto error = ValueOf(WithoutGil(
      &interrupt, [&] { return EvaluateStir({.tracked_path = tracked, .start_path = start, .end_path = end}); }));
  if (!output_path.empty()) RaiseUnlessOk(WriteStirError(error, output_path));
  return StirJson(error);
}

// A dictionary a joint, in the order of time.
py::list Join(const py::dict& request, const py::object& options, const py::object& on_progress) {
  const auto join_options = OptionsOf<JoinOptions>(options);
  const JoinRequest join_request{.run_paths = AllTexts(request, "run_paths"),
                                 .sequence_path = Text(request, "sequence_path"),
                                 .camera_path = Text(request, "camera_path"),
                                 .output_path = Text(request, "output_path"),
                                 .command_line = {"pliant.join"}};
  Interrupt interrupt;
  const auto summary = ValueOf(
      WithoutGil(&interrupt, [&] { return JoinRuns(join_request, join_options, Telling(on_progress, &interrupt)); }));
  py::list joints;
  using py::literals::operator""_a;
  for (const RunJoint& joint : summary.joints)
    joints.append(py::dict("run"_a = joint.run, "before"_a = joint.before, "frames"_a = joint.frames,
                           "points"_a = joint.points, "scale"_a = joint.scale,
                           "depth_difference"_a = joint.depth_difference, "depth_spread"_a = joint.depth_spread,
                           "same_points"_a = joint.same_points, "failure"_a = joint.failure));
  return joints;
}

// comparison.json of the runs that can be evaluated; the others are warnings.
std::string Compare(const py::dict& request, const py::object& options, const py::object& on_progress) {
  const auto evaluation_options = OptionsOf<EvaluationOptions>(options);
  const CompareRequest compare_request{.run_paths = AllTexts(request, "run_paths"),
                                       .sequence_paths = AllTexts(request, "sequence_paths"),
                                       .camera_path = Text(request, "camera_path")};
  const std::string output_path = Text(request, "output_path");
  const std::string figure = Text(request, "figure_path");
  if (!figure.empty()) RaiseUnlessOk(CheckEnding(ViewOutput::kFigure, figure, "figure"));
  Interrupt interrupt;
  const auto comparison = ValueOf(WithoutGil(
      &interrupt, [&] { return CompareRuns(compare_request, evaluation_options, Telling(on_progress, &interrupt)); }));
  const std::vector<Evaluation> evaluated = comparison.Evaluated();
  if (evaluated.empty()) Raise(comparison.failures.front());
  if (!output_path.empty()) RaiseUnlessOk(WriteRunComparison(comparison, output_path));
  if (!figure.empty()) RaiseUnlessOk(WriteComparisonFigure(evaluated, figure));
  Texts failures;
  for (const Status& failure : comparison.failures) failures.push_back(failure.message());
  Warn(failures);
  return ComparisonJson(evaluated);
}

// What was left out, a sentence each.
Texts ImportAny(const py::dict& request, const py::object& options, const py::object& on_progress) {
  const auto import_options = OptionsOf<ImportOptions>(options);
  const ImportRequest import_request{.input_path = Text(request, "input_path"),
                                     .sequence_path = Text(request, "sequence_path"),
                                     .camera_path = Text(request, "camera_path"),
                                     .format = EnumOf<ImportFormat>(Text(request, "format"), "format"),
                                     .as = EnumOf<ImportAs>(Text(request, "as"), "as"),
                                     .output_path = Text(request, "output_path"),
                                     .command_line = {"pliant.import_result"}};
  Interrupt interrupt;
  return ValueOf(WithoutGil(&interrupt,
                            [&] { return Import(import_request, import_options, Telling(on_progress, &interrupt)); }))
      .notes;
}

py::dict Export(const py::dict& request, const py::object& options, const py::object& on_progress) {
  const auto export_options = OptionsOf<ExportOptions>(options);
  const ExportRequest export_request{.run_path = Text(request, "run_path"),
                                     .sequence_path = Text(request, "sequence_path"),
                                     .format = Text(request, "format"),
                                     .output_path = Text(request, "output_path"),
                                     .camera_path = Text(request, "camera_path"),
                                     .mask_path = Text(request, "mask_path"),
                                     .surface_path = Text(request, "surface_path")};
  Interrupt interrupt;
  const auto summary = ValueOf(WithoutGil(
      &interrupt, [&] { return ExportRun(export_request, export_options, Telling(on_progress, &interrupt)); }));
  py::dict done;
  done["frames"] = summary.frames;
  done["points"] = summary.points;
  done["observations"] = summary.observations;
  done["notes"] = summary.notes;
  return done;
}

Result<Texts> WritePage(const ViewRequest& view, const ReportOptions& options, const std::string& output_path,
                        const JobProgress& progress) {
  const auto summary = WriteReportPage(view, options, output_path, progress);
  if (!summary.ok()) return summary.status();
  return summary->notes;
}

// What is missing, a sentence each. The ending of `output_path` says what is written.
Texts Report(const py::dict& request, const std::vector<int>& frames, const py::object& options,
             const py::object& on_progress) {
  ReportOptions report_options;
  FigureOptions figure_options;
  OptionTable table;
  report_options.List(table);
  figure_options.List(table);
  SetOptions(options, &table);
  figure_options.view = report_options.view;
  const ViewRequest view{.run_paths = AllTexts(request, "run_paths"),
                         .sequence_path = Text(request, "sequence_path"),
                         .camera_path = Text(request, "camera_path"),
                         .surface_paths = AllTexts(request, "surface_paths")};
  const std::string output_path = Text(request, "output_path");
  const ViewOutput output = !frames.empty()                                            ? ViewOutput::kFigure
                            : std::filesystem::path(output_path).extension() == ".mp4" ? ViewOutput::kFilm
                                                                                       : ViewOutput::kPage;
  RaiseUnlessOk(CheckEnding(output, output_path));
  Interrupt interrupt;
  return ValueOf(WithoutGil(&interrupt, [&]() -> Result<Texts> {
    const JobProgress progress = Telling(on_progress, &interrupt);
    if (output == ViewOutput::kFigure) return WriteFigure(view, figure_options, frames, output_path, progress);
    if (output == ViewOutput::kPage) return WritePage(view, report_options, output_path, progress);
    return WriteFilm(view, figure_options, output_path,
                     [&](int done, int total) { return progress("film", done, total); });
  }));
}

}  // namespace

void BindJobs(py::module_& module) {
  module.def("simulate", &Simulate);
  module.def("calibrate", &Calibrate);
  module.def("calibrate_stereo", &CalibrateStereoPairs);
  module.def("refine", &Refine);
  module.def("join", &Join);
  module.def("surface", &Surface);
  module.def("evaluate", &Evaluate);
  module.def("evaluate_stir", &EvaluateStirFiles);
  module.def("compare", &Compare);
  module.def("import_result", &ImportAny);
  module.def("export", &Export);
  module.def("report", &Report);
}

}  // namespace pliant::python
