// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Text and logos that are burned into a recording: pixels that never change while the rest does, and that have sharp
// edges. Seen on a coarse grid of pixels that are taken as they are, since averaging would blur thin strokes. The dark
// surroundings of the view do not count, nor does its rim, which is not sharp, or changes by as much of its level as
// the view does.
#pragma once

#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pliant/datasets/check_images.h"

namespace pliant {

class StateArchive;

// Every `step`-th pixel of an image each way, from the first on.
cv::Mat GridOf(const cv::Mat& image, int step);

// One image on the grid.
struct GridSample {
  cv::Mat gray;      // CV_8UC1
  cv::Mat contrast;  // CV_8UC1: largest minus smallest level among the 3x3 pixels of the image around each
  cv::Mat valid;     // CV_8UC1, 0 = masked out; empty: all are valid
};

void Serialize(StateArchive& archive, GridSample& sample);

GridSample SampleGrid(const cv::Mat& gray, const cv::Mat& mask, int step);

struct OverlaySearch {
  bool tells = false;                   // there are enough samples, and enough of the image changes
  std::optional<PixelRectangle> found;  // in pixels of the image; the largest one
};

OverlaySearch FindOverlay(const std::vector<GridSample>& samples, int step);

}  // namespace pliant
