// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/depth_prior/scale_and_shift.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Core>
#include <Eigen/LU>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

constexpr std::size_t kMinFitted = 12;
constexpr int kIterations = 10;
constexpr double kStartSigma = 0.1;  // of a relative error
constexpr double kMinSigma = 0.01;
constexpr double kShiftSigma = 0.5;  // of the shift by the median target: where the points leave it open
constexpr double kCauchy = 2.0;      // in standard deviations

}  // namespace

std::optional<ScaleAndShift> FitScaleAndShift(const std::vector<double>& values, const std::vector<double>& targets) {
  if (values.size() < kMinFitted) return std::nullopt;
  const double value_unit = Median(values);
  const double target_unit = Median(targets);
  Eigen::Vector2d fit(1.0, 0.0);
  double sigma = kStartSigma;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Eigen::Matrix2d normal = Eigen::Vector2d(0.0, 1.0 / (kShiftSigma * kShiftSigma)).asDiagonal();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    std::vector<double> errors;
    for (std::size_t k = 0; k < values.size(); ++k) {
      const Eigen::Vector2d row = Eigen::Vector2d(values[k] / value_unit, 1.0) * (target_unit / targets[k]);
      const double error = std::abs(row.dot(fit) - 1.0);
      errors.push_back(error);
      const double weight = 1.0 / (sigma * sigma + std::pow(error / kCauchy, 2));
      normal += weight * row * row.transpose();
      right += weight * row;
    }
    fit = normal.inverse() * right;
    sigma = std::max(kMinSigma, kMedianToSigma * Median(std::move(errors)));
  }
  if (!fit.allFinite() || !(fit[0] > 0.0)) return std::nullopt;
  return ScaleAndShift{fit[0] * target_unit / value_unit, fit[1] * target_unit, sigma};
}

}  // namespace pliant
