// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Lines over a common axis, drawn for print: one panel with its grid, axes and lines.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "viewer/drawing.h"
#include "viewer/ticks.h"

namespace pliant {

inline constexpr double kTickText = 7;   // size of the letters of ticks, pt
inline constexpr double kLabelText = 7;  // of the names of axes and lines

struct Axis {
  double low = 0;
  double high = 1;
  bool logarithmic = false;
  std::vector<Tick> ticks = {};

  double ShareOf(double value) const;  // of the axis' length: 0 at `low`, 1 at `high`
};

// One panel.
struct Plot {
  Panel area;  // of the lines; the labels are left of it, and below
  Axis x;
  Axis y;
  std::string y_label;
};

enum class Marker { kCircle, kSquare, kTriangle, kDiamond, kTriangleDown, kPlus, kCross };

// How a line is told from the others, with colors and without.
struct LineStyle {
  Color color;
  Marker marker = Marker::kCircle;
  std::size_t index = 0;  // of `count` lines, which have their markers at different places
  std::size_t count = 1;
};

// The first six differ in both, the first 42 in one of both.
LineStyle StyleOfLine(std::size_t index, std::size_t count);

struct PlotPoint {
  double x = 0;
  double y = 0;
};
// Points in the order of x, without a gap between them.
using PlotStretch = std::vector<PlotPoint>;

// Text takes the same room in all kinds of files: it is not fitted to pixels.
void UseExactText(cairo_t* drawing);

void DrawGrid(cairo_t* drawing, const Plot& plot);
// Over all else: the axes and the labels of y.
void DrawAxes(cairo_t* drawing, const Plot& plot, double label_left);
// The labels of x, below the panel.
void DrawXLabels(cairo_t* drawing, const Plot& plot, const std::string& label);

// A line of several stretches, none of them empty; a point by itself is a dot. The markers are drawn apart, over all
// lines.
void DrawLine(cairo_t* drawing, const Plot& plot, const std::vector<PlotStretch>& stretches, const LineStyle& style);
void DrawMarkers(cairo_t* drawing, const Plot& plot, const std::vector<PlotStretch>& stretches, const LineStyle& style);
// A thin dashed gray line.
void DrawReference(cairo_t* drawing, const Plot& plot, const std::vector<PlotStretch>& stretches);

// What the legend shows of these, with its left end and its middle here.
inline constexpr double kSampleWidth = 16;
void DrawLineSample(cairo_t* drawing, double left, double middle, const LineStyle& style);
void DrawReferenceSample(cairo_t* drawing, double left, double middle);

}  // namespace pliant
