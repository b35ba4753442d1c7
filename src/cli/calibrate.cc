// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "cli/progress.h"
#include "pliant/base/text.h"
#include "pliant/pipeline/calibrate_images.h"
#include "pliant/viewer/calibration_figure.h"
#include "pliant/viewer/output.h"

namespace pliant::cli {
namespace {

const Manual kCalibrateManual = {
    "calibrate",
    "camera.yaml from images or a video of a calibration board",
    "Reads --image_path: a folder of images or a video in which a flat board of known size is seen from many sides, "
    "through the camera and at the zoom and focus that the recordings will have. --board says which: "
    "chessboard:COLUMNSxROWS:SQUARE_MM with the number of INNER corners, charuco:COLUMNSxROWS:SQUARE_MM:MARKER_MM:"
    "DICTIONARY with the number of squares, circles:COLUMNSxROWS:SPACING_MM, or acircles:COLUMNSxROWS:SPACING_MM "
    "(asymmetric).\n\n"
    "Of a video the sharp frames that differ are chosen, images that fit badly are left out, and the camera model is "
    "chosen by images that are held out. Prints how far the result can be trusted: reprojection error, standard "
    "deviation of every parameter, and what is missing. --figure draws it. Writes --output_path at the end only.\n\n"
    "Of two cameras that see the board at the same time, --right_path names the images of the right one, in the same "
    "order, or --pairs says how each image holds both. Then --output_path becomes a stereo calibration (OpenCV's YAML) "
    "with the right camera's pose in the left one, in mm.\n\n"
    "Images that are mirrored give a mirrored camera; only ChArUco boards tell.\n\n"
    "Good images: 15 to 40, sharp, the board as large as half of the image, in its corners too, tilted by 30 to 45 "
    "degrees in several directions.",
    {"pliant calibrate --image_path board.mp4 --board chessboard:9x6:2.0 --output_path camera.yaml",
     "pliant calibrate --image_path boards --board charuco:8x5:10:7:5X5_100 --Calibrate.model OPENCV_FISHEYE "
     "--output_path camera.yaml --figure camera.png",
     "pliant calibrate --image_path pairs.mp4 --pairs left_right --board chessboard:9x6:2.0 --output_path stereo.yaml"},
};

// One line a parameter: name, value, standard deviation.
// `sigmas`: one each, 0 of a coefficient that the images do not determine and that is held, or none.
void SayParameters(const Camera& camera, const std::vector<double>& sigmas) {
  const std::string names(camera.Visit([](const auto& model) { return model.kParamNames; }));
  std::size_t i = 0;
  for (const std::string_view name : Split(names, ',')) {
    SayResult(Formatted("  %-4s %14.6g", std::string(name).c_str(), camera.params()[i]) +
              (sigmas.empty()  ? ""
               : sigmas[i] > 0 ? Formatted("  +- %.2g", sigmas[i])
                               : "  held"));
    ++i;
  }
}

int CountOf(const CalibrateSummary& summary, ImageUse use) {
  int count = 0;
  for (const CalibrationImage& image : summary.images) count += image.use == use ? 1 : 0;
  return count;
}

void SayImages(const CalibrateSummary& summary) {
  const auto searched = static_cast<int>(summary.images.size());
  std::string counts =
      Formatted("images        %d, %d searched, %d with the board, %d used", summary.images_read, searched,
                searched - CountOf(summary, ImageUse::kNoBoard), CountOf(summary, ImageUse::kUsed));
  if (const int alike = CountOf(summary, ImageUse::kAlike); alike > 0) counts += Formatted(", %d like others", alike);
  if (const int outliers = CountOf(summary, ImageUse::kOutlier); outliers > 0)
    counts += Formatted(", %d fit badly", outliers);
  SayResult(counts);
  for (const CalibrationImage& image : summary.images) {
    if (image.use == ImageUse::kNoBoard && searched > 20) continue;
    if (image.view_idx < 0) {
      if (image.use == ImageUse::kNoBoard)
        SayResult(Formatted("  %-24s %s", image.name.c_str(), std::string(EnumName(image.use)).c_str()));
      continue;
    }
    const FittedView& view = summary.calibration.views[static_cast<std::size_t>(image.view_idx)];
    SayResult(Formatted("  %-24s %6.2f px, tilted by %2.0f deg%s", image.name.c_str(), view.rms_px, view.tilt_deg,
                        view.is_outlier ? ", not used: fits badly" : ""));
  }
}

void Say(const CalibrateSummary& summary) {
  const CameraCalibration& calibration = summary.calibration;
  SayImages(summary);
  for (std::size_t i = 0; i < calibration.held_out.size(); ++i) {
    const HeldOutError& error = calibration.held_out[i];
    SayResult(Formatted("%s%s (%d parameters) %.3f px", i == 0 ? "held out      " : "              ",
                        std::string(EnumName(error.model)).c_str(), error.num_params, error.rms_px));
  }
  SayResult(Formatted("model         %s, %dx%d", std::string(calibration.camera.model_name()).c_str(),
                      calibration.camera.width(), calibration.camera.height()));
  SayParameters(calibration.camera, calibration.sigmas);
  SayResult(Formatted("error         %.3f px RMS", calibration.rms_px));
  SayResult("coverage      " + Percent(summary.covered_share) + " of the image");
  double border_px = 0;
  for (const PixelAccuracy& place : calibration.border) border_px = std::max(border_px, place.sigma_px);
  if (border_px > 0 && std::isfinite(border_px))
    SayResult(Formatted("border        known to %.2g px where it is known least", border_px));
  for (const std::string& advice : summary.advice) SayNote(advice);
}

void Say(const CalibratePairsSummary& summary) {
  const StereoCameras& stereo = summary.stereo;
  SayResult("left camera, alone");
  Say(summary.left);
  SayResult("right camera, alone");
  Say(summary.right);
  SayResult("left and right camera, together");
  SayParameters(stereo.left, {});  // they are known as well as alone, or better
  SayParameters(stereo.right, {});
  const auto pairs = static_cast<int>(stereo.is_outlier.size());
  const auto outliers = static_cast<int>(std::count(stereo.is_outlier.begin(), stereo.is_outlier.end(), true));
  SayResult(Formatted("pairs         %d, %d fit badly", pairs, outliers));
  SayResult(Formatted("error         %.3f px RMS in both", stereo.rms_px));
  const Eigen::Vector3d center = stereo.right_from_left.OriginInSource();
  SayResult(Formatted("baseline      %.4f mm +- %.2g: right camera at %.4f, %.4f, %.4f mm of the left one",
                      stereo.BaselineMm(), stereo.baseline_sigma_mm, center.x(), center.y(), center.z()));
  SayResult(Formatted("rotation      %.3f deg +- %.2g between the cameras",
                      kDegPerRad * RotationAngle(stereo.right_from_left.rotation), stereo.rotation_sigma_deg));
}

// "camera.png" of the right camera: "camera_right.png".
std::string RightFigurePath(const std::string& path) {
  const std::filesystem::path left(path);
  return (left.parent_path() / (left.stem().string() + "_right" + left.extension().string())).string();
}

// None, one, or of pairs one a camera.
std::vector<std::string> FigurePaths(const std::string& path, bool has_pairs) {
  if (path.empty()) return {};
  return has_pairs ? std::vector{path, RightFigurePath(path)} : std::vector{path};
}

// Nothing where they can be written; else an exit code.
std::optional<int> CheckOutputs(const CommandLine& line, const std::filesystem::path& output_path,
                                const std::vector<std::string>& figure_paths, ExistingFile existing) {
  Status status = CheckCalibrationOutput(output_path, existing);
  for (const std::string& path : figure_paths) {
    if (status.ok()) status = CheckEnding(ViewOutput::kFigure, path, "--figure");
    if (status.ok()) status = CheckCalibrationOutput(path, existing);
  }
  return status.ok() ? std::nullopt : std::optional(line.Failure(status));
}

// The outcome in words and pictures: none, or one a summary.
int Finish(const CommandLine& line, const std::string& output_path,
           const std::vector<const CalibrateSummary*>& summaries, const std::vector<std::string>& figure_paths) {
  SayResult(output_path);
  for (std::size_t i = 0; i < figure_paths.size(); ++i) {
    if (const Status status = WriteCalibrationFigure(*summaries[i], figure_paths[i]); !status.ok())
      return line.Failure(status.message());
    SayResult(figure_paths[i]);
  }
  return kExitOk;
}

// Nothing, or what is wrong with the command line.
std::string CheckPairs(const CalibrateRequest& request, ModelChoice model) {
  if (!request.right_path.empty() && request.pairs != PairLayout::kApart)
    return "--right_path and --pairs are two ways to give pairs; give one of them";
  if (request.HasPairs() && model == ModelChoice::kOpenCvFisheye)
    return "pairs of fisheye cameras cannot be rectified; choose a perspective --Calibrate.model, or calibrate one "
           "camera";
  return "";
}

}  // namespace

int CalibrateCommand(std::span<const std::string> args) {
  std::string image_path;
  std::string right_path;
  std::string board_text;
  std::string output_path;
  std::string figure_path;
  bool overwrite = false;
  CalibrateRequest request;
  CalibrateOptions options;
  CommandLine line(kCalibrateManual);
  line.Add("image_path", &image_path, "PATH", "folder of images, or video, of the board", Need::kRequired,
           Positional::kYes);
  line.Add("right_path", &right_path, "PATH", "those of a right camera at the same moments", Need::kOptional);
  line.AddChoice("pairs", &request.pairs,
                 "whether each image holds both views of a pair, the left one on the left, or on top");
  line.Add("board", &board_text, "BOARD", "kind, size and side of the board, such as chessboard:9x6:2.0",
           Need::kRequired);
  line.Add("output_path", &output_path, "FILE", "camera.yaml, or stereo.yaml of pairs, to write", Need::kRequired);
  line.AddFlag("overwrite", &overwrite, "replace the files to write if they are there");
  line.Add("figure", &figure_path, "FILE",
           "picture of the errors to write: .png, .svg or .pdf; of pairs a second one with _right behind its name",
           Need::kOptional);
  if (const auto exit = line.Parse(args)) return *exit;
  OptionTable table;
  options.List(table);
  if (const auto exit = line.Resolve(table)) return *exit;
  request.image_path = image_path;
  request.right_path = right_path;
  request.output_path = output_path;
  if (overwrite) request.existing = ExistingFile::kOverwrite;
  const auto board = ParseBoard(board_text);
  if (!board.ok()) return line.UsageError(board.status().message());
  request.board = *board;
  if (const Status status = CheckBoardIsSupported(*board); !status.ok()) return line.UsageError(status.message());
  if (const std::string wrong = CheckPairs(request, options.model); !wrong.empty()) return line.UsageError(wrong);
  const std::vector<std::string> figure_paths = FigurePaths(figure_path, request.HasPairs());
  if (const auto exit = CheckOutputs(line, request.output_path, figure_paths, request.existing)) return *exit;

  const auto with_bars = [&](const auto& calibrate) {
    return WithBars(
        StopOnSignals(), [&](const JobProgress& progress) { return calibrate(request, options, progress); }, "steps");
  };
  if (!request.HasPairs()) {
    const auto summary = with_bars(CalibrateImages);
    if (!summary.ok()) return line.Failure(summary.status().message());
    Say(*summary);
    return Finish(line, output_path, {&*summary}, figure_paths);
  }
  const auto summary = with_bars(CalibratePairs);
  if (!summary.ok()) return line.Failure(summary.status().message());
  Say(*summary);
  return Finish(line, output_path, {&summary->left, &summary->right}, figure_paths);
}

}  // namespace pliant::cli
