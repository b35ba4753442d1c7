// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/draw_legend.h"

#include <vector>

#include "viewer/draw_image.h"

namespace pliant {
namespace {

struct LegendEntry {
  Color color;
  const char* text;
  double left = 0;
  int line = 0;
};

// Each beside the one before it, or on the next line where that is full.
std::vector<LegendEntry> LayOutLegend(cairo_t* drawing, double width, bool truth) {
  std::vector<LegendEntry> entries = {{kBlack, "undeformed map"}, {kVermillion, "deformation"}, {kBlue, "camera"}};
  if (truth) entries.push_back({kGreen, "truth"});
  double left = 0;
  int line = 0;
  for (LegendEntry& entry : entries) {
    const double taken = kSwatch * kText + TextWidth(drawing, entry.text);
    if (left > 0 && left + taken > width) {
      left = 0;
      ++line;
    }
    entry.left = left;
    entry.line = line;
    left += taken + 1.5 * kText;
  }
  return entries;
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

double LegendHeight(double width, bool truth) {
  const CairoSurface scratch(cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1));
  const Drawing drawing(cairo_create(scratch.get()));
  return kLine * (1 + LayOutLegend(drawing.get(), width, truth).back().line);
}

void DrawLegend(cairo_t* drawing, double left, double top, double width, bool truth) {
  for (const LegendEntry& entry : LayOutLegend(drawing, width, truth)) {
    const double baseline = top + kLine * (entry.line + 1) - 8;
    Use(drawing, entry.color);
    Dot(drawing, left + entry.left + 0.4 * kText, baseline - 0.35 * kText, 0.35 * kText);
    cairo_fill(drawing);
    DrawText(drawing, left + entry.left + kSwatch * kText, baseline, width, entry.text);
  }
}

}  // namespace pliant
