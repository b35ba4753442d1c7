// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Whether a run's own standard deviations are right. Of a point at distance d from the camera whose truth is at D, and
// whose sigma the run gives, the error is e = s d - D and the ratio e / (s sigma), with the frame's or submap's scale s
// of the surface error (point_error.h). Where the sigmas are right the ratios are normal with standard deviation 1.
// Sparsification: Ilg et al., Uncertainty Estimates and Multi-Hypotheses Networks for Optical Flow, ECCV 2018.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/evaluation/point_error.h"

namespace pliant {

// Of the observations of one range of predicted sigmas.
struct UncertaintyBin {
  int points = 0;
  double sigma_mm = 0;  // predicted, root mean square
  double rmse_mm = 0;   // of the error
};

struct UncertaintyError {
  static constexpr int kBins = 10;
  static constexpr int kSteps = 20;  // of the sparsification curve

  int points = 0;             // observations with a sigma and a truth
  int points_without = 0;     // with a truth alone
  double within_1_sigma = 0;  // shares; 0.683 and 0.954 where the sigmas are right
  double within_2_sigma = 0;
  double nees = 0;          // mean squared ratio (normalized estimation error squared); 1 where the sigmas are right
  double median_ratio = 0;  // median |ratio| by that of a normal one (0.6745); 1 where they are, whatever the outliers
  double median_sigma = 0;  // relative to the distance
  std::vector<UncertaintyBin> bins;  // as many observations in each, the most certain first
  // RMS error, by that of all, of what is left without the least certain (the worst) k / kSteps of the observations.
  std::array<double, kSteps> curve = {};
  std::array<double, kSteps> oracle = {};
  double area = 0;  // mean of `curve`; 1 where sigmas say nothing
  double oracle_area = 0;
};

// `surface` is the error of these `frames`, with its scales. Fails with kInsufficient where no observation has a sigma.
Result<UncertaintyError> ComputeUncertaintyError(std::span<const PairedFrame> frames, const PointError& surface);

}  // namespace pliant
