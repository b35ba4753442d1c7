// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What all panels are drawn with by cairo: colors, dots, images and text.
#pragma once

#include <memory>
#include <string>

#include <cairo.h>
#include <opencv2/core/mat.hpp>

#include "pliant/base/status.h"

namespace pliant {

struct CairoDeleter {
  void operator()(cairo_t* drawing) const { cairo_destroy(drawing); }
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
using Drawing = std::unique_ptr<cairo_t, CairoDeleter>;
using CairoSurface = std::unique_ptr<cairo_surface_t, CairoDeleter>;

// Where a panel lies on its page.
struct Panel {
  double left = 0;
  double top = 0;
  double width = 0;
  double height = 0;
};

inline constexpr double kText = 14;        // size of the letters
inline constexpr double kLine = 22;        // height of a line of them
inline constexpr double kDot = 1.0 / 300;  // radius of a point, of the panel's width
inline constexpr double kSwatch = 1.2;     // width of a color in the legend, of the letters' size

// Okabe and Ito's colors, which the color-blind tell apart.
struct Color {
  double red;
  double green;
  double blue;
};
inline constexpr Color kBlack = {0, 0, 0};
inline constexpr Color kGray = {0.75, 0.75, 0.75};
inline constexpr Color kBlue = {0, 0.447, 0.698};
inline constexpr Color kVermillion = {0.835, 0.369, 0};
inline constexpr Color kGreen = {0, 0.62, 0.451};
inline constexpr Color kYellow = {0.941, 0.894, 0.259};
inline constexpr Color kSkyBlue = {0.337, 0.706, 0.914};
inline constexpr Color kPurple = {0.8, 0.475, 0.655};
inline constexpr Color kWhite = {1, 1, 1};

// The color of what is drawn next.
void Use(cairo_t* drawing, const Color& color);
// Adds a disc to the path.
void Dot(cairo_t* drawing, double x, double y, double radius);
// What is drawn next stays inside of the panel.
void Clip(cairo_t* drawing, const Panel& panel);

// `image`: 8-bit, 1, 3 (BGR) or 4 channels (BGRA, multiplied with its opacity).
CairoSurface ImageSurface(const cv::Mat& image);

// The sentence for a picture that cairo cannot hold.
Status TooLarge(double width_px, double height_px);

// What the text takes, with letters of this size.
double TextWidth(cairo_t* drawing, const std::string& text, double size = kText);
// In one line of at most this width: what does not fit is cut at its end.
void DrawText(cairo_t* drawing, double left, double baseline, double width, const std::string& text,
              double size = kText);
// From the panel's top left corner, in as many lines as fit.
void DrawParagraph(cairo_t* drawing, const Panel& panel, const std::string& text);

}  // namespace pliant
