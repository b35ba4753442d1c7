// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/drawing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <sstream>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace pliant {
namespace {

void UseFont(cairo_t* drawing, double size) {
  cairo_select_font_face(drawing, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(drawing, size);
}

double WidthOf(cairo_t* drawing, const std::string& text) {
  cairo_text_extents_t extents;
  cairo_text_extents(drawing, text.c_str(), &extents);
  return extents.x_advance;
}

// Cut at its end, which then says so, until it is no wider than this.
std::string Fitting(cairo_t* drawing, std::string text, double width) {
  if (WidthOf(drawing, text) <= width) return text;
  const std::string ellipsis = "\u2026";
  while (!text.empty() && WidthOf(drawing, text + ellipsis) > width) {
    const auto continues = [](char byte) { return (static_cast<unsigned char>(byte) & 0xC0) == 0x80; };
    while (continues(text.back()) && text.size() > 1) text.pop_back();
    text.pop_back();
  }
  return text + ellipsis;
}

}  // namespace

void Use(cairo_t* drawing, const Color& color) { cairo_set_source_rgb(drawing, color.red, color.green, color.blue); }

void Dot(cairo_t* drawing, double x, double y, double radius) {
  cairo_new_sub_path(drawing);
  cairo_arc(drawing, x, y, radius, 0, 2 * std::numbers::pi);
}

void Clip(cairo_t* drawing, const Panel& panel) {
  cairo_rectangle(drawing, panel.left, panel.top, panel.width, panel.height);
  cairo_clip(drawing);
}

CairoSurface ImageSurface(const cv::Mat& image) {
  cv::Mat bgra = image;
  if (image.channels() != 4)
    cv::cvtColor(image, bgra, image.channels() == 1 ? cv::COLOR_GRAY2BGRA : cv::COLOR_BGR2BGRA);
  const cairo_format_t format = image.channels() == 4 ? CAIRO_FORMAT_ARGB32 : CAIRO_FORMAT_RGB24;
  CairoSurface surface(cairo_image_surface_create(format, bgra.cols, bgra.rows));
  const int stride = cairo_image_surface_get_stride(surface.get());
  unsigned char* pixels = cairo_image_surface_get_data(surface.get());
  cairo_surface_flush(surface.get());
  for (int y = 0; y < bgra.rows; ++y)
    std::copy_n(bgra.ptr(y), static_cast<std::size_t>(4 * bgra.cols), pixels + static_cast<std::ptrdiff_t>(y) * stride);
  cairo_surface_mark_dirty(surface.get());
  return surface;
}

Status TooLarge(double width_px, double height_px) {
  return {ErrorCode::kInvalidArgument, "a picture of " + std::to_string(std::lround(width_px)) + " x " +
                                           std::to_string(std::lround(height_px)) +
                                           " pixels is too large; give fewer frames or a smaller "
                                           "--Figure.panel_width_px"};
}

double TextWidth(cairo_t* drawing, const std::string& text, double size) {
  UseFont(drawing, size);
  return WidthOf(drawing, text);
}

void DrawText(cairo_t* drawing, double left, double baseline, double width, const std::string& text, double size) {
  UseFont(drawing, size);
  Use(drawing, kBlack);
  cairo_move_to(drawing, left, baseline);
  cairo_show_text(drawing, Fitting(drawing, text, width).c_str());
}

void DrawParagraph(cairo_t* drawing, const Panel& panel, const std::string& text) {
  constexpr double kInset = 12;
  const double width = panel.width - 2 * kInset;
  UseFont(drawing, kText);
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (lines.empty() || WidthOf(drawing, lines.back() + " " + word) > width)
      lines.push_back(word);
    else
      lines.back() += " " + word;
  }
  const auto room = static_cast<std::size_t>(std::max(1.0, std::floor((panel.height - kInset) / kLine)));
  for (std::size_t i = 0; i < std::min(room, lines.size()); ++i) {
    const bool is_cut = i + 1 == room && lines.size() > room;
    DrawText(drawing, panel.left + kInset, panel.top + kLine * static_cast<double>(i + 1), width,
             is_cut ? lines[i] + "\u2026" : lines[i]);
  }
}

}  // namespace pliant
