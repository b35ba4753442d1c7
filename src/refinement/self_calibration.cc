// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/refinement/self_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/LU>

#include "pliant/base/statistics.h"
#include "pliant/base/text.h"
#include "refinement/bundle.h"
#include "refinement/check_recording.h"
#include "refinement/free_intrinsics.h"
#include "refinement/key_views.h"
#include "refinement/residual_correlation.h"

namespace pliant {
namespace {

constexpr double kLargestFactor = 1.9;  // and its inverse: what is searched
constexpr double kCoarseStep = 1.1;
constexpr double kFineLogStep = 0.02;  // of the parabola through the costs around the minimum
// Of the image's corner by its distance from the center: that of distortion, and the most that an uncertain one moves.
constexpr double kDistortionStep = 0.02;
constexpr double kLargestDistortionSigma = 0.05;
constexpr double kCoarseTolerance = 1e-3;
constexpr double kFineTolerance = 1e-6;       // of costs that are subtracted from each other
constexpr double kSignificantDistortion = 3;  // standard deviations
constexpr int kMostMoves = 12;
constexpr double kWideLoss = 10;  // times the noise
constexpr int kViewsPerTrack = 15;
constexpr double kStartLogDepthSigma = 5;  // holds the unit, and says nothing of the depths, which are wrong

// What is searched.
struct Intrinsics {
  double log_factor = 0;  // of the focal length
  double distortion = 0;  // k of SIMPLE_RADIAL
};

struct Solution {
  Intrinsics at;
  double cost = 0;
  BundleState state;
};

class IntrinsicsSearch {
 public:
  IntrinsicsSearch(const Camera& camera, const Recording& recording, const RefineOptions& options,
                   const std::function<bool()>& goes_on)
      : camera_(camera), recording_(recording), options_(options), goes_on_(goes_on) {
    used_.assign(recording.observations.size(), true);
    KeepDetermined(recording, &used_);
    used_ = UsedInKeyViews(recording, used_, StrideOfKeyViews(recording, used_, kViewsPerTrack));
    usable_ = used_;
    distance_ = MedianDistance(recording);
    const double corner_px = 0.5 * std::hypot(camera.width(), camera.height());
    distortion_unit_ = std::pow(camera.MeanFocalLengthPx() / corner_px, 2);
  }

  Result<SelfCalibration> Run() {
    auto found = Search();
    if (stopped_) return Status(ErrorCode::kInterrupted, "stopped while the focal length was estimated");
    return found;
  }

 private:
  Result<SelfCalibration> Search() {
    if (!std::count(used_.begin(), used_.end(), true)) return NotDetermined("too few points are seen for long enough");
    Solution start;
    start.state.cams_from_world = recording_.cams_from_world;
    start.state.rest_positions = recording_.rest_positions;
    auto best = SolveAt({}, start.state);
    if (!best) return NotDetermined("there is no solution with the assumed one");
    noise_px_ = NoiseOf(*best);
    RejectWrongTracks(*best);
    best = SolveAt({}, best->state);
    if (!best) return NotDetermined("there is no solution with the assumed one");
    // Away from the assumed one, each begun with its neighbor's solution.
    const Solution center = *best;
    for (const double direction : {1.0, -1.0}) {
      Solution last = center;
      for (double log_factor = std::log(kCoarseStep); log_factor <= std::log(kLargestFactor);
           log_factor += std::log(kCoarseStep)) {
        const auto next = SolveAt({direction * log_factor, 0}, last.state);
        if (!next) break;
        last = *next;
        if (last.cost < best->cost) best = last;
      }
    }
    const auto minimum = FocalMinimum(*best);
    // A distorted recording has a minimum in both where it has none, or not a rigid one, without distortion.
    if (CanBeDistorted())
      if (const auto distorted = JointMinimum(minimum ? minimum->solution : *best)) return Checked(*distorted);
    if (!minimum)
      return NotDetermined("no focal length from " + Digits(1 / kLargestFactor, 2) + " to " +
                           Digits(kLargestFactor, 2) + " times the assumed one fits better than its neighbors");
    return Checked(*minimum);
  }

  static Status NotDetermined(const std::string& why) {
    return {ErrorCode::kInsufficient, "the recording does not determine the focal length: " + why};
  }

  // A minimum of the costs, with their second derivatives there.
  struct Minimum {
    Solution solution;
    Eigen::Matrix2d curvature;  // by the logarithm of the focal length and by distortion
    bool has_distortion = false;
  };

  bool GoesOn() const {
    if (goes_on_ && !goes_on_()) stopped_ = true;
    return !stopped_;
  }

  bool CanBeDistorted() const { return camera_.model_id() == CameraModelId::kSimplePinhole; }

  std::optional<Camera> CameraAt(const Intrinsics& at) const {
    const auto camera = camera_.WithFocalLengthTimes(std::exp(at.log_factor));
    if (!camera.ok()) return std::nullopt;
    if (at.distortion == 0) return *camera;
    const auto params = camera->params();
    const auto distorted = Camera::Create(CameraModelId::kSimpleRadial, camera->width(), camera->height(),
                                          std::array{params[0], params[1], params[2], at.distortion});
    return distorted.ok() ? std::optional(*distorted) : std::nullopt;
  }

  std::optional<Solution> SolveAt(const Intrinsics& at, const BundleState& start,
                                  double function_tolerance = kCoarseTolerance) const {
    const auto camera = CameraAt(at);
    if (!camera || !GoesOn()) return std::nullopt;
    BundleInput input{.camera = *camera, .recording = recording_};
    input.used = used_;
    input.distance = distance_;
    input.sigmas.noise_px = noise_px_;
    input.sigmas.log_distance = kStartLogDepthSigma;
    input.function_tolerance = function_tolerance;
    Solution solution{at, 0, start};
    const auto summary = SolveBundle(
        input, options_.max_iterations, [this](double) { return GoesOn(); }, &solution.state);
    if (!summary.ok()) return std::nullopt;
    solution.cost = summary->final_cost;
    return solution;
  }

  std::vector<Eigen::Vector2d> ErrorsOf(const Solution& solution) const {
    return ReprojectionErrors(*CameraAt(solution.at), recording_, solution.state);
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

  Solution SolvedBeside(const Solution& center, double log_factor, double distortion) const {
    const auto solved =
        SolveAt({center.at.log_factor + log_factor, center.at.distortion + distortion}, center.state, kFineTolerance);
    return solved ? *solved : Solution{center.at, std::numeric_limits<double>::infinity(), center.state};
  }

  // A parabola through the costs around the minimum without distortion, moved until its vertex lies between them.
  std::optional<Minimum> FocalMinimum(Solution center) const {
    for (int move = 0; move < kMostMoves; ++move) {
      center = SolvedBeside(center, 0, 0);
      const Solution lower = SolvedBeside(center, -kFineLogStep, 0);
      const Solution upper = SolvedBeside(center, kFineLogStep, 0);
      if (!std::isfinite(center.cost + lower.cost + upper.cost)) return std::nullopt;
      if (lower.cost < center.cost || upper.cost < center.cost) {
        center = lower.cost < upper.cost ? lower : upper;
        continue;
      }
      const double curvature = (lower.cost + upper.cost - 2 * center.cost) / (kFineLogStep * kFineLogStep);
      const double slope = (upper.cost - lower.cost) / (2 * kFineLogStep);
      if (!(curvature > 0)) return std::nullopt;
      return Minimum{SolvedBeside(center, -slope / curvature, 0), Eigen::Vector2d(curvature, 1).asDiagonal()};
    }
    return std::nullopt;
  }

  // Solves for both at once, since with the depths they are a long valley.
  std::optional<Solution> SolveForBoth(const Solution& start) const {
    const auto params = CameraAt({start.at.log_factor, 0})->params();
    RadialIntrinsics intrinsics{params[0], params[1], params[2], start.at.distortion};
    Solution solution = start;
    if (!SolveFreeIntrinsics(
             recording_, used_, noise_px_, [this] { return GoesOn(); }, &intrinsics, &solution.state)
             .ok())
      return std::nullopt;
    solution.at = {std::log(intrinsics.focal_px / camera_.MeanFocalLengthPx()), intrinsics.k};
    return CameraAt(solution.at) ? std::optional(solution) : std::nullopt;  // some are no camera's
  }

  // The second derivatives of the costs around a solution for both; nothing where they are no minimum's.
  std::optional<Minimum> WithCurvature(const Solution& solution) const {
    const Eigen::Vector2d step(kFineLogStep, kDistortionStep * distortion_unit_);
    const Solution center = SolvedBeside(solution, 0, 0);
    const auto cost = [&](double log_factor, double distortion) {
      return SolvedBeside(center, log_factor * step.x(), distortion * step.y()).cost - center.cost;
    };
    // In steps.
    Eigen::Matrix2d curvature;
    curvature(0, 0) = cost(1, 0) + cost(-1, 0);
    curvature(1, 1) = cost(0, 1) + cost(0, -1);
    curvature(0, 1) = curvature(1, 0) = 0.25 * (cost(1, 1) + cost(-1, -1) - cost(1, -1) - cost(-1, 1));
    if (!curvature.allFinite() || curvature(0, 0) <= 0 || curvature.determinant() <= 0) return std::nullopt;
    const Eigen::DiagonalMatrix<double, 2> by_step(step.cwiseInverse());
    return Minimum{center, by_step * curvature * by_step, true};
  }

  // First with a loss so wide that tracks which only distortion makes wrong pull, too. Nothing where there is no
  // minimum, or where what it says of distortion is not certain.
  std::optional<Minimum> JointMinimum(const Solution& start) {
    const std::vector<bool> used_without = used_;
    const double noise_without_px = noise_px_;
    used_ = usable_;
    noise_px_ = kWideLoss * NoiseOf(start);
    auto solution = SolveForBoth(start);
    if (solution) {
      RejectWrongTracks(*solution);
      noise_px_ = NoiseOf(*solution);
      solution = SolveForBoth(*solution);
    }
    if (solution) noise_px_ = NoiseOf(*solution);
    auto minimum = solution ? WithCurvature(*solution) : std::nullopt;
    if (minimum) {
      const double sigma = Sigmas(*minimum).y();
      if (sigma < kLargestDistortionSigma * distortion_unit_ &&
          std::abs(minimum->solution.at.distortion) > kSignificantDistortion * sigma)
        return minimum;
    }
    used_ = used_without;
    noise_px_ = noise_without_px;
    return std::nullopt;
  }

  // Of the logarithm of the focal length and of distortion. The costs are by the noise under the assumed intrinsics.
  Eigen::Vector2d Sigmas(const Minimum& minimum) const {
    const double noise_px = NoiseOf(minimum.solution);
    const Eigen::Matrix2d per_measurement =
        minimum.curvature * (noise_px_ * noise_px_) / (noise_px * noise_px) / ObservationsPerTrack();
    return per_measurement.inverse().diagonal().cwiseSqrt();
  }

  Result<SelfCalibration> Checked(const Minimum& minimum) const {
    const auto camera = CameraAt(minimum.solution.at);
    if (!camera) return NotDetermined("the best one is that of no camera");
    const double correlation =
        ResidualCorrelation(recording_, used_, ErrorsOf(minimum.solution), recording_.patch_px).value;
    if (correlation > options_.max_correlation)
      return Status(ErrorCode::kDegenerate,
                    "no focal length explains the recording as rigid, and only a rigid scene determines it");
    const Eigen::Vector2d sigmas = Sigmas(minimum);
    if (sigmas.x() > kLargestFocalLengthLogSigma)
      return NotDetermined("it would be known to " + Percent(sigmas.x()) + " only; move the camera more, and turn it");
    return SelfCalibration{*camera, sigmas.x(), minimum.has_distortion ? std::optional(sigmas.y()) : std::nullopt};
  }

  const Camera& camera_;
  const Recording& recording_;
  const RefineOptions& options_;
  const std::function<bool()>& goes_on_;
  mutable bool stopped_ = false;  // what is found after it means nothing
  std::vector<bool> usable_;      // observations, whether they fit or not
  std::vector<bool> used_;
  double distance_ = 1;
  double distortion_unit_ = 1;  // k that moves the corner by its distance from the center
  double noise_px_ = kStartNoisePx;
};

}  // namespace

Result<SelfCalibration> SelfCalibrate(const Camera& camera, const Recording& recording, const RefineOptions& options,
                                      const std::function<bool()>& goes_on) {
  if (Status status = CheckRecording(recording, options); !status.ok()) return status;
  return IntrinsicsSearch(camera, recording, options, goes_on).Run();
}

}  // namespace pliant
