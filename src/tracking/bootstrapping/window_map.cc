// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/bootstrapping/window_map.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pliant/base/statistics.h"
#include "pliant/base/text.h"
#include "pliant/scene/frame_report.h"
#include "tracking/bootstrapping/camera_motion_check.h"
#include "tracking/bootstrapping/initial_map.h"
#include "tracking/bootstrapping/window_parts.h"

namespace pliant {
namespace {

constexpr double kMaxErrorRatio = 3.0;  // of a point's error by the median one, where sigmas are scaled with it
constexpr double kMaxOwnSigma = 2.0;    // of points by their own median distance, by what was demanded by that of all
// Above it linear sigmas are far too small where tissue moves as fast as the camera.
constexpr double kMaxProvisionalSigma = 0.06;
constexpr double kMinProvisionalShare = 0.5;  // of the points still seen, that are certain enough

// Some of a window's points; `solution` has one each, in the same order.
struct MapPoints {
  std::vector<PointId> ids;
  std::vector<double> depth_sigmas;  // of the distance, map units
  DeformingSolution solution;
};

// Sigmas of the points' distances, map units.
std::vector<double> DepthSigmas(const DeformingSolution& solution) {
  std::vector<double> sigmas;
  for (std::size_t i = 0; i < solution.window.points_in_world.size(); ++i)
    sigmas.push_back(solution.LogDepthSigma(i) * solution.window.points_in_world[i].norm());
  return sigmas;
}

// u_i: sigmas by the median distance, or by the point's own where that is larger and counts.
std::vector<double> Uncertainties(const MapPoints& points, const MapDemands& demands, double median_distance) {
  std::vector<double> uncertainties;
  for (std::size_t i = 0; i < points.ids.size(); ++i) {
    const double own = demands.far_by_own_distance ? points.solution.window.points_in_world[i].norm() : 0.0;
    uncertainties.push_back(points.depth_sigmas[i] / std::max(own, median_distance));
  }
  return uncertainties;
}

// (W15) By the median distance, or of the points' log distances, as their spread is.
double MedianSigma(const MapPoints& points, bool by_own_distance) {
  std::vector<double> sigmas;
  for (std::size_t i = 0; i < points.ids.size(); ++i)
    sigmas.push_back(points.depth_sigmas[i] /
                     (by_own_distance ? points.solution.window.points_in_world[i].norm() : 1.0));
  return Median(std::move(sigmas)) / (by_own_distance ? 1.0 : points.solution.window.MedianDistance());
}

// Those whose errors (`errors_px`, one each) and uncertainties are small enough, sorted by id, without their
// observations; `rejected`, which may be null, becomes the others.
MapPoints ChooseCertain(const MapPoints& points, const std::vector<double>& errors_px, double max_error_px,
                        const MapDemands& demands, double median_distance, std::vector<InitRejectedPoint>* rejected) {
  const std::vector<double> uncertainties = Uncertainties(points, demands, median_distance);
  const DeformingSolution& from = points.solution;
  std::vector<std::size_t> order(points.ids.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return points.ids[a] < points.ids[b]; });
  MapPoints chosen;
  DeformingSolution& to = chosen.solution;
  to.nodes = from.nodes;
  to.window.times = from.window.times;
  to.window.cams_from_world = from.window.cams_from_world;
  to.window.coefficients = from.window.coefficients;
  to.window.cue = from.window.cue;
  for (const std::size_t i : order) {
    const bool agrees = errors_px[i] <= max_error_px;
    if (!agrees || !(uncertainties[i] <= demands.max_sigma)) {
      if (rejected != nullptr)
        rejected->push_back({points.ids[i], agrees ? InitRejection::kUncertainDepth : InitRejection::kReprojection});
      continue;
    }
    chosen.ids.push_back(points.ids[i]);
    chosen.depth_sigmas.push_back(points.depth_sigmas[i]);
    to.window.points_in_world.push_back(from.window.points_in_world[i]);
    if (!from.window.shapes.empty()) to.window.shapes.push_back(from.window.shapes[i]);
    if (!from.sample_sigmas.empty()) to.sample_sigmas.push_back(from.sample_sigmas[i]);
  }
  return chosen;
}

// (W15) The error that one depth for all points would have in the window's last frame, or one distance where that is
// better.
double DepthSpread(const DeformingWindow& window) {
  const int last = static_cast<int>(window.cams_from_world.size()) - 1;
  std::vector<double> depths;
  std::vector<double> distances;
  for (std::size_t i = 0; i < window.points_in_world.size(); ++i) {
    const Eigen::Vector3d in_cam = window.cams_from_world.back() * window.Position(static_cast<int>(i), last);
    depths.push_back(in_cam.z());
    distances.push_back(in_cam.norm());
  }
  return std::min(LogSpread(std::move(depths)), LogSpread(std::move(distances)));
}

// Errors of a rigid window are the scene's, where that deforms, or the noise of the tracks, where neighbors share none:
// what is wrong stands out from them.
double MaxErrorPx(const SolvedWindow& window, const std::vector<double>& errors_px, const WindowInitOptions& options) {
  const bool is_noise = window.IsRigid() && window.solution.residual_correlation <= kMaxNoiseCorrelation;
  if (window.deforming == nullptr && !is_noise) return options.max_error_px;
  return std::max(options.max_error_px, kMaxErrorRatio * Median(errors_px));
}

// How many of `ids` a frame sees.
int CountSeen(const InitFrame& frame, const std::vector<PointId>& ids) {
  return static_cast<int>(
      std::count_if(frame.observations.begin(), frame.observations.end(),
                    [&](const InitObservation& observation) { return IndexOf(observation.id, ids) >= 0; }));
}

Status EnoughCertain(const InitInput& input, const SolvedWindow& window, const MapPoints& points,
                     const MapDemands& demands, int min_points, double median_distance, double median_parallax_deg) {
  const std::vector<double> uncertainties = Uncertainties(points, demands, median_distance);
  std::vector<PointId> certain_ids;
  for (std::size_t k = 0; k < points.ids.size(); ++k)
    if (uncertainties[k] <= demands.certain_sigma) certain_ids.push_back(points.ids[k]);
  const int seen = CountSeen(input.frames.back(), window.ids);
  const int certain = CountSeen(input.frames.back(), certain_ids);
  if (certain >= min_points && certain >= demands.certain_share * seen) return Status::Ok();
  std::string needed = std::to_string(min_points);
  if (demands.certain_share > 0.0) needed += " and " + Percent(demands.certain_share);
  return {ErrorCode::kInsufficient, "the depth of " + std::to_string(certain) + " of " + std::to_string(seen) +
                                        " points is known to " + Digits(100.0 * demands.certain_sigma, 1) +
                                        " % of the median depth, at least " + needed +
                                        " must be; the median parallax is " + Digits(median_parallax_deg, 1) +
                                        " deg; " + AdviceOnUncertainDepth(median_parallax_deg, input.camera_origin)};
}

// The points in all frames of the input, fixed; poses and coefficients start between those of the solved views.
Status OptimizeAllViews(const InitInput& input, const SolvedWindow& window, const WindowInitOptions& options,
                        MapPoints* points) {
  DeformingWindow solved = points->solution.window;
  solved.cams_from_world = window.solution.window.cams_from_world;
  solved.coefficients = window.solution.window.coefficients;
  auto optimized = OptimizeDeformingViews(InAllFrames(input, window.views, solved, points->ids, options),
                                          input.camera.MeanFocalLengthPx(), options.window, input.threads);
  if (!optimized.ok()) return optimized.status();
  points->solution.window = std::move(*optimized);
  return Status::Ok();
}

// The points seen in enough frames to be added to those of the map, sorted.
std::vector<PointId> WindowPointsToAdd(const InitInput& input, const MapPoints& points, double min_frame_share) {
  std::map<PointId, int> seen;
  for (const InitFrame& frame : input.frames)
    for (const InitObservation& observation : frame.observations) ++seen[observation.id];
  std::vector<PointId> ids;
  for (const auto& [id, count] : seen)
    if (count >= min_frame_share * static_cast<double>(input.frames.size()) && IndexOf(id, points.ids) < 0)
      ids.push_back(id);
  return ids;
}

// Optimizes all points by all frames, with poses and coefficients fixed, after others that were seen in enough frames
// were added. What is uncertain, or wrong between the views of the problem, is then left out.
Status OptimizePoints(const InitInput& input, const MapDemands& demands, const WindowInitOptions& options,
                      double max_error_px, MapPoints* points, std::vector<InitRejectedPoint>* rejected) {
  const double focal_px = input.camera.MeanFocalLengthPx();
  const std::vector<PointId> added = WindowPointsToAdd(input, *points, options.min_frame_share);
  std::vector<DeformingObservation> observations;
  for (std::size_t k = 0; k < input.frames.size(); ++k) {
    const auto seen =
        SeenIn(input, input.frames[k], added, static_cast<int>(k), WithCue(options, points->solution.window.cue));
    observations.insert(observations.end(), seen.begin(), seen.end());
  }
  auto optimized = OptimizeDeformingPoints(points->solution, observations, static_cast<int>(added.size()), focal_px,
                                           options.window, input.threads);
  if (!optimized.ok()) return optimized.status();
  MapPoints all{points->ids, {}, std::move(*optimized)};
  all.ids.insert(all.ids.end(), added.begin(), added.end());
  all.depth_sigmas = DepthSigmas(all.solution);
  const std::vector<double> errors_px = PointErrorsPx(all.solution.window, focal_px);
  if (demands.scales_sigmas_with_error) {
    const double median_px = Median(errors_px);
    max_error_px = std::min(max_error_px, kMaxErrorRatio * median_px);
    for (std::size_t i = 0; i < all.ids.size(); ++i) all.depth_sigmas[i] *= std::max(1.0, errors_px[i] / median_px);
  }
  *points = ChooseCertain(all, errors_px, max_error_px, demands, all.solution.window.MedianDistance(), rejected);
  return Status::Ok();
}

// (W15) Whether the map is provisional, and may be. Points that are certain by the median distance of all may be near
// ones of a window that knows nothing: what is left is judged by its own. Before a camera that hardly moves noise
// passes for motion, and so does tissue that swells; of a rigid scene nothing else asks for that (W14). Depths that
// hardly stand out are as wrong as one constant depth unless their sigmas are small, however long the window has
// waited.
Status CheckDepthSignal(const InitInput& input, const SolvedWindow& window, const MapDemands& demands,
                        const WindowInitOptions& options, InitOutcome* outcome) {
  const InitMeasurements& measured = outcome->measured;
  const std::string advice = AdviceOnUncertainDepth(measured.median_parallax_deg, input.camera_origin);
  outcome->provisional = demands.provisional || window.is_contradicted || measured.DepthSignal() < kMinDepthSignal;
  const bool stands_out =
      measured.DepthSignal() >= (demands.far_by_own_distance ? kMinDepthSignal : kMinProvisionalSignal);
  const double max_sigma = stands_out ? kMaxOwnSigma * demands.max_sigma : options.max_depth_sigma;
  const bool explained = window.solution.residual_correlation <= kMaxNoiseCorrelation;
  const bool may_be_motion = window.IsRigid() && !stands_out && !explained;
  const bool known = demands.provisional ? stands_out && measured.median_depth_sigma <= kMaxProvisionalSigma
                                         : measured.median_depth_sigma <= max_sigma;
  if (may_be_motion)
    return {ErrorCode::kDegenerate,
            "the depths hardly stand out, and a rigid motion does not explain all: the errors of neighbors have a "
            "correlation of " +
                Digits(window.solution.residual_correlation, 2) +
                ", the scene may deform before a camera that stands still; " + advice};
  if (known && (!outcome->provisional || options.provisional == Switch::kOn)) return Status::Ok();
  return {stands_out ? ErrorCode::kInsufficient : ErrorCode::kDegenerate,
          "the depths spread by " + Digits(100.0 * measured.depth_spread, 1) + " % and are known to " +
              Digits(100.0 * measured.median_depth_sigma, 1) + " %: hardly better than one constant depth; " + advice};
}

// (W21) Linear sigmas of a deforming window know of one minimum alone. Where those of a part of its frames say that
// they are too small, the map is provisional.
Status CheckLaterPart(const InitInput& input, const SolvedWindow& window, const MapPoints& points,
                      const WindowInitOptions& options, double nominal_depth_mm, InitOutcome* outcome) {
  if (window.IsRigid()) return Status::Ok();
  InitMeasurements& measured = outcome->measured;
  measured.sigma_factor = SigmaFactorOfLaterPart(input, window, points.ids, options, nominal_depth_mm);
  outcome->provisional |= measured.DepthSignal() < kMinDepthSignal;
  if (!outcome->provisional || options.provisional == Switch::kOn) return Status::Ok();
  return {ErrorCode::kInsufficient,
          "the depths spread by " + Digits(100.0 * measured.depth_spread, 1) + " % and seem known to " +
              Digits(100.0 * measured.median_depth_sigma, 1) +
              " %, but by the later two thirds of the frames that is too little by a factor of " +
              Digits(measured.sigma_factor, 1) + "; " +
              AdviceOnUncertainDepth(measured.median_parallax_deg, input.camera_origin)};
}

// The points not in the map, each with why.
std::vector<InitRejectedPoint> AllRejected(const InitInput& input, const MapPoints& points,
                                           std::vector<InitRejectedPoint> rejected) {
  std::set<PointId> others;
  for (const InitFrame& frame : input.frames)
    for (const InitObservation& observation : frame.observations) others.insert(observation.id);
  for (const PointId id : points.ids) others.erase(id);
  for (const InitRejectedPoint& point : rejected) others.erase(point.id);
  for (const PointId id : others) rejected.push_back({id, InitRejection::kTooFewViews});
  std::sort(rejected.begin(), rejected.end(),
            [](const InitRejectedPoint& a, const InitRejectedPoint& b) { return a.id < b.id; });
  return rejected;
}

Status FillOutcome(const InitInput& input, double nominal_depth_mm, const MapPoints& points, InitOutcome* outcome) {
  const DeformingWindow& all = points.solution.window;
  const auto nominal = NominalScale(all.points_in_world, nominal_depth_mm);
  if (!nominal.ok()) return nominal.status();
  const double scale = *nominal;
  for (std::size_t i = 0; i < points.ids.size(); ++i)
    outcome->points.push_back({points.ids[i], scale * all.points_in_world[i], scale * points.depth_sigmas[i], 0.0});
  for (std::size_t k = 0; k < input.frames.size(); ++k) {
    const Rigid3& pose = all.cams_from_world[k];
    InitFrameState state{input.frames[k].frame_idx, Rigid3(pose.rotation, scale * pose.translation), {}};
    for (const InitObservation& observation : input.frames[k].observations)
      if (const int point = IndexOf(observation.id, points.ids); point >= 0)
        state.positions.push_back({observation.id, scale * all.Position(point, static_cast<int>(k))});
    outcome->frames.push_back(std::move(state));
  }
  outcome->deforming = all.coefficients.rows() > 0;
  outcome->decision = InitDecision::kMap;
  return Status::Ok();
}

}  // namespace

MapDemands DemandsOf(const WindowInitOptions& options, double relaxed) {
  const double certain_sigma = std::lerp(options.certain_depth_sigma, options.last_depth_sigma, relaxed);
  return {.certain_sigma = certain_sigma,
          .max_sigma = std::max(certain_sigma, options.max_depth_sigma),
          .certain_share = (1.0 - relaxed) * options.min_certain_share};
}

MapDemands ProvisionalDemands(const DeformingWindow& window, bool far_by_own_distance) {
  const double certain_sigma = std::min(DepthSpread(window) / kMinProvisionalSignal, kMaxProvisionalSigma);
  return {.certain_sigma = certain_sigma,
          .max_sigma = kMinProvisionalSignal * certain_sigma,
          .certain_share = kMinProvisionalShare,
          .far_by_own_distance = far_by_own_distance,
          .provisional = true};
}

int NeededPoints(const InitInput& input, const WindowInitOptions& options) {
  const int half = static_cast<int>(input.frames.front().observations.size()) / 2;
  return std::min(options.min_points, std::max(half, kFewestPoints));
}

Status MakeWindowMap(const InitInput& input, const SolvedWindow& window, const MapDemands& demands,
                     const WindowInitOptions& options, double nominal_depth_mm, InitOutcome* outcome) {
  const double focal_px = input.camera.MeanFocalLengthPx();
  const MapPoints all{window.ids, DepthSigmas(window.solution), window.solution};
  const std::vector<double> errors_px = PointErrorsPx(window.solution.window, focal_px);
  const double median_distance = window.solution.window.MedianDistance();
  const double max_error_px = MaxErrorPx(window, errors_px, options);
  MapPoints points = ChooseCertain(all, errors_px, max_error_px, demands, median_distance, nullptr);
  const auto measure = [&] {
    outcome->measured.inliers = static_cast<int>(points.ids.size());
    outcome->measured.median_depth_sigma = points.ids.empty() ? 0.0 : MedianSigma(points, demands.far_by_own_distance);
    outcome->measured.depth_spread = points.ids.empty() ? 0.0 : DepthSpread(points.solution.window);
  };
  measure();
  // Of this window, and not of one that made no map.
  outcome->measured.sigma_factor = 1.0;
  outcome->measured.still_camera_error_ratio = 0.0;
  outcome->moves_by_depth = false;
  outcome->measured.median_error_px = Median(errors_px);
  const DeformingWindow& solved = window.solution.window;
  outcome->measured.median_parallax_deg =
      MedianParallaxRad(solved, solved.cams_from_world.back()) * 180.0 / std::numbers::pi;
  if (Status status = EnoughCertain(input, window, points, demands, NeededPoints(input, options), median_distance,
                                    outcome->measured.median_parallax_deg);
      !status.ok())
    return status;
  if (Status status = OptimizeAllViews(input, window, options, &points); !status.ok()) return status;
  std::vector<InitRejectedPoint> rejected;
  if (Status status = OptimizePoints(input, demands, options, max_error_px, &points, &rejected); !status.ok())
    return status;
  const int needed = NeededPoints(input, options);
  if (const int left = CountSeen(input.frames.back(), points.ids); left < needed)
    return {ErrorCode::kInsufficient, "only " + std::to_string(left) +
                                          " points agree with the frames between those of the window (at least " +
                                          std::to_string(needed) + " must)"};
  measure();
  if (Status status = CheckDepthSignal(input, window, demands, options, outcome); !status.ok()) return status;
  if (Status status = CheckCameraMotion(input, window, options, outcome); !status.ok()) return status;
  if (Status status = CheckLaterPart(input, window, points, options, nominal_depth_mm, outcome); !status.ok())
    return status;
  if (Status status = FillOutcome(input, nominal_depth_mm, points, outcome); !status.ok()) return status;
  outcome->refinable = !outcome->deforming && options.refine_rigid == Switch::kOn;
  outcome->allows_deformation = window.deforming != nullptr;
  outcome->far_by_own_distance = demands.far_by_own_distance;
  outcome->uses_prior = window.solution.window.cue == DistanceCue::kPrior;
  outcome->rejected = AllRejected(input, points, std::move(rejected));
  outcome->reason = std::string(outcome->provisional ? "provisional" : "first") + " map of " +
                    std::to_string(points.ids.size()) + " points from a " + (window.IsRigid() ? "rigid" : "deforming") +
                    " window of " + std::to_string(input.frames.size()) + " frames, depth noise " +
                    Digits(100.0 * outcome->measured.median_depth_sigma, 1) + " % of the median depth";
  if (const double ratio = outcome->measured.still_camera_error_ratio; ratio > 0.0)
    outcome->reason += "; with a camera that stands still the errors would be " + Digits(ratio, 1) + " times as large";
  if (window.deforming != nullptr)
    outcome->reason += "; the scene deforms, but so little that depths are more certain without a model of it";
  if (window.light_is_of_no_use) outcome->reason += "; brightness is no depth cue in these images and was not used";
  if (outcome->uses_prior) outcome->reason += "; the depth prior was used";
  return Status::Ok();
}

}  // namespace pliant
