// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/coverage.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace pliant {

double CoverageOf(const cv::Mat& valid, std::span<const Eigen::Vector2d> pixels) {
  // Counted in cells: a circle has a radius of four of them.
  constexpr double kCellsAcross = 128.0;
  constexpr double kRadius = kCellsAcross / 32.0;
  const double cell_px = std::max(1.0, valid.cols / kCellsAcross);
  const cv::Size size(static_cast<int>(std::ceil(valid.cols / cell_px)),
                      static_cast<int>(std::ceil(valid.rows / cell_px)));
  cv::Mat cells;
  cv::resize(valid, cells, size, 0, 0, cv::INTER_NEAREST);
  cv::Mat far_from_points(size, CV_8UC1, cv::Scalar(255));
  for (const Eigen::Vector2d& pixel : pixels) {
    const cv::Point cell(static_cast<int>((pixel.x() + 0.5) / cell_px), static_cast<int>((pixel.y() + 0.5) / cell_px));
    if (cv::Rect(cv::Point(), size).contains(cell)) far_from_points.at<unsigned char>(cell) = 0;
  }
  cv::Mat distances;
  cv::distanceTransform(far_from_points, distances, cv::DIST_L2, cv::DIST_MASK_5);
  const int shown = cv::countNonZero(cells);
  const int covered = cv::countNonZero((distances <= kRadius) & (cells > 0));
  return shown == 0 ? 0.0 : static_cast<double>(covered) / shown;
}

}  // namespace pliant
