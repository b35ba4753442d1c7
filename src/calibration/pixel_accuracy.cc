// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "calibration/pixel_accuracy.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <ceres/jet.h>

#include "calibration/board_residual.h"

namespace pliant {

std::vector<double> ParamsCovariance::Sigmas() const {
  std::vector<double> sigmas;
  for (Eigen::Index i = 0; i < of_points.rows(); ++i)
    sigmas.push_back(std::sqrt(std::max(of_points(i, i), of_views(i, i))));
  return sigmas;
}

std::optional<PixelByParams> ProjectByParams(const Camera& camera, const Eigen::Vector3d& ray) {
  return WithModel(camera.model_id(), [&]<class Model>() -> std::optional<PixelByParams> {
    using Jet = ceres::Jet<double, Model::kNumParams>;
    std::array<Jet, Model::kNumParams> params;
    for (int i = 0; i < Model::kNumParams; ++i) {
      const auto idx = static_cast<std::size_t>(i);
      params[idx] = Jet(camera.params()[idx], i);
    }
    const std::array<Jet, 3> point = {Jet(ray.x()), Jet(ray.y()), Jet(ray.z())};
    std::array<Jet, 2> pixel;
    if (!Model::ProjectUnbounded(params.data(), point.data(), pixel.data())) return std::nullopt;
    PixelByParams result{{pixel[0].a, pixel[1].a}, Eigen::Matrix2Xd(2, Model::kNumParams)};
    result.jacobian.row(0) = pixel[0].v.transpose();
    result.jacobian.row(1) = pixel[1].v.transpose();
    return result;
  });
}

double PixelSigma(const PixelByParams& by_params, const ParamsCovariance& covariance) {
  const auto variance = [&](const Eigen::MatrixXd& of_params) {
    return (by_params.jacobian * of_params * by_params.jacobian.transpose()).trace();
  };
  return std::sqrt(std::max({0.0, variance(covariance.of_points), variance(covariance.of_views)}));
}

std::vector<Eigen::Vector2d> BorderPixels(int width, int height) {
  const double right = width - 1;
  const double bottom = height - 1;
  return {{0, 0},          {right / 2, 0},      {right, 0},  {right, bottom / 2},
          {right, bottom}, {right / 2, bottom}, {0, bottom}, {0, bottom / 2}};
}

std::optional<PixelGap> GapAt(const Eigen::Vector2d& pixel, const Camera& first, const Camera& second,
                              const ParamsCovariance& covariance_of_second) {
  auto ray = first.Unproject(pixel);
  if (!ray) ray = second.Unproject(pixel);
  if (!ray) return std::nullopt;
  const auto in_first = ProjectByParams(first, *ray);
  const auto in_second = ProjectByParams(second, *ray);
  if (!in_first || !in_second) return std::nullopt;
  return PixelGap{(in_second->pixel - in_first->pixel).norm(), PixelSigma(*in_second, covariance_of_second)};
}

}  // namespace pliant
