// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/refinement/focal_length.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "pliant/base/statistics.h"
#include "pliant/base/text.h"
#include "refinement/bundle.h"
#include "refinement/check_recording.h"
#include "refinement/key_views.h"
#include "refinement/residual_correlation.h"

namespace pliant {
namespace {

constexpr double kLargestFactor = 1.9;  // and its inverse: what is searched
constexpr double kCoarseStep = 1.1;
constexpr double kFineLogStep = 0.02;  // of the parabola through the costs around the minimum
constexpr int kViewsPerTrack = 15;
constexpr double kStartLogDepthSigma = 5;  // holds the unit, and says nothing of the depths, which are wrong
constexpr double kStartNoise_px = 0.3;
constexpr double kWrongTrack = 3;  // times the median track's error

struct Solution {
  double log_factor = 0;
  double cost = 0;
  BundleState state;
};

class FocalLengthSearch {
 public:
  FocalLengthSearch(const Camera& camera, const Recording& recording, const RefineOptions& options)
      : camera_(camera), recording_(recording), options_(options) {
    used_.assign(recording.observations.size(), true);
    KeepPointsSeenOften(recording, &used_);
    used_ = UsedInKeyViews(recording, used_, StrideOfKeyViews(recording, used_, kViewsPerTrack));
    distance_ = MedianDistance(recording);
  }

  Result<FocalLengthEstimate> Run() {
    if (!std::count(used_.begin(), used_.end(), true)) return NotDetermined("too few points are seen for long enough");
    Solution start;
    start.state.cams_from_world = recording_.cams_from_world;
    start.state.rest_positions = recording_.rest_positions;
    auto best = SolveAt(0, start.state);
    if (!best) return NotDetermined("there is no solution with the assumed one");
    noise_px_ = NoiseOf(*best);
    RejectWrongTracks(*best);
    best = SolveAt(0, best->state);
    if (!best) return NotDetermined("there is no solution with the assumed one");
    // Away from the assumed one, each begun with its neighbor's solution.
    const Solution center = *best;
    for (const double direction : {1.0, -1.0}) {
      Solution last = center;
      for (double log_factor = std::log(kCoarseStep); log_factor <= std::log(kLargestFactor);
           log_factor += std::log(kCoarseStep)) {
        const auto next = SolveAt(direction * log_factor, last.state);
        if (!next) break;
        last = *next;
        if (last.cost < best->cost) best = last;
      }
    }
    return Minimum(*best);
  }

 private:
  static Status NotDetermined(const std::string& why) {
    return {ErrorCode::kInsufficient, "the recording does not determine the focal length: " + why};
  }

  std::optional<Camera> CameraAt(double log_factor) const {
    const auto camera = camera_.WithFocalLengthTimes(std::exp(log_factor));
    return camera.ok() ? std::optional(*camera) : std::nullopt;
  }

  std::optional<Solution> SolveAt(double log_factor, const BundleState& start) const {
    const auto camera = CameraAt(log_factor);
    if (!camera) return std::nullopt;
    BundleInput input{.camera = *camera, .recording = recording_};
    input.used = used_;
    input.distance = distance_;
    input.sigmas.noise_px = noise_px_;
    input.sigmas.log_distance = kStartLogDepthSigma;
    Solution solution{log_factor, 0, start};
    const auto summary = SolveBundle(input, options_.max_iterations, {}, &solution.state);
    if (!summary.ok()) return std::nullopt;
    solution.cost = summary->final_cost;
    return solution;
  }

  std::vector<Eigen::Vector2d> ErrorsOf(const Solution& solution) const {
    return ReprojectionErrors(*CameraAt(solution.log_factor), recording_, solution.state);
  }

  double NoiseOf(const Solution& solution) const { return NoisePx(ErrorsOf(solution), used_); }

  void RejectWrongTracks(const Solution& solution) {
    const auto errors_px = ErrorsOf(solution);
    std::vector<std::vector<double>> of_point(recording_.rest_positions.size());
    for (std::size_t o = 0; o < errors_px.size(); ++o)
      if (used_[o])
        of_point[static_cast<std::size_t>(recording_.observations[o].point_idx)].push_back(errors_px[o].norm());
    std::vector<double> rms;
    for (const auto& errors : of_point)
      if (!errors.empty()) rms.push_back(Rms(errors));
    const double bound = kWrongTrack * Median(rms);
    for (std::size_t o = 0; o < used_.size(); ++o)
      if (used_[o] && Rms(of_point[static_cast<std::size_t>(recording_.observations[o].point_idx)]) > bound)
        used_[o] = false;
  }

  // All errors of a track count as one measurement, since its patch drifts (F9).
  double ObservationsPerTrack() const {
    std::vector<int> counts(recording_.rest_positions.size(), 0);
    for (std::size_t o = 0; o < used_.size(); ++o)
      if (used_[o]) ++counts[static_cast<std::size_t>(recording_.observations[o].point_idx)];
    std::vector<double> seen;
    for (const int count : counts)
      if (count > 0) seen.push_back(count);
    return std::max(1.0, Mean(seen));
  }

  // A parabola through the costs around the minimum, moved until its vertex lies between them.
  Result<FocalLengthEstimate> Minimum(Solution center) {
    constexpr int kMostMoves = 12;
    for (int move = 0; move < kMostMoves; ++move) {
      const auto again = SolveAt(center.log_factor, center.state);
      if (!again) break;
      const auto lower = SolveAt(center.log_factor - kFineLogStep, again->state);
      const auto upper = SolveAt(center.log_factor + kFineLogStep, again->state);
      if (!lower || !upper) break;
      if (lower->cost < again->cost || upper->cost < again->cost) {
        center = lower->cost < upper->cost ? *lower : *upper;
        continue;
      }
      const double curvature = (lower->cost + upper->cost - 2 * again->cost) / (kFineLogStep * kFineLogStep);
      const double slope = (upper->cost - lower->cost) / (2 * kFineLogStep);
      return Checked(*again, curvature, slope);
    }
    return NotDetermined("no focal length from " + Digits(1 / kLargestFactor, 2) + " to " + Digits(kLargestFactor, 2) +
                         " times the assumed one fits better than its neighbors");
  }

  Result<FocalLengthEstimate> Checked(const Solution& best, double curvature, double slope) {
    const double noise_px = NoiseOf(best);
    // The costs are by the noise under the assumed focal length.
    const double per_measurement = curvature * (noise_px_ * noise_px_) / (noise_px * noise_px) / ObservationsPerTrack();
    if (!(per_measurement > 0)) return NotDetermined("all focal lengths fit alike");
    const FocalLengthEstimate estimate{std::exp(best.log_factor - slope / curvature), 1 / std::sqrt(per_measurement)};
    const double correlation = ResidualCorrelation(recording_, used_, ErrorsOf(best), recording_.patch_px).value;
    if (correlation > options_.max_correlation)
      return Status(ErrorCode::kDegenerate,
                    "no focal length explains the recording as rigid, and only a rigid scene determines it");
    if (estimate.log_sigma > kLargestFocalLengthLogSigma)
      return NotDetermined("it would be known to " + Percent(estimate.log_sigma) +
                           " only; move the camera more, and turn it");
    return estimate;
  }

  const Camera& camera_;
  const Recording& recording_;
  const RefineOptions& options_;
  std::vector<bool> used_;
  double distance_ = 1;
  double noise_px_ = kStartNoise_px;
};

}  // namespace

Result<FocalLengthEstimate> EstimateFocalLength(const Camera& camera, const Recording& recording,
                                                const RefineOptions& options) {
  if (Status status = CheckRecording(recording, options); !status.ok()) return status;
  return FocalLengthSearch(camera, recording, options).Run();
}

}  // namespace pliant
