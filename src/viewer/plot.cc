// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <numbers>

namespace pliant {
namespace {

// Widths of lines, pt.
constexpr double kCurveWidth = 0.9;
constexpr double kReferenceWidth = 0.7;
constexpr double kAxisWidth = 0.5;
constexpr double kGridWidth = 0.4;

constexpr double kMarkerRadius = 2.1;
constexpr double kHalo = 0.5;          // of white around a marker
constexpr int kMarkersALine = 6;       // in the width of a panel
constexpr double kLabelGap = 3;        // between an axis and its numbers
constexpr double kDigitHeight = 0.73;  // of the size of letters

constexpr Color kGridColor = {0.88, 0.88, 0.88};
constexpr Color kAxisColor = {0.3, 0.3, 0.3};
constexpr Color kReferenceColor = {0.5, 0.5, 0.5};

// Without yellow, which is too bright for a thin line on white.
constexpr std::array<Color, 6> kLineColors = {kBlue, kVermillion, kGreen, kPurple, kSkyBlue, kBlack};
constexpr std::array kMarkers = {Marker::kCircle,       Marker::kSquare, Marker::kTriangle, Marker::kDiamond,
                                 Marker::kTriangleDown, Marker::kPlus,   Marker::kCross};

double XOf(const Plot& plot, double x) { return plot.area.left + plot.area.width * plot.x.ShareOf(x); }
double YOf(const Plot& plot, double y) { return plot.area.top + plot.area.height * (1 - plot.y.ShareOf(y)); }

void AddPolygon(cairo_t* drawing, double x, double y, std::initializer_list<PlotPoint> corners) {
  cairo_new_sub_path(drawing);
  for (const PlotPoint& corner : corners)
    cairo_line_to(drawing, x + kMarkerRadius * corner.x, y + kMarkerRadius * corner.y);
  cairo_close_path(drawing);
}

void AddCross(cairo_t* drawing, double x, double y, double dx, double dy) {
  for (const auto& [a, b] : {PlotPoint{dx, dy}, PlotPoint{-dy, dx}}) {
    cairo_move_to(drawing, x - kMarkerRadius * a, y - kMarkerRadius * b);
    cairo_line_to(drawing, x + kMarkerRadius * a, y + kMarkerRadius * b);
  }
}

// All of about the same area.
void AddMarker(cairo_t* drawing, Marker marker, double x, double y) {
  switch (marker) {
    case Marker::kCircle:
      Dot(drawing, x, y, 0.95 * kMarkerRadius);
      break;
    case Marker::kSquare:
      AddPolygon(drawing, x, y, {{-0.85, -0.85}, {0.85, -0.85}, {0.85, 0.85}, {-0.85, 0.85}});
      break;
    case Marker::kTriangle:
      AddPolygon(drawing, x, y, {{0, -1.25}, {1.15, 0.75}, {-1.15, 0.75}});
      break;
    case Marker::kDiamond:
      AddPolygon(drawing, x, y, {{0, -1.25}, {1.1, 0}, {0, 1.25}, {-1.1, 0}});
      break;
    case Marker::kTriangleDown:
      AddPolygon(drawing, x, y, {{0, 1.25}, {1.15, -0.75}, {-1.15, -0.75}});
      break;
    case Marker::kPlus:
      AddCross(drawing, x, y, 1.1, 0);
      break;
    case Marker::kCross:
      AddCross(drawing, x, y, 0.8, 0.8);
      break;
  }
}

void DrawMarker(cairo_t* drawing, const LineStyle& style, double x, double y) {
  const bool is_stroke = style.marker == Marker::kPlus || style.marker == Marker::kCross;
  AddMarker(drawing, style.marker, x, y);
  Use(drawing, kWhite);
  cairo_set_line_width(drawing, is_stroke ? 1.1 + 2 * kHalo : 2 * kHalo);
  cairo_stroke_preserve(drawing);
  Use(drawing, style.color);
  cairo_set_line_width(drawing, 1.1);
  is_stroke ? cairo_stroke(drawing) : cairo_fill(drawing);
}

void StrokeStretches(cairo_t* drawing, const Plot& plot, const std::vector<PlotStretch>& stretches) {
  cairo_set_line_join(drawing, CAIRO_LINE_JOIN_ROUND);
  for (const PlotStretch& stretch : stretches) {
    for (const PlotPoint& point : stretch) cairo_line_to(drawing, XOf(plot, point.x), YOf(plot, point.y));
    cairo_stroke(drawing);
  }
}

constexpr double kDash = 2.6;
constexpr double kDashGap = 1.6;

void UseReferencePen(cairo_t* drawing) {
  Use(drawing, kReferenceColor);
  cairo_set_line_width(drawing, kReferenceWidth);
}

// Dashes are at the same x in all lines, so that lines that nearly coincide do not fill the gaps of one another.
void ClipDashes(cairo_t* drawing, const Panel& area) {
  for (double left = 0; left < area.width; left += kDash + kDashGap)
    cairo_rectangle(drawing, area.left + left, area.top, std::min(kDash, area.width - left), area.height);
  cairo_clip(drawing);
}

// Markers on an edge are whole.
void ClipLines(cairo_t* drawing, const Panel& area) {
  constexpr double kRim = 1.25 * kMarkerRadius + kHalo;
  Clip(drawing, {area.left - kRim, area.top - kRim, area.width + 2 * kRim, area.height + 2 * kRim});
}

void DrawSegment(cairo_t* drawing, double x0, double y0, double x1, double y1) {
  cairo_move_to(drawing, x0, y0);
  cairo_line_to(drawing, x1, y1);
  cairo_stroke(drawing);
}

// Its middle is at the point's height.
void DrawSideways(cairo_t* drawing, double baseline, double middle, const std::string& text) {
  const double width = TextWidth(drawing, text, kLabelText);
  cairo_save(drawing);
  cairo_translate(drawing, baseline, middle + width / 2);
  cairo_rotate(drawing, -std::numbers::pi / 2);
  DrawText(drawing, 0, 0, width + 1, text, kLabelText);
  cairo_restore(drawing);
}

}  // namespace

double Axis::ShareOf(double value) const {
  if (!logarithmic) return (value - low) / (high - low);
  constexpr double kBelow = 1e-3;  // of `low`: far enough outside
  return std::log(std::max(value, kBelow * low) / low) / std::log(high / low);
}

LineStyle StyleOfLine(std::size_t index, std::size_t count) {
  return {kLineColors[index % kLineColors.size()], kMarkers[index % kMarkers.size()], index, count};
}

void UseExactText(cairo_t* drawing) {
  cairo_font_options_t* options = cairo_font_options_create();
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_set_font_options(drawing, options);
  cairo_font_options_destroy(options);
}

void DrawGrid(cairo_t* drawing, const Plot& plot) {
  const Panel& area = plot.area;
  Use(drawing, kGridColor);
  cairo_set_line_width(drawing, kGridWidth);
  for (const Tick& tick : plot.x.ticks)
    DrawSegment(drawing, XOf(plot, tick.value), area.top, XOf(plot, tick.value), area.top + area.height);
  for (const Tick& tick : plot.y.ticks)
    DrawSegment(drawing, area.left, YOf(plot, tick.value), area.left + area.width, YOf(plot, tick.value));
}

void DrawAxes(cairo_t* drawing, const Plot& plot, double label_left) {
  const Panel& area = plot.area;
  Use(drawing, kAxisColor);
  cairo_set_line_width(drawing, kAxisWidth);
  cairo_move_to(drawing, area.left, area.top);
  cairo_line_to(drawing, area.left, area.top + area.height);
  cairo_line_to(drawing, area.left + area.width, area.top + area.height);
  cairo_stroke(drawing);
  for (const Tick& tick : plot.y.ticks) {
    const double width = TextWidth(drawing, tick.label, kTickText);
    DrawText(drawing, area.left - kLabelGap - width, YOf(plot, tick.value) + kDigitHeight * kTickText / 2, width + 1,
             tick.label, kTickText);
  }
  DrawSideways(drawing, label_left + kLabelText, area.top + area.height / 2, plot.y_label);
}

void DrawXLabels(cairo_t* drawing, const Plot& plot, const std::string& label) {
  const double baseline = plot.area.top + plot.area.height + kLabelGap + kDigitHeight * kTickText;
  const double right = plot.area.left + plot.area.width + kMarkerRadius;
  for (const Tick& tick : plot.x.ticks) {
    const double width = TextWidth(drawing, tick.label, kTickText);
    DrawText(drawing, std::min(XOf(plot, tick.value) - width / 2, right - width), baseline, width + 1, tick.label,
             kTickText);
  }
  const double width = TextWidth(drawing, label, kLabelText);
  DrawText(drawing, plot.area.left + (plot.area.width - width) / 2, baseline + kLabelText + 2, width + 1, label,
           kLabelText);
}

void DrawLine(cairo_t* drawing, const Plot& plot, const std::vector<PlotStretch>& stretches, const LineStyle& style) {
  cairo_save(drawing);
  ClipLines(drawing, plot.area);
  Use(drawing, style.color);
  cairo_set_line_width(drawing, kCurveWidth);
  StrokeStretches(drawing, plot, stretches);
  for (const PlotStretch& stretch : stretches) {
    if (stretch.size() > 1) continue;
    Dot(drawing, XOf(plot, stretch.front().x), YOf(plot, stretch.front().y), kCurveWidth);
    cairo_fill(drawing);
  }
  cairo_restore(drawing);
}

void DrawMarkers(cairo_t* drawing, const Plot& plot, const std::vector<PlotStretch>& stretches,
                 const LineStyle& style) {
  // On the first point of every interval, of which those of the lines are shifted against one another.
  const double shift = (static_cast<double>(style.index) + 0.5) / static_cast<double>(style.count);
  constexpr double kLeastDistance = 0.5;  // of an interval
  std::vector<PlotPoint> marked;
  double last = -kLeastDistance;
  for (const PlotStretch& stretch : stretches) {
    for (const PlotPoint& point : stretch) {
      const double at = kMarkersALine * plot.x.ShareOf(point.x) - shift;
      if (std::floor(at) <= std::floor(last) || at - last < kLeastDistance) continue;
      marked.push_back(point);
      last = at;
    }
  }
  if (marked.empty() && !stretches.empty()) marked.push_back(stretches.front().front());
  cairo_save(drawing);
  ClipLines(drawing, plot.area);
  for (const PlotPoint& point : marked) DrawMarker(drawing, style, XOf(plot, point.x), YOf(plot, point.y));
  cairo_restore(drawing);
}

void DrawReference(cairo_t* drawing, const Plot& plot, const std::vector<PlotStretch>& stretches) {
  cairo_save(drawing);
  ClipDashes(drawing, plot.area);
  UseReferencePen(drawing);
  StrokeStretches(drawing, plot, stretches);
  cairo_restore(drawing);
}

void DrawLineSample(cairo_t* drawing, double left, double middle, const LineStyle& style) {
  Use(drawing, style.color);
  cairo_set_line_width(drawing, kCurveWidth);
  DrawSegment(drawing, left, middle, left + kSampleWidth, middle);
  DrawMarker(drawing, style, left + kSampleWidth / 2, middle);
}

void DrawReferenceSample(cairo_t* drawing, double left, double middle) {
  cairo_save(drawing);
  ClipDashes(drawing, {left, middle - 1, kSampleWidth, 2});
  UseReferencePen(drawing);
  DrawSegment(drawing, left, middle, left + kSampleWidth, middle);
  cairo_restore(drawing);
}

}  // namespace pliant
