// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/viewer/figure.h"

#include <algorithm>
#include <set>
#include <string>

#include "viewer/draw_image.h"
#include "viewer/draw_legend.h"
#include "viewer/draw_mesh.h"
#include "viewer/draw_scene.h"
#include "viewer/drawing.h"
#include "viewer/frame_images.h"
#include "viewer/picture_file.h"
#include "viewer/view_lookup.h"

namespace pliant {
namespace {

constexpr double kGap = 8;

// The size of a panel.
struct PanelSize {
  double width = 0;
  double height = 0;

  PanelSize(const View& view, const FigureOptions& options)
      : width(options.panel_width_px), height(width * AspectOf(view)) {}
};

// The page of a figure, in points of 1/72 inch (png: pixels).
struct Layout {
  double width = 0;
  double height = 0;
  double image_height = 0;  // 0: no images
  PanelSize panel;          // of a scene
  double legend_height = 0;

  Layout(const View& view, const PanelSize& panel_size, const LegendContent& legend, std::size_t frames)
      : panel(panel_size) {
    image_height = view.sequence ? panel.height : 0;
    width = kGap + static_cast<double>(frames) * (panel.width + kGap);
    legend_height = LegendHeight(width - 2 * kGap, legend);
    height = kLine + image_height + kGap +
             static_cast<double>(view.runs.size()) * (panel.height + kGap + RunLine(view)) + legend_height;
  }

  static double RunLine(const View& view) { return view.runs.size() > 1 ? kLine : 0; }
};

// Draws all of the figure. Fails as FrameImages does, and with kInterrupted.
Status Draw(cairo_t* drawing, const View& view, const SceneDrawer& scenes, const Layout& layout,
            const std::set<int>& frames_idx, const JobProgress& progress) {
  auto images = FrameImages::Open(view, *frames_idx.begin());
  if (!images.ok()) return images.status();
  double left = kGap;
  int done = 0;
  for (const int frame_idx : frames_idx) {
    if (Status status = Tell(progress, "figure", done++, static_cast<int>(frames_idx.size())); !status.ok())
      return status;
    DrawText(drawing, left, kLine - 6, layout.panel.width, "frame " + std::to_string(frame_idx));
    const auto image = images->At(frame_idx);
    if (!image.ok()) return image.status();
    DrawImage(drawing, {left, kLine, layout.panel.width, layout.image_height}, *image, view, frame_idx);
    double top = kLine + layout.image_height + kGap;
    for (std::size_t i = 0; i < view.runs.size(); ++i) {
      if (view.runs.size() > 1) DrawRunName(drawing, left, top + kLine - 8, layout.panel.width, view, i);
      top += Layout::RunLine(view);
      scenes.Draw(drawing, {left, top, layout.panel.width, layout.panel.height}, i, frame_idx);
      top += layout.panel.height + kGap;
    }
    left += layout.panel.width + kGap;
  }
  DrawLegend(drawing, kGap, layout.height - layout.legend_height, layout.width - 2 * kGap, scenes.Legend(frames_idx));
  return Status::Ok();
}

Status CheckFrames(const View& view, const std::vector<int>& frames_idx) {
  if (frames_idx.empty()) return {ErrorCode::kInvalidArgument, "a figure needs a frame"};
  for (const int frame_idx : frames_idx)
    if (std::none_of(view.runs.begin(), view.runs.end(),
                     [&](const ViewedRun& run) { return FindFrame(run, frame_idx) != nullptr; }))
      return {ErrorCode::kInvalidArgument,
              "frame " + std::to_string(frame_idx) + " is in no run; the first run has " +
                  (view.runs.front().frames.empty()
                       ? std::string("none")
                       : std::to_string(view.runs.front().frames.front().row.frame_idx) + " to " +
                             std::to_string(view.runs.front().frames.back().row.frame_idx))};
  return Status::Ok();
}

}  // namespace

void FigureOptions::List(OptionTable& table) {
  table.BeginGroup("Figure", "how a figure or a film is drawn");
  table.Add("panel_width_px", &panel_width_px, "px", "width of an image, and of a scene", 64, 4096);
  table.Add("trail_frames", &trail_frames, "frames", "length of a point's trail of deformation", 1, 1000000);
  table.Add("azimuth_deg", &azimuth_deg, "deg",
            "viewpoint of the scene: from behind the camera, turned to its right by this", -360.0, 360.0);
  table.Add("elevation_deg", &elevation_deg, "deg", "and raised above it by this", -89.0, 89.0);
  table.AddChoice("surface_color", &surface_color, "of the mesh of a surface (report --surface)");
  table.Add("fps", &fps, "1/s", "of a film; 0: the sequence's", 0.0, 1000.0);
}

Result<std::vector<std::string>> WriteFigure(const ViewRequest& request, const FigureOptions& options,
                                             const std::vector<int>& frames_idx, const std::string& output_path,
                                             const JobProgress& progress) {
  ViewRequest pictures = request;
  pictures.figures = false;
  const auto view = OpenView(pictures, options.view, progress);
  if (!view.ok()) return view.status();
  if (Status status = CheckSurfaceColor(*view, options.surface_color); !status.ok()) return status;
  if (Status status = CheckFrames(*view, frames_idx); !status.ok()) return status;
  const std::set<int> columns(frames_idx.begin(), frames_idx.end());
  const PanelSize panel(*view, options);
  const SceneDrawer scenes(*view, options, panel.width, panel.height);
  const Layout layout(*view, panel, scenes.Legend(columns), columns.size());
  const Status written = WritePicture(output_path, layout.width, layout.height, [&](cairo_t* drawing) {
    return Draw(drawing, *view, scenes, layout, columns, progress);
  });
  if (!written.ok()) return written;
  return view->notes;
}

}  // namespace pliant
