// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The two pictures of a frame, drawn with cairo: the image with its points, and the scene.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>

#include <cairo.h>
#include <opencv2/core/mat.hpp>

#include "pliant/viewer/figure.h"
#include "pliant/viewer/view.h"
#include "viewer/orbit.h"

namespace pliant {

struct CairoDeleter {
  void operator()(cairo_t* drawing) const { cairo_destroy(drawing); }
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
using Drawing = std::unique_ptr<cairo_t, CairoDeleter>;
using Surface = std::unique_ptr<cairo_surface_t, CairoDeleter>;

// Where a panel lies on its page.
struct Panel {
  double left = 0;
  double top = 0;
  double width = 0;
  double height = 0;
};

inline constexpr double kText = 14;  // size of the letters
inline constexpr double kLine = 22;  // height of a line of them

// Height by width of the view's images.
double AspectOf(const View& view);

// Whether there is truth to draw: the camera's true path, or the true surface at a point.
bool HasTruth(const View& view);

// The sentence for a picture that cairo cannot hold.
Status TooLarge(double width_px, double height_px);

// The frame of a run by its number, or null.
const ViewedFrame* FindFrame(const ViewedRun& run, int frame_idx);

// The eye that sees all of a run, its cameras included, and the camera as it is drawn there.
struct Viewpoint {
  Orbit orbit;
  std::optional<std::array<Eigen::Vector3d, 4>> frustum;  // FrustumOf
};
Viewpoint ViewpointOf(const View& view, const ViewedRun& run, const FigureOptions& options, double width_px,
                      double height_px);

// `image`: 8-bit, 1 or 3 (BGR) channels, of the camera's size; empty where there is none. With the points of all runs,
// each run's in its color.
void DrawImage(cairo_t* drawing, const Panel& panel, const cv::Mat& image, const View& view, int frame_idx);
// A frame without a pose says why.
void DrawScene(cairo_t* drawing, const Panel& panel, const View& view, const ViewedRun& run, int frame_idx,
               const Viewpoint& viewpoint, const FigureOptions& options);
// In one line of at most this width: what does not fit is cut at its end.
void DrawText(cairo_t* drawing, double left, double baseline, double width, const std::string& text);
// The same of a run's name, with the color of its points in the image where there are images.
void DrawRunName(cairo_t* drawing, double left, double baseline, double width, const View& view, std::size_t run);
// From the panel's top left corner, in as many lines as fit.
void DrawParagraph(cairo_t* drawing, const Panel& panel, const std::string& text);
// What the colors of a scene mean, in as many lines as this width needs.
double LegendHeight(double width, bool truth);
void DrawLegend(cairo_t* drawing, double left, double top, double width, bool truth);

}  // namespace pliant
