// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The image of a frame with its points.
#pragma once

#include <cstddef>

#include <opencv2/core/mat.hpp>

#include "pliant/viewer/view.h"
#include "viewer/drawing.h"

namespace pliant {

// Of a run's points in the image.
const Color& ColorOfRun(std::size_t run);

// `image`: 8-bit, 1 or 3 (BGR) channels, of the camera's size; empty where there is none. With the points of all runs,
// each run's in its color.
void DrawImage(cairo_t* drawing, const Panel& panel, const cv::Mat& image, const View& view, int frame_idx);

}  // namespace pliant
