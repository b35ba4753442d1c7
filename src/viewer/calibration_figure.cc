// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/viewer/calibration_figure.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pliant/base/text.h"
#include "pliant/viewer/output.h"
#include "viewer/drawing.h"
#include "viewer/picture_file.h"

namespace pliant {
namespace {

constexpr double kPageGap = 16;
constexpr double kPanelWidth = 640;
constexpr double kBarHeight = 160;
constexpr double kErrorFactor = 20;  // by which errors are enlarged
constexpr int kGridLines = 12;       // along the image's longer side

// From pixels of the image to the panel.
struct PixelsToPanel {
  Panel panel;
  double scale = 1;

  Eigen::Vector2d operator()(const Eigen::Vector2d& pixel) const {
    return {panel.left + scale * (pixel.x() + 0.5), panel.top + scale * (pixel.y() + 0.5)};
  }
};

void DrawFrame(cairo_t* drawing, const Panel& panel) {
  Use(drawing, kGray);
  cairo_set_line_width(drawing, 1);
  cairo_rectangle(drawing, panel.left, panel.top, panel.width, panel.height);
  cairo_stroke(drawing);
}

// Where a straight grid, on a plane parallel to the image, is seen.
void DrawLens(cairo_t* drawing, const Camera& camera, const PixelsToPanel& to_panel) {
  Use(drawing, kSkyBlue);
  cairo_set_line_width(drawing, 1);
  const double step = std::max(camera.width(), camera.height()) / camera.MeanFocalLengthPx() / kGridLines;
  const auto draw_line = [&](bool vertical, double at) {
    bool pen_down = false;
    for (double along = -4; along <= 4; along += 0.02) {
      const Eigen::Vector3d point = vertical ? Eigen::Vector3d(at, along, 1) : Eigen::Vector3d(along, at, 1);
      const auto pixel = camera.Project(point);
      if (!pixel || !camera.Contains(*pixel, -20)) {
        pen_down = false;
        continue;
      }
      const Eigen::Vector2d place = to_panel(*pixel);
      pen_down ? cairo_line_to(drawing, place.x(), place.y()) : cairo_move_to(drawing, place.x(), place.y());
      pen_down = true;
    }
    cairo_stroke(drawing);
  };
  for (int i = -4 * kGridLines; i <= 4 * kGridLines; ++i) {
    draw_line(true, i * step);
    draw_line(false, i * step);
  }
}

void DrawErrors(cairo_t* drawing, const CalibrateSummary& summary, const PixelsToPanel& to_panel) {
  cairo_set_line_width(drawing, 1.2);
  for (std::size_t view = 0; view < summary.views.size(); ++view) {
    const FittedView& fitted = summary.calibration.views[view];
    if (fitted.is_outlier) continue;
    for (std::size_t i = 0; i < fitted.residuals_px.size(); ++i) {
      const Eigen::Vector2d place = to_panel(summary.views[view].pixels[i]);
      const Eigen::Vector2d end = place + to_panel.scale * kErrorFactor * fitted.residuals_px[i];
      Use(drawing, kVermillion);
      cairo_move_to(drawing, place.x(), place.y());
      cairo_line_to(drawing, end.x(), end.y());
      cairo_stroke(drawing);
      Use(drawing, kBlue);
      Dot(drawing, place.x(), place.y(), 1.5);
      cairo_fill(drawing);
    }
  }
}

// The error at the top of the bars: the largest one of an image that is used.
double TopOfBars(const CameraCalibration& calibration) {
  double highest = calibration.rms_px;
  for (const FittedView& view : calibration.views)
    if (!view.is_outlier) highest = std::max(highest, view.rms_px);
  return highest;
}

// Along a bar that is cut at the top, whose middle is at `center`: what it would reach.
void WriteOnBar(cairo_t* drawing, const Panel& panel, double center, double width, double rms_px) {
  constexpr double kSmallestLetters = 5;  // that can be read
  const double letters = std::min(0.8 * kText, width);
  if (letters < kSmallestLetters) return;
  cairo_save(drawing);
  cairo_translate(drawing, center + 0.35 * letters, panel.top + panel.height - 0.3 * letters);
  cairo_rotate(drawing, -0.5 * std::numbers::pi);
  DrawText(drawing, 0, 0, panel.height, Digits(rms_px, 2), letters);
  cairo_restore(drawing);
}

// A bar an image, with the line of all of them together.
void DrawBars(cairo_t* drawing, const CalibrateSummary& summary, const Panel& panel) {
  const std::vector<FittedView>& views = summary.calibration.views;
  const double highest = TopOfBars(summary.calibration);
  if (!(highest > 0)) return;
  const double step = panel.width / static_cast<double>(views.size());
  const auto height_of = [&](double rms_px) { return panel.height * std::min(1.0, rms_px / highest); };
  for (std::size_t i = 0; i < views.size(); ++i) {
    Use(drawing, views[i].is_outlier ? kGray : kBlue);
    const double height = height_of(views[i].rms_px);
    cairo_rectangle(drawing, panel.left + step * (static_cast<double>(i) + 0.1), panel.top + panel.height - height,
                    0.8 * step, height);
    cairo_fill(drawing);
    if (views[i].rms_px > highest)
      WriteOnBar(drawing, panel, panel.left + step * (static_cast<double>(i) + 0.5), 0.8 * step, views[i].rms_px);
  }
  Use(drawing, kVermillion);
  cairo_set_line_width(drawing, 1.2);
  const double line = panel.top + panel.height - height_of(summary.calibration.rms_px);
  cairo_move_to(drawing, panel.left, line);
  cairo_line_to(drawing, panel.left + panel.width, line);
  cairo_stroke(drawing);
}

}  // namespace

Status WriteCalibrationFigure(const CalibrateSummary& summary, const std::string& output_path) {
  if (Status status = CheckEnding(ViewOutput::kFigure, output_path); !status.ok()) return status;
  const Camera& camera = summary.calibration.camera;
  const double scale = kPanelWidth / camera.width();
  const Panel image{kPageGap, 2 * kLine, kPanelWidth, scale * camera.height()};
  const Panel bars{kPageGap, image.top + image.height + 2 * kLine, kPanelWidth, kBarHeight};
  return WritePicture(output_path, kPanelWidth + 2 * kPageGap, bars.top + bars.height + kPageGap,
                      [&](cairo_t* drawing) {
                        Use(drawing, kBlack);
                        DrawText(drawing, kPageGap, 1.4 * kLine, kPanelWidth,
                                 std::string(camera.model_name()) + ": points of the board, errors times " +
                                     Digits(kErrorFactor, 0) + "; a straight grid");
                        cairo_save(drawing);
                        Clip(drawing, image);
                        const PixelsToPanel to_panel{image, scale};
                        DrawLens(drawing, camera, to_panel);
                        DrawErrors(drawing, summary, to_panel);
                        cairo_restore(drawing);
                        DrawFrame(drawing, image);
                        Use(drawing, kBlack);
                        DrawText(drawing, kPageGap, bars.top - 0.4 * kLine, kPanelWidth,
                                 "error of each image in px (RMS), up to " + Digits(TopOfBars(summary.calibration), 2) +
                                     "; line: all, " + Digits(summary.calibration.rms_px, 2) + "; gray: not used");
                        DrawBars(drawing, summary, bars);
                        DrawFrame(drawing, bars);
                        return Status::Ok();
                      });
}

}  // namespace pliant
