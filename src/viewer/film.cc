// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "pliant/base/files.h"
#include "pliant/base/statistics.h"
#include "pliant/base/text.h"
#include "pliant/viewer/figure.h"
#include "viewer/draw_image.h"
#include "viewer/draw_legend.h"
#include "viewer/draw_mesh.h"
#include "viewer/draw_scene.h"
#include "viewer/drawing.h"
#include "viewer/frame_images.h"
#include "viewer/view_lookup.h"

namespace pliant {
namespace {

constexpr double kFilmMargin = 6;
constexpr double kNameLeft = 110;  // beside the frame's number
constexpr double kUsualFps = 30;

// Even, as the codecs want it.
int Even(double size) { return 2 * static_cast<int>(std::lround(0.5 * size)); }

double FramesPerSecond(const View& view) {
  std::vector<double> steps;
  for (const ViewedRun& run : view.runs)
    for (std::size_t i = 1; i < run.frames.size(); ++i)
      steps.push_back(run.frames[i].row.timestamp_s - run.frames[i - 1].row.timestamp_s);
  const double step = Median(std::move(steps));
  return step > 0 ? 1 / step : kUsualFps;
}

bool OpenWriter(const std::string& path, double fps, const cv::Size& size, cv::VideoWriter* writer) {
  for (const int codec : {cv::VideoWriter::fourcc('a', 'v', 'c', '1'), cv::VideoWriter::fourcc('m', 'p', '4', 'v')})
    if (writer->open(path, cv::CAP_FFMPEG, codec, fps, size)) return true;
  return false;
}

// What a player finds in it: the writer tells of no full disk.
int CountFrames(const std::string& path) {
  cv::VideoCapture film(path, cv::CAP_FFMPEG);
  int frames = 0;
  while (film.isOpened() && film.grab()) ++frames;
  return frames;
}

Status Unwritable(const std::string& path) {
  return {ErrorCode::kUnwritable, "cannot write the film " + path +
                                      "; is the folder there, is there room on the disk, and does OpenCV have FFmpeg "
                                      "with an encoder for mp4?"};
}

// What all frames of a film share.
struct FilmLayout {
  const View& view;
  const SceneDrawer& scenes;
  const LegendContent& legend;
  double panel_width = 0;
  double panel_height = 0;
};

// The frame's number and a legend around its image, where there is one, and a panel for each run.
void DrawFilmFrame(const FilmLayout& layout, int frame_idx, const cv::Mat& image, cairo_surface_t* surface) {
  const View& view = layout.view;
  const Drawing drawing(cairo_create(surface));
  cairo_set_source_rgb(drawing.get(), 1, 1, 1);
  cairo_paint(drawing.get());
  double left = 0;
  if (!image.empty()) {
    DrawImage(drawing.get(), {left, kLine, layout.panel_width, layout.panel_height}, image, view, frame_idx);
    left += layout.panel_width;
  }
  for (std::size_t i = 0; i < view.runs.size(); ++i) {
    layout.scenes.Draw(drawing.get(), {left, kLine, layout.panel_width, layout.panel_height}, i, frame_idx);
    if (view.runs.size() > 1) {
      const double name_left = left > 0 ? kFilmMargin : kNameLeft;
      DrawRunName(drawing.get(), left + name_left, kLine - 6, layout.panel_width - name_left, view, i);
    }
    left += layout.panel_width;
  }
  DrawText(drawing.get(), kFilmMargin, kLine - 6, kNameLeft - kFilmMargin, "frame " + std::to_string(frame_idx));
  DrawLegend(drawing.get(), kFilmMargin, kLine + layout.panel_height, left - 2 * kFilmMargin, layout.legend);
}

}  // namespace

Result<std::vector<std::string>> WriteFilm(const ViewRequest& request, const FigureOptions& options,
                                           const std::string& output_path,
                                           const std::function<bool(int, int)>& progress) {
  ViewRequest pictures = request;
  pictures.figures = false;
  const auto view = OpenView(pictures, options.view);
  if (!view.ok()) return view.status();
  if (Status status = CheckSurfaceColor(*view, options.surface_color); !status.ok()) return status;
  std::set<int> frames_idx;
  for (const ViewedRun& run : view->runs)
    for (const ViewedFrame& frame : run.frames) frames_idx.insert(frame.row.frame_idx);
  if (frames_idx.empty()) return Status(ErrorCode::kInsufficient, "the run has no frame; there is nothing to film");
  const double panel_width = options.panel_width_px;
  const double panel_height = panel_width * AspectOf(*view);
  const std::size_t panels = (view->sequence ? 1 : 0) + view->runs.size();
  const double width = static_cast<double>(panels) * panel_width;
  const SceneDrawer scenes(*view, options, panel_width, panel_height);
  const LegendContent legend = scenes.Legend(frames_idx);
  const double legend_height = LegendHeight(width - 2 * kFilmMargin, legend);
  const cv::Size size(Even(width), Even(panel_height + kLine + legend_height));
  auto images = FrameImages::Open(*view, *frames_idx.begin());
  if (!images.ok()) return images.status();
  const std::string draft = std::filesystem::path(output_path).replace_extension(".part.mp4").string();
  const auto unwritten = [&](Status status) {
    std::error_code ignored;
    std::filesystem::remove(draft, ignored);
    return status;
  };
  cv::VideoWriter writer;
  if (!OpenWriter(draft, options.fps > 0 ? options.fps : FramesPerSecond(*view), size, &writer))
    return unwritten(Unwritable(output_path));
  const CairoSurface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, size.width, size.height));
  if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS) return unwritten(TooLarge(size.width, size.height));
  int done = 0;
  for (const int frame_idx : frames_idx) {
    cv::Mat image;
    if (view->sequence) {
      auto read = images->At(frame_idx);
      if (!read.ok()) return unwritten(read.status());
      image = *read;
    }
    DrawFilmFrame({*view, scenes, legend, panel_width, panel_height}, frame_idx, image, surface.get());
    cairo_surface_flush(surface.get());
    const cv::Mat bgra(size, CV_8UC4, cairo_image_surface_get_data(surface.get()),
                       static_cast<std::size_t>(cairo_image_surface_get_stride(surface.get())));
    cv::Mat bgr;
    cv::cvtColor(bgra, bgr, cv::COLOR_BGRA2BGR);
    writer.write(bgr);
    if (!progress(++done, static_cast<int>(frames_idx.size()))) break;
  }
  writer.release();
  // A part of a film must not take the place of a whole one.
  if (done < static_cast<int>(frames_idx.size()) && Exists(output_path))
    return unwritten({ErrorCode::kInterrupted,
                      "stopped on request; the film " + Quoted(output_path) + " that was there is unchanged"});
  if (CountFrames(draft) != done) return unwritten(Unwritable(output_path));
  std::error_code error;
  std::filesystem::rename(draft, output_path, error);
  if (error) return unwritten(Unwritable(output_path));
  return view->notes;
}

}  // namespace pliant
