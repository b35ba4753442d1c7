// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cstdio>
#include <optional>

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

const Manual kManual = {
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
    "Good images: 15 to 40, sharp, the board as large as half of the image, in its corners too, tilted by 30 to 45 "
    "degrees in several directions.",
    {"pliant calibrate --image_path board.mp4 --board chessboard:9x6:2.0 --output_path camera.yaml",
     "pliant calibrate --image_path boards --board charuco:8x5:10:7:5X5_100 --Calibrate.model OPENCV_FISHEYE "
     "--output_path camera.yaml --figure camera.png"},
};

template <class... Values>
std::string Text(const char* format, Values... values) {
  std::array<char, 256> text;
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

// One line a parameter: name, value, standard deviation.
void SayParameters(const CameraCalibration& calibration) {
  const std::string names(calibration.camera.Visit([](const auto& model) { return model.kParamNames; }));
  std::size_t i = 0;
  for (const std::string_view name : Split(names, ',')) {
    SayResult(Text("  %-4s %14.6g  +- %.2g", std::string(name).c_str(), calibration.camera.params()[i],
                   calibration.sigmas[i]));
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
  std::string counts = Text("images        %d, %d searched, %d with the board, %d used", summary.images_read, searched,
                            searched - CountOf(summary, ImageUse::kNoBoard), CountOf(summary, ImageUse::kUsed));
  if (const int alike = CountOf(summary, ImageUse::kAlike); alike > 0) counts += Text(", %d like others", alike);
  if (const int outliers = CountOf(summary, ImageUse::kOutlier); outliers > 0)
    counts += Text(", %d fit badly", outliers);
  SayResult(counts);
  for (const CalibrationImage& image : summary.images) {
    if (image.use == ImageUse::kNoBoard && searched > 20) continue;
    if (image.view_idx < 0) {
      if (image.use == ImageUse::kNoBoard)
        SayResult(Text("  %-24s %s", image.name.c_str(), std::string(EnumName(image.use)).c_str()));
      continue;
    }
    const FittedView& view = summary.calibration.views[static_cast<std::size_t>(image.view_idx)];
    SayResult(Text("  %-24s %6.2f px, tilted by %2.0f deg%s", image.name.c_str(), view.rms_px, view.tilt_deg,
                   view.is_outlier ? ", not used: fits badly" : ""));
  }
}

void Say(const CalibrateSummary& summary) {
  const CameraCalibration& calibration = summary.calibration;
  SayImages(summary);
  for (std::size_t i = 0; i < calibration.held_out.size(); ++i) {
    const HeldOutError& error = calibration.held_out[i];
    SayResult(Text("%s%s (%d parameters) %.3f px", i == 0 ? "held out      " : "              ",
                   std::string(EnumName(error.model)).c_str(), error.num_params, error.rms_px));
  }
  SayResult(Text("model         %s, %dx%d", std::string(calibration.camera.model_name()).c_str(),
                 calibration.camera.width(), calibration.camera.height()));
  SayParameters(calibration);
  SayResult(Text("error         %.3f px RMS", calibration.rms_px));
  SayResult("coverage      " + Percent(summary.covered_share) + " of the image");
  for (const std::string& advice : summary.advice) SayNote(advice);
}

}  // namespace

int CalibrateCommand(std::span<const std::string> args) {
  std::string image_path;
  std::string board_text;
  std::string output_path;
  std::string figure_path;
  CalibrateOptions options;
  CommandLine line(kManual);
  line.Add("image_path", &image_path, "PATH", "folder of images, or video, of the board", Need::kRequired);
  line.Add("board", &board_text, "BOARD", "kind, size and side of the board, such as chessboard:9x6:2.0",
           Need::kRequired);
  line.Add("output_path", &output_path, "FILE", "camera.yaml to write", Need::kRequired);
  line.Add("figure", &figure_path, "FILE", "picture of the errors to write: .png, .svg or .pdf", Need::kOptional);
  if (const auto exit = line.Parse(args)) return *exit;
  OptionTable table;
  options.List(table);
  if (const auto exit = line.Resolve(table)) return *exit;
  const auto board = ParseBoard(board_text);
  if (!board.ok()) return line.UsageError(board.status().message());
  if (const Status status = CheckBoardIsSupported(*board); !status.ok()) return line.UsageError(status.message());
  if (!figure_path.empty())
    if (const Status status = CheckEnding(ViewOutput::kFigure, figure_path); !status.ok())
      return line.UsageError(status.message());

  const std::atomic<bool>& stop = StopOnSignals();
  const auto summary = [&] {
    std::optional<Progress> progress;
    return CalibrateImages({image_path, *board, output_path}, options, [&](int done, int total) {
      if (total > 0 && !progress) progress.emplace("calibrate", total, "images");
      if (progress) progress->Update(done, "searched for the board");
      return !stop.load();
    });
  }();
  if (!summary.ok()) return line.Failure(summary.status().message());
  Say(*summary);
  SayResult(output_path);
  if (figure_path.empty()) return kExitOk;
  if (const Status status = WriteCalibrationFigure(*summary, figure_path); !status.ok())
    return line.Failure(status.message());
  SayResult(figure_path);
  return kExitOk;
}

}  // namespace pliant::cli
