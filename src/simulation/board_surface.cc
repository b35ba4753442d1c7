// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The scene `board`: an even grid of vertices, so that it may bend as paper does.
#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "pliant/board/draw_board.h"
#include "simulation/surface.h"

namespace pliant::simulation {

Result<Surface> MakeBoardSurface(const SimulationOptions::Scene& options) {
  constexpr int kPixelsPerSpacing = 64;
  constexpr double kMostSteps = 400;
  const auto board = ParseBoard(options.board);
  if (!board.ok()) return board.status();
  const auto picture = DrawBoard(*board, kPixelsPerSpacing);
  if (!picture.ok()) return picture.status();
  const Eigen::Vector2d size_mm = picture->mm_per_px * Eigen::Vector2d(picture->image.cols, picture->image.rows);
  const double step_mm = std::max(options.mesh_step_mm, size_mm.maxCoeff() / kMostSteps);
  const int across = static_cast<int>(std::ceil(size_mm.x() / step_mm));
  const int down = static_cast<int>(std::ceil(size_mm.y() / step_mm));

  Surface surface;
  surface.is_wet = false;
  cv::cvtColor(picture->image, surface.image, cv::COLOR_GRAY2BGR);
  const Eigen::Vector2d middle_mm = picture->origin_mm + 0.5 * size_mm;
  double sum_sq = 0;
  for (int row = 0; row <= down; ++row) {
    for (int column = 0; column <= across; ++column) {
      const Eigen::Vector2d share(static_cast<double>(column) / across, static_cast<double>(row) / down);
      const Eigen::Vector2d at_mm = picture->origin_mm + share.cwiseProduct(size_mm);
      surface.vertices.emplace_back(static_cast<float>(at_mm.x()), static_cast<float>(at_mm.y()), 0.0F);
      surface.chart.emplace_back(share.x(), 1.0 - share.y());  // v runs up
      sum_sq += (at_mm - middle_mm).squaredNorm();
    }
  }
  const std::size_t count = surface.vertices.size();
  surface.swell_center.assign(count, {static_cast<float>(middle_mm.x()), static_cast<float>(middle_mm.y()), 0.0F});
  surface.swell_radius_mm = std::sqrt(sum_sq / static_cast<double>(count));
  surface.grid = SurfaceGrid{.rows = down + 1, .columns = across + 1};
  FillGrid(surface);
  surface.grid.reset();  // the chart is the picture's
  return surface;
}

}  // namespace pliant::simulation
