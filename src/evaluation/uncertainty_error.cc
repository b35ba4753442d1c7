// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/uncertainty_error.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

struct Judged {
  double sigma_mm = 0;
  double error_mm = 0;  // absolute
};

// Root mean squares of the first n - k n / kSteps of the errors, by that of all.
std::array<double, UncertaintyError::kSteps> Curve(std::span<const Judged> judged) {
  std::vector<double> sums = {0.0};
  for (const Judged& j : judged) sums.push_back(sums.back() + j.error_mm * j.error_mm);
  const auto rms = [&](std::size_t n) { return std::sqrt(sums[n] / static_cast<double>(n)); };
  std::array<double, UncertaintyError::kSteps> curve = {};
  for (std::size_t k = 0; k < curve.size(); ++k) {
    const std::size_t left = std::max<std::size_t>(1, judged.size() - k * judged.size() / curve.size());
    curve[k] = sums.back() > 0.0 ? rms(left) / rms(judged.size()) : 1.0;
  }
  return curve;
}

std::vector<UncertaintyBin> Bins(std::span<const Judged> judged) {
  std::vector<UncertaintyBin> bins;
  for (std::size_t b = 0; b < UncertaintyError::kBins; ++b) {
    std::vector<double> sigmas;
    std::vector<double> errors;
    const std::size_t end = (b + 1) * judged.size() / UncertaintyError::kBins;
    for (std::size_t i = b * judged.size() / UncertaintyError::kBins; i < end; ++i) {
      sigmas.push_back(judged[i].sigma_mm);
      errors.push_back(judged[i].error_mm);
    }
    if (!errors.empty()) bins.push_back({static_cast<int>(errors.size()), Rms(sigmas), Rms(errors)});
  }
  return bins;
}

}  // namespace

Result<UncertaintyError> ComputeUncertaintyError(std::span<const PairedFrame> frames, const PointError& surface) {
  std::map<int, double> scales;
  for (const PointFrameError& frame : surface.plain.frames) scales[frame.frame_idx] = frame.estimate.scale;
  UncertaintyError error;
  std::vector<Judged> judged;
  std::vector<double> ratios;
  std::vector<double> relative;
  for (const PairedFrame& frame : frames) {
    for (const PointPair& pair : frame.pairs) {
      if (!(pair.sigma > 0.0)) {
        ++error.points_without;
        continue;
      }
      const double scale = scales.at(frame.frame_idx);
      const Judged j = {scale * pair.sigma, std::abs(scale * pair.estimate.norm() - pair.truth.norm())};
      judged.push_back(j);
      const double truth_sigma_mm = pair.truth_sigma_mm * pair.truth.norm() / std::abs(pair.truth.z());
      ratios.push_back(j.error_mm / std::hypot(j.sigma_mm, truth_sigma_mm));
      relative.push_back(pair.sigma / pair.estimate.norm());
    }
  }
  if (judged.empty()) return Status(ErrorCode::kInsufficient, "the run does not say how certain its points are");
  const auto count = static_cast<double>(judged.size());
  const auto share_below = [&](double bound) {
    return static_cast<double>(std::ranges::count_if(ratios, [&](double ratio) { return ratio <= bound; })) / count;
  };
  error.points = static_cast<int>(judged.size());
  error.within_1_sigma = share_below(1.0);
  error.within_2_sigma = share_below(2.0);
  const double rms_ratio = Rms(ratios);
  error.nees = rms_ratio * rms_ratio;
  error.median_ratio = kMedianToSigma * Median(ratios);
  error.median_sigma = Median(relative);
  std::ranges::stable_sort(judged, {}, &Judged::sigma_mm);
  error.bins = Bins(judged);
  error.curve = Curve(judged);
  std::ranges::stable_sort(judged, {}, &Judged::error_mm);
  error.oracle = Curve(judged);
  error.area = Mean(std::vector<double>(error.curve.begin(), error.curve.end()));
  error.oracle_area = Mean(std::vector<double>(error.oracle.begin(), error.oracle.end()));
  return error;
}

}  // namespace pliant
