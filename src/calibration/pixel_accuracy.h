// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How well it is known where a camera sees a ray: the covariance of its parameters, carried to pixels of its image.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pliant/camera/camera.h"

namespace pliant {

// Of a camera's parameters, each in their order and units.
struct ParamsCovariance {
  Eigen::MatrixXd of_points;  // as if the errors of points were independent
  Eigen::MatrixXd of_views;   // by a jackknife over views: with the errors that the points of a view share

  // The larger one of each parameter.
  std::vector<double> Sigmas() const;
};

// Where a ray is seen, and the derivatives by the parameters.
struct PixelByParams {
  Eigen::Vector2d pixel;
  Eigen::Matrix2Xd jacobian;
};

// Without the bounds of the model's domain. Nothing where the ray has no pixel.
std::optional<PixelByParams> ProjectByParams(const Camera& camera, const Eigen::Vector3d& ray);

// The larger standard deviation of that pixel, px: root of the mean squared distance.
double PixelSigma(const PixelByParams& by_params, const ParamsCovariance& covariance);

// The corners and the middles of the sides, clockwise from the upper left corner.
std::vector<Eigen::Vector2d> BorderPixels(int width, int height);

// The ray of a pixel in two cameras.
struct PixelGap {
  double px = 0;        // how far apart they see it
  double sigma_px = 0;  // how well the second one is known there
};

// The ray is that of the first camera, or where it sees none of the second one. Nothing where none does.
std::optional<PixelGap> GapAt(const Eigen::Vector2d& pixel, const Camera& first, const Camera& second,
                              const ParamsCovariance& covariance_of_second);

}  // namespace pliant
