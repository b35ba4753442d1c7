// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "refinement/bundle.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "pliant/base/statistics.h"
#include "refinement/bundle_covariance.h"
#include "refinement/bundle_problem.h"

namespace pliant {
namespace {

// (F9) The found sizes are those of shapes that their own prior has made small, by about so much (found on simulated
// colons).
constexpr double kShrunk = 2.0;

// (F7) Of distances that were measured.
constexpr double kMinMeasuredSigma = 0.002;
constexpr double kMaxMeasuredSigma = 0.1;
constexpr double kWrongMeasured = 3.0;  // standard deviations of a residual: a wrong pair
constexpr double kMinLeftShare = 0.05;  // where a residual is judged by itself; less is known to no more than that

// By which the variance of the measurements is to be multiplied. Residuals of wrong pairs do not count.
double VarianceFactor(const std::vector<MeasuredResidual>& residuals) {
  const auto studentized = [](const MeasuredResidual& of) {
    return std::abs(of.residual) / std::sqrt(std::max(kMinLeftShare, of.left_share));
  };
  std::vector<double> lengths;
  for (const MeasuredResidual& of : residuals) lengths.push_back(studentized(of));
  const double bound = kWrongMeasured * kMedianToSigma * Median(std::move(lengths));
  double squares = 0;
  double left = 0;
  for (const MeasuredResidual& of : residuals) {
    if (studentized(of) > bound) continue;
    squares += of.residual * of.residual;
    left += of.left_share;
  }
  return left > 0 ? squares / left : 1.0;
}

// (F9) What the solution has taken up of the errors of measured distances is not in the residuals: how much that is
// follows from the standard deviation that it was found with (variance components: Foerstner, 1979).
Status CorrectMeasuredSigma(const BundleState& state, BundleInput* input) {
  BundleState unchanged = state;
  const auto residuals = MeasuredResiduals(BundleProblem(*input, &unchanged));
  if (!residuals.ok()) return residuals.status();
  if (residuals->empty()) return Status::Ok();
  double& sigma = input->sigmas.measured_log_distance;
  sigma = std::clamp(sigma * std::sqrt(VarianceFactor(*residuals)), kMinMeasuredSigma, kMaxMeasuredSigma);
  return Status::Ok();
}

// (F9) Of a track as one measurement, a coordinate: what a drift moves along the epipolar line goes into the depth, and
// its residuals show the other coordinate alone.
double TrackNoisePx(const BundleInput& input, const BundleState& state) {
  const std::vector<double> squares =
      MeanSquareErrors(input.recording, input.used, ReprojectionErrors(input.camera, input.recording, state));
  const std::vector<int> views = CountViews(input.recording, input.used);
  const double sum = std::accumulate(squares.begin(), squares.end(), 0.0);
  const auto tracks = views.size() - static_cast<std::size_t>(std::ranges::count(views, 0));
  return std::max(input.sigmas.noise_px, std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, tracks))));
}

}  // namespace

Eigen::Vector3d BundleState::Position(int point_idx, int view_idx) const {
  const auto i = static_cast<std::size_t>(point_idx);
  if (rank() == 0) return rest_positions[i];
  return rest_positions[i] + shapes[i] * coefficients.col(view_idx);
}

Result<BundleSummary> SolveBundle(const BundleInput& input, int max_iterations,
                                  const std::function<bool(double)>& callback, BundleState* state) {
  return BundleProblem(input, state).Solve(max_iterations, callback);
}

Result<BundleCovariance> CovarianceOfBundle(const BundleInput& input, const BundleState& state) {
  BundleInput of_tracks = input;
  of_tracks.one_measurement_per_track = true;
  of_tracks.sigmas.size *= kShrunk;
  of_tracks.sigmas.gradient *= kShrunk;
  of_tracks.sigmas.noise_px = TrackNoisePx(input, state);
  if (Status status = CorrectMeasuredSigma(state, &of_tracks); !status.ok()) return status;
  BundleState unchanged = state;
  return ComputeCovariance(BundleProblem(of_tracks, &unchanged), input.recording);
}

std::vector<int> CountViews(const Recording& recording, const std::vector<bool>& used) {
  std::vector<int> views(recording.rest_positions.size(), 0);
  for (std::size_t o = 0; o < used.size(); ++o)
    if (used[o]) ++views[static_cast<std::size_t>(recording.observations[o].point_idx)];
  return views;
}

std::vector<double> MeanSquareErrors(const Recording& recording, const std::vector<bool>& used,
                                     const std::vector<Eigen::Vector2d>& errors_px) {
  std::vector<double> squares(recording.rest_positions.size(), 0.0);
  for (std::size_t o = 0; o < errors_px.size(); ++o)
    if (used[o]) squares[static_cast<std::size_t>(recording.observations[o].point_idx)] += errors_px[o].squaredNorm();
  const std::vector<int> views = CountViews(recording, used);
  for (std::size_t i = 0; i < squares.size(); ++i) squares[i] /= std::max(1, views[i]);
  return squares;
}

std::vector<Eigen::Vector2d> ReprojectionErrors(const Camera& camera, const Recording& recording,
                                                const BundleState& state) {
  std::vector<Eigen::Vector2d> errors;
  errors.reserve(recording.observations.size());
  for (const RecordedObservation& observation : recording.observations) {
    const auto pixel = camera.Project(state.cams_from_world[static_cast<std::size_t>(observation.view_idx)] *
                                      state.Position(observation.point_idx, observation.view_idx));
    errors.push_back(pixel ? Eigen::Vector2d(*pixel - observation.pixel)
                           : Eigen::Vector2d(static_cast<double>(camera.width()), 0.0));
  }
  return errors;
}

std::vector<double> MeasuredDistanceErrors(const Recording& recording, const std::vector<bool>& used,
                                           const BundleState& state, double median_distance) {
  std::vector<double> errors;
  for (std::size_t o = 0; o < used.size(); ++o) {
    const RecordedObservation& seen = recording.observations[o];
    if (!used[o] || seen.view_idx != recording.measured_view_idx) continue;
    const auto view = static_cast<std::size_t>(seen.view_idx);
    const double measured = (recording.cams_from_world[view] * seen.position).norm();
    const double now = (state.cams_from_world[view] * state.Position(seen.point_idx, seen.view_idx)).norm();
    errors.push_back(std::log(now / measured) * median_distance / measured);
  }
  return errors;
}

double MeasuredSigma(std::vector<double> errors) {
  for (double& error : errors) error = std::abs(error);
  return std::clamp(kMedianToSigma * Median(std::move(errors)), kMinMeasuredSigma, kMaxMeasuredSigma);
}

double MedianDistance(const Recording& recording) {
  std::vector<double> distances;
  for (const RecordedObservation& o : recording.observations)
    distances.push_back((recording.cams_from_world[static_cast<std::size_t>(o.view_idx)] * o.position).norm());
  return Median(distances);
}

double NoisePx(const std::vector<Eigen::Vector2d>& errors_px, const std::vector<bool>& used) {
  constexpr double kMinNoisePx = 0.02;
  constexpr double kRayleighMedian = 1.1774;  // median length of a 2D normal vector by its standard deviation
  std::vector<double> lengths;
  for (std::size_t o = 0; o < errors_px.size(); ++o)
    if (used[o]) lengths.push_back(errors_px[o].norm());
  return std::max(kMinNoisePx, Median(lengths) / kRayleighMedian);
}

}  // namespace pliant
