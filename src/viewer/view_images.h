// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The images of a view: small ones for the page, and what they say of each point's brightness.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pliant/base/status.h"
#include "pliant/viewer/report.h"
#include "pliant/viewer/view.h"

namespace pliant {

struct ViewImages {
  int width = 0;
  int height = 0;
  double scale = 1;  // image pixels a camera pixel
  std::vector<int> frame_idx;
  std::vector<std::string> jpeg;
};

// At most `width_px` wide.
cv::Mat Shrink(const cv::Mat& image, int width_px);
std::string ToJpeg(const cv::Mat& image, int quality);

// Reads the frames of the view's runs once. Every second image is left out, as often as it takes for those that stay to
// fit into the options' max_image_mb. An image that cannot be read ends the reading and is a note. Gain and bias of
// every observation are found by least squares over an 11 x 11 patch around its pixel. Fails as OpenSequence does.
Result<ViewImages> ReadViewImages(const ReportOptions& options, const JobProgress& progress, View* view);

}  // namespace pliant
