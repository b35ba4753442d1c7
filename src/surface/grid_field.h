// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Values at scattered pixels, interpolated over an image by a thin plate on a grid.
#pragma once

#include <span>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace pliant {

// A grid of nodes whose first one is at pixel (0, 0), with bilinear interpolation in between.
class GridField {
 public:
  GridField(cv::Size nodes, double spacing_px, int channels)
      : nodes_(nodes), spacing_px_(spacing_px), values_(Eigen::MatrixXd::Zero(nodes.area(), channels)) {}

  cv::Size nodes() const { return nodes_; }
  double spacing_px() const { return spacing_px_; }
  Eigen::MatrixXd& values() { return values_; }  // nodes (row by row) x channels
  const Eigen::MatrixXd& values() const { return values_; }

  Eigen::VectorXd At(const Eigen::Vector2d& pixel) const;
  // CV_32F with as many channels, for an image of `size` whose pixels are `step` times as large.
  cv::Mat ToImage(cv::Size size, double step) const;

 private:
  cv::Size nodes_;
  double spacing_px_;
  Eigen::MatrixXd values_;
};

// (V1) Minimizes sum w_i |f(u_i) - y_i|^2 + stiffness * (bending energy in grid steps) for an image of size `size`,
// with the weights found in the residuals (Cauchy), so that single wrong values count little. `values`: pixels x
// channels.
GridField FitThinPlate(cv::Size size, double spacing_px, std::span<const Eigen::Vector2d> pixels,
                       const Eigen::MatrixXd& values, double stiffness);

}  // namespace pliant
