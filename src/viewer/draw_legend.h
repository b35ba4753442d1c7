// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the colors of pictures mean.
#pragma once

#include <cstddef>

#include "pliant/viewer/view.h"
#include "viewer/drawing.h"

namespace pliant {

// In one line, as DrawText, with the color of the run's points in the image where there are images.
void DrawRunName(cairo_t* drawing, double left, double baseline, double width, const View& view, std::size_t run);

// What the colors of a scene mean, in as many lines as this width needs.
double LegendHeight(double width, bool truth);
void DrawLegend(cairo_t* drawing, double left, double top, double width, bool truth);

}  // namespace pliant
