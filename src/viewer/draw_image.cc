// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/draw_image.h"

#include <algorithm>
#include <array>
#include <string>

#include "viewer/view_images.h"
#include "viewer/view_lookup.h"

namespace pliant {
namespace {

// Of the runs' points in the image, in turn.
constexpr std::array<Color, 4> kRunColors = {kYellow, kSkyBlue, kPurple, kWhite};

constexpr int kEmbeddedQuality = 90;

// Which SVG and PDF take instead of the pixels.
void AttachJpeg(const cv::Mat& image, cairo_surface_t* surface) {
  auto* jpeg = new std::string(ToJpeg(image, kEmbeddedQuality));
  cairo_surface_set_mime_data(
      surface, CAIRO_MIME_TYPE_JPEG, reinterpret_cast<const unsigned char*>(jpeg->data()), jpeg->size(),
      [](void* text) { delete static_cast<std::string*>(text); }, jpeg);
}

// In pixels of the image. Of several runs the first one's points are the smallest, and above the others: runs often
// have points at the same pixels.
void DrawImagePoints(cairo_t* drawing, const View& view, int frame_idx, double radius) {
  for (std::size_t i = view.runs.size(); i-- > 0;) {
    const ViewedFrame* frame = FindFrame(view.runs[i], frame_idx);
    if (frame == nullptr) continue;
    const double size = radius * (1 + static_cast<double>(i));
    for (const ViewedObservation& o : frame->observations) Dot(drawing, o.pixel.x() + 0.5, o.pixel.y() + 0.5, size);
    Use(drawing, ColorOfRun(i));
    cairo_fill_preserve(drawing);
    Use(drawing, kBlack);
    cairo_set_line_width(drawing, 0.35 * radius);
    cairo_stroke(drawing);
  }
}

}  // namespace

const Color& ColorOfRun(std::size_t run) { return kRunColors[run % kRunColors.size()]; }

void DrawImage(cairo_t* drawing, const Panel& panel, const cv::Mat& image, const View& view, int frame_idx) {
  if (image.empty()) return;
  cairo_save(drawing);
  Clip(drawing, panel);
  const double scale = std::min(panel.width / image.cols, panel.height / image.rows);
  const CairoSurface surface = ImageSurface(image);
  if (cairo_surface_get_type(cairo_get_target(drawing)) != CAIRO_SURFACE_TYPE_IMAGE) AttachJpeg(image, surface.get());
  cairo_translate(drawing, panel.left, panel.top);
  cairo_scale(drawing, scale, scale);
  cairo_set_source_surface(drawing, surface.get(), 0, 0);
  cairo_pattern_set_filter(cairo_get_source(drawing), CAIRO_FILTER_GOOD);
  cairo_paint(drawing);
  DrawImagePoints(drawing, view, frame_idx, 1.2 * kDot * panel.width / scale);
  cairo_restore(drawing);
}

}  // namespace pliant
