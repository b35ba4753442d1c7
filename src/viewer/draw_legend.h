// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the colors of pictures mean.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "pliant/viewer/view.h"
#include "viewer/color_maps.h"
#include "viewer/drawing.h"

namespace pliant {

// In one line, as DrawText, with the color of the run's points in the image where there are images.
void DrawRunName(cairo_t* drawing, double left, double baseline, double width, const View& view, std::size_t run);

// What the colors of values mean.
struct ColorScale {
  std::string title;  // with the unit
  std::string low;
  std::string high;
  ColorMap map = ColorMap::kViridis;
};

struct LegendContent {
  bool map = true;  // the undeformed map
  bool truth = false;
  bool unknown = false;  // values that are not known
  std::optional<ColorScale> scale = {};
};

// In as many lines as this width needs.
double LegendHeight(double width, const LegendContent& content);
void DrawLegend(cairo_t* drawing, double left, double top, double width, const LegendContent& content);

}  // namespace pliant
