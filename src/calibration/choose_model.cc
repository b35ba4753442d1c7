// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "calibration/choose_model.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

// Two nested models differ clearly where their distance is larger than what the noise of the larger one explains, even
// at the worst of several pixels, and larger than the errors of points of the scene, which are found to about half a
// pixel.
constexpr double kClearGapSigmas = 3;
constexpr double kClearGap_px = 0.5;
// Beyond which the distance to another model says more than that this other one is not known well itself (95 %).
constexpr double kTellingGapSigmas = 2;

HeldOutError Compared(const ModelCandidate& candidate, const ModelCandidate& best) {
  HeldOutError error;
  error.model = candidate.fit.model;
  error.num_params = candidate.fit.num_free;
  error.rms_px = Mean(candidate.prediction_errors_px);
  std::vector<double> excess;
  for (std::size_t i = 0; i < candidate.prediction_errors_px.size(); ++i)
    excess.push_back(candidate.prediction_errors_px[i] - best.prediction_errors_px[i]);
  error.excess_px = Mean(excess);
  error.excess_sigma_px = StandardError(excess);
  return error;
}

// Whether the larger model describes every camera that the smaller one does, and more.
bool IsNestedIn(const BoardFit& smaller, const BoardFit& larger) {
  const auto is_fisheye = [](const BoardFit& fit) { return fit.model == CameraModelId::kOpenCvFisheye; };
  if (larger.num_free <= smaller.num_free || is_fisheye(larger) != is_fisheye(smaller)) return false;
  const int of_larger = NumPinholeParams(larger.model);
  const int of_smaller = NumPinholeParams(smaller.model);
  return of_larger >= of_smaller && larger.num_free - of_larger >= smaller.num_free - of_smaller;
}

bool DifferClearly(const ModelCandidate& smaller, const ModelCandidate& larger) {
  return std::ranges::any_of(BorderPixels(smaller.camera.width(), smaller.camera.height()),
                             [&](const Eigen::Vector2d& pixel) {
                               const auto gap = GapAt(pixel, smaller.camera, larger.camera, larger.covariance);
                               return gap && gap->px > std::max(kClearGap_px, kClearGapSigmas * gap->sigma_px);
                             });
}

}  // namespace

// A candidate predicts as well as the best one where it is no worse by more than a standard error, of the difference or
// of the best one's own error: what the points' own errors imitate differs little, but in every view.
ModelChosen ChooseModel(const std::vector<ModelCandidate>& candidates) {
  const auto error_of = [](const ModelCandidate& candidate) { return Mean(candidate.prediction_errors_px); };
  const auto best = std::min_element(candidates.begin(), candidates.end(),
                                     [&](const auto& a, const auto& b) { return error_of(a) < error_of(b); });
  const double best_sigma_px = StandardError(best->prediction_errors_px);
  ModelChosen choice{static_cast<std::size_t>(best - candidates.begin())};
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const HeldOutError error = Compared(candidates[i], *best);
    choice.errors.push_back(error);
    choice.is_as_good.push_back(error.excess_px <= std::max(error.excess_sigma_px, best_sigma_px));
    if (choice.is_as_good[i] && candidates[i].fit.num_free < candidates[choice.chosen].fit.num_free) choice.chosen = i;
  }
  std::vector<std::size_t> by_size(candidates.size());
  std::iota(by_size.begin(), by_size.end(), std::size_t{0});
  std::ranges::stable_sort(by_size, {}, [&](std::size_t i) { return candidates[i].fit.num_free; });
  for (const std::size_t i : by_size) {
    const ModelCandidate& chosen = candidates[choice.chosen];
    if (choice.is_as_good[i] && IsNestedIn(chosen.fit, candidates[i].fit) && DifferClearly(chosen, candidates[i]))
      choice.chosen = i;
  }
  return choice;
}

std::vector<PixelAccuracy> BorderAccuracy(const std::vector<ModelCandidate>& candidates, const ModelChosen& choice) {
  const ModelCandidate& chosen = candidates[choice.chosen];
  std::vector<PixelAccuracy> border;
  for (const Eigen::Vector2d& pixel : BorderPixels(chosen.camera.width(), chosen.camera.height())) {
    PixelAccuracy accuracy{pixel, std::numeric_limits<double>::infinity()};
    if (const auto ray = chosen.camera.Unproject(pixel))
      if (const auto by_params = ProjectByParams(chosen.camera, *ray))
        accuracy.sigma_px = PixelSigma(*by_params, chosen.covariance);
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (i == choice.chosen || !choice.is_as_good[i]) continue;
      const auto gap = GapAt(pixel, chosen.camera, candidates[i].camera, candidates[i].covariance);
      if (!gap || gap->px < accuracy.model_gap_px || gap->px < kTellingGapSigmas * gap->sigma_px) continue;
      accuracy.model_gap_px = gap->px;
      accuracy.gap_model = candidates[i].fit.model;
    }
    border.push_back(accuracy);
  }
  return border;
}

}  // namespace pliant
