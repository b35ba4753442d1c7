// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "surface/depth_certainty.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

constexpr int kRemotenessStepPx = 8;

// By which sigmas are too small, of errors by them; at least 1.
double FactorOf(const std::vector<double>& ratios) {
  return ratios.empty() ? 1.0 : std::max(1.0, kMedianToSigma * Median(ratios));
}

// At every pixel, interpolated between some.
cv::Mat RemotenessAt(const SizedCamera& camera, const SparseSurface& surface, const cv::Mat& inverse_distance) {
  const cv::Size size((camera.size().width + kRemotenessStepPx - 1) / kRemotenessStepPx,
                      (camera.size().height + kRemotenessStepPx - 1) / kRemotenessStepPx);
  cv::Mat remoteness(size, CV_32F);
  for (int j = 0; j < size.height; ++j)
    for (int i = 0; i < size.width; ++i) {
      const int x = std::min(i * kRemotenessStepPx + kRemotenessStepPx / 2, camera.size().width - 1);
      const int y = std::min(j * kRemotenessStepPx + kRemotenessStepPx / 2, camera.size().height - 1);
      const cv::Vec3f ray = camera.rays.at<cv::Vec3f>(y, x);
      const double distance = 1.0 / std::max(1e-12F, inverse_distance.at<float>(y, x));
      remoteness.at<float>(j, i) =
          static_cast<float>(surface.Remoteness(distance * Eigen::Vector3d(ray[0], ray[1], ray[2])));
    }
  cv::resize(remoteness, remoteness, camera.size(), 0, 0, cv::INTER_LINEAR);
  return remoteness;
}

}  // namespace

cv::Mat Disagreement(const SweepCosts& costs, int half, int threads) {
  if (costs.first.empty()) return cv::Mat(costs.all.front().size(), CV_32F, cv::Scalar::all(0));
  cv::Mat difference;
  cv::absdiff(ChooseLevels(costs.first, half, 0.0, threads).level, ChooseLevels(costs.second, half, 0.0, threads).level,
              difference);
  return difference;
}

cv::Mat LevelSigmas(const SizedScene& scene, const ChosenLevels& chosen, const cv::Mat& disagreement) {
  const ReferenceWindows& reference = scene.reference;
  const double views = std::max(1.0, 0.5 * static_cast<double>(scene.views.size()));
  const double samples = reference.window_px * reference.window_px * views;
  cv::Mat sigma(chosen.level.size(), CV_32F, cv::Scalar::all(0));
  std::vector<double> ratios;
  for (int y = 0; y < sigma.rows; ++y)
    for (int x = 0; x < sigma.cols; ++x) {
      const double curvature = chosen.curvature.at<float>(y, x);
      const double variance = reference.variance.at<float>(y, x) + kDampingByNoise * reference.noise_variance;
      if (!(curvature > 0.0)) continue;
      const double predicted =
          std::max(kMinSigmaLevels, std::sqrt(2.0 * reference.noise_variance / (samples * curvature * variance)));
      sigma.at<float>(y, x) = static_cast<float>(predicted);
      // Of each half alone the variance is twice as large, and of the difference four times.
      ratios.push_back(disagreement.at<float>(y, x) / (2.0 * predicted));
    }
  return sigma * FactorOf(ratios);
}

double FactorByPoints(const SizedCamera& camera, const SparseSurface& surface, const cv::Mat& inverse_distance,
                      const cv::Mat& sigmas) {
  std::vector<double> ratios;
  for (const Eigen::Vector3d& point : surface.points) {
    const auto pixel = camera.camera.Project(point);
    if (!pixel || !camera.camera.Contains(*pixel)) continue;
    const auto x = static_cast<int>(std::lround(pixel->x()));
    const auto y = static_cast<int>(std::lround(pixel->y()));
    const float sigma = sigmas.at<float>(y, x);
    if (sigma > 0.0F) ratios.push_back(std::abs(inverse_distance.at<float>(y, x) * point.norm() - 1.0) / sigma);
  }
  return FactorOf(ratios);
}

cv::Mat MotionSigmas(const SizedScene& sized, const Scene& scene, const cv::Mat& inverse_distance,
                     const cv::Mat& parallax) {
  std::vector<double> errors;
  for (const SurfaceMotion& motion : scene.motions) errors.push_back(motion.error);
  const double error_px = Median(errors) * sized.camera.camera.MeanFocalLengthPx();
  return error_px * RemotenessAt(sized.camera, scene.surface, inverse_distance) / parallax;
}

bool AreAlike(const ReferenceWindows& reference, float cost, int x, int y, double min_correlation) {
  const double variance = reference.variance.at<float>(y, x);
  const double of_equal_ones =
      (variance - reference.noise_variance) / (variance + kDampingByNoise * reference.noise_variance);
  return 1.0 - cost >= min_correlation * of_equal_ones;
}

}  // namespace pliant
