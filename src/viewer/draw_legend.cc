// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/draw_legend.h"

#include <algorithm>
#include <vector>

#include "viewer/color_maps.h"
#include "viewer/draw_image.h"

namespace pliant {
namespace {

constexpr double kBetween = 1.5;  // entries, of the letters' size
constexpr double kBar = 8;        // width of a color scale, likewise
constexpr double kBarGap = 0.4;   // between it and its numbers

struct LegendEntry {
  Color color;
  const char* text;  // null: the color scale
  double left = 0;
  int line = 0;
};

double ScaleWidth(cairo_t* drawing, const ColorScale& scale) {
  return TextWidth(drawing, scale.title) + TextWidth(drawing, scale.low) + TextWidth(drawing, scale.high) +
         (kBar + 4 * kBarGap) * kText;
}

// Each beside the one before it, or on the next line where that is full.
std::vector<LegendEntry> LayOutLegend(cairo_t* drawing, double width, const LegendContent& content) {
  std::vector<LegendEntry> entries;
  if (content.map) entries.push_back({kBlack, "undeformed map"});
  entries.push_back({kVermillion, "deformation"});
  entries.push_back({kBlue, "camera"});
  if (content.truth) entries.push_back({kGreen, "truth"});
  const auto [red, green, blue] = kUnknownRgb;
  if (content.unknown) entries.push_back({{red / 255, green / 255, blue / 255}, "not known"});
  if (content.scale) entries.push_back({kBlack, nullptr});
  double left = 0;
  int line = 0;
  for (LegendEntry& entry : entries) {
    const double taken =
        entry.text != nullptr ? kSwatch * kText + TextWidth(drawing, entry.text) : ScaleWidth(drawing, *content.scale);
    if (left > 0 && left + taken > width) {
      left = 0;
      ++line;
    }
    entry.left = left;
    entry.line = line;
    left += taken + kBetween * kText;
  }
  return entries;
}

// The title, then the colors between the lowest and the highest value.
void DrawScale(cairo_t* drawing, double left, double baseline, double right, const ColorScale& scale) {
  const auto draw_text = [&](const std::string& text) {
    DrawText(drawing, left, baseline, right - left, text);
    left += TextWidth(drawing, text) + kBarGap * kText;
  };
  draw_text(scale.title);
  left += kBarGap * kText;
  draw_text(scale.low);
  const double bar_right = std::min(left + kBar * kText, right);
  cairo_pattern_t* colors = cairo_pattern_create_linear(left, 0, bar_right, 0);
  constexpr int kStops = 33;  // odd: one of them is the middle
  for (int i = 0; i < kStops; ++i) {
    const double share = i / (kStops - 1.0);
    const auto [red, green, blue] = ColorAt(scale.map, share);
    cairo_pattern_add_color_stop_rgb(colors, share, red / 255, green / 255, blue / 255);
  }
  cairo_set_source(drawing, colors);
  cairo_pattern_destroy(colors);
  cairo_rectangle(drawing, left, baseline - 0.75 * kText, bar_right - left, 0.8 * kText);
  cairo_fill(drawing);
  left = bar_right + kBarGap * kText;
  draw_text(scale.high);
}

}  // namespace

void DrawRunName(cairo_t* drawing, double left, double baseline, double width, const View& view, std::size_t run) {
  double name_left = left;
  if (view.sequence) {
    Dot(drawing, left + 0.4 * kText, baseline - 0.35 * kText, 0.35 * kText);
    Use(drawing, ColorOfRun(run));
    cairo_fill_preserve(drawing);
    Use(drawing, kBlack);
    cairo_set_line_width(drawing, 1);
    cairo_stroke(drawing);
    name_left += kSwatch * kText;
  }
  DrawText(drawing, name_left, baseline, left + width - name_left, view.runs[run].name);
}

double LegendHeight(double width, const LegendContent& content) {
  const CairoSurface scratch(cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1));
  const Drawing drawing(cairo_create(scratch.get()));
  return kLine * (1 + LayOutLegend(drawing.get(), width, content).back().line);
}

void DrawLegend(cairo_t* drawing, double left, double top, double width, const LegendContent& content) {
  for (const LegendEntry& entry : LayOutLegend(drawing, width, content)) {
    const double baseline = top + kLine * (entry.line + 1) - 8;
    if (entry.text == nullptr) {
      DrawScale(drawing, left + entry.left, baseline, left + width, *content.scale);
      continue;
    }
    Use(drawing, entry.color);
    Dot(drawing, left + entry.left + 0.4 * kText, baseline - 0.35 * kText, 0.35 * kText);
    cairo_fill(drawing);
    DrawText(drawing, left + entry.left + kSwatch * kText, baseline, width, entry.text);
  }
}

}  // namespace pliant
