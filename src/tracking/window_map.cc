// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/window_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pliant/base/statistics.h"
#include "pliant/geometry/triangulation.h"
#include "tracking/initial_map.h"

namespace pliant {
namespace {

// Some of a window's points, sorted by id; one entry each in `ids` and `depth_sigmas`, and in the points and modes of
// `all_frames`.
struct CertainPoints {
  std::vector<PointId> ids;
  std::vector<double> depth_sigmas;  // of the distance, map units
  DeformingWindow all_frames;        // a view a frame of the input
  std::vector<InitRejectedPoint> rejected;
  double median_distance = 0;  // of all the window's points
  double median_error_px = 0;
};

CertainPoints ChooseCertain(const SolvedWindow& window, const MapDemands& demands, double focal_px,
                            double max_error_px) {
  const DeformingSolution& solution = window.solution;
  std::vector<double> distances;
  for (const Eigen::Vector3d& position : solution.window.points_in_world) distances.push_back(position.norm());
  const std::vector<double> errors_px = PointErrorsPx(solution.window, focal_px);
  const bool agreed = demands.certainty == Certainty::kPredictedAndAgreed;
  const bool deforms = !solution.window.modes.empty();
  CertainPoints points;
  points.median_distance = Median(distances);
  points.median_error_px = Median(errors_px);
  for (std::size_t i = 0; i < window.ids.size(); ++i) {
    const double sigma = (agreed ? solution.LogDepthSigma(i) : solution.log_depth_sigmas[i]) * distances[i];
    if (!(errors_px[i] <= max_error_px)) {
      points.rejected.push_back({window.ids[i], InitRejection::kReprojection});
    } else if (!(sigma <= demands.max_sigma * points.median_distance)) {
      points.rejected.push_back({window.ids[i], InitRejection::kUncertainDepth});
    } else {
      points.ids.push_back(window.ids[i]);
      points.depth_sigmas.push_back(sigma);
      points.all_frames.points_in_world.push_back(solution.window.points_in_world[i]);
      if (deforms) points.all_frames.modes.push_back(solution.window.modes[i]);
    }
  }
  return points;
}

// How many of `ids` a frame sees.
int CountSeen(const InitFrame& frame, const std::vector<PointId>& ids) {
  return static_cast<int>(
      std::count_if(frame.observations.begin(), frame.observations.end(),
                    [&](const InitObservation& observation) { return PlaceOf(observation.id, ids) >= 0; }));
}

Status EnoughCertain(const InitInput& input, const SolvedWindow& window, const CertainPoints& points,
                     const MapDemands& demands, int min_points, double median_parallax_deg) {
  std::vector<PointId> certain_ids;
  for (std::size_t k = 0; k < points.ids.size(); ++k)
    if (points.depth_sigmas[k] <= demands.certain_sigma * points.median_distance) certain_ids.push_back(points.ids[k]);
  const int seen = CountSeen(input.frames.back(), window.ids);
  const int certain = CountSeen(input.frames.back(), certain_ids);
  if (certain >= min_points && certain >= demands.certain_share * seen) return Status::Ok();
  std::string needed = std::to_string(min_points);
  if (demands.certain_share > 0.0) needed += " and " + Percent(demands.certain_share);
  return {ErrorCode::kInsufficient, "the depth of " + std::to_string(certain) + " of " + std::to_string(seen) +
                                        " points is known to " + Digits(100.0 * demands.certain_sigma, 1) +
                                        " % of the median depth, at least " + needed +
                                        " must be; the median parallax is " + Digits(median_parallax_deg, 1) +
                                        " deg: move the camera sideways or forwards"};
}

// Poses and courses of all frames, the points fixed.
Status LocateAllFrames(const InitInput& input, const SolvedWindow& window, const WindowInitOptions& options,
                       CertainPoints* points) {
  const DeformingWindow& solved = window.solution.window;
  DeformingWindow& all = points->all_frames;
  all.courses.resize(solved.courses.rows(), static_cast<Eigen::Index>(input.frames.size()));
  std::size_t next = 0;  // the first solved view that is not before the frame
  for (std::size_t k = 0; k < input.frames.size(); ++k) {
    while (window.views[next] < k && next + 1 < window.views.size()) ++next;
    const std::size_t before = window.views[next] <= k ? next : next - 1;
    const double share = before == next ? 0.0
                                        : static_cast<double>(k - window.views[before]) /
                                              static_cast<double>(window.views[next] - window.views[before]);
    const Rigid3& a = solved.cams_from_world[before];
    const Rigid3& b = solved.cams_from_world[next];
    all.times.push_back(input.frames[k].frame_idx - input.frames.front().frame_idx);
    all.cams_from_world.emplace_back(a.rotation.slerp(share, b.rotation),
                                     (1.0 - share) * a.translation + share * b.translation);
    all.courses.col(static_cast<Eigen::Index>(k)) =
        (1.0 - share) * solved.courses.col(static_cast<Eigen::Index>(before)) +
        share * solved.courses.col(static_cast<Eigen::Index>(next));
    const auto seen = SeenIn(input.frames[k], input.camera, points->ids, static_cast<int>(k), options);
    all.observations.insert(all.observations.end(), seen.begin(), seen.end());
  }
  auto located = LocateDeformingViews(all, input.camera.MeanFocalLengthPx(), options.window);
  if (!located.ok()) return located.status();
  all = std::move(*located);
  return Status::Ok();
}

// Between the views of the problem a track may be wrong that was right in them, or that had a course to itself there.
void DropContradicting(double focal_px, double max_error_px, CertainPoints* points) {
  DeformingWindow& all = points->all_frames;
  const std::vector<double> errors_px = PointErrorsPx(all, focal_px);
  all.observations.clear();  // they number the points
  std::size_t kept = 0;
  for (std::size_t i = 0; i < errors_px.size(); ++i) {
    if (!(errors_px[i] <= max_error_px)) {
      points->rejected.push_back({points->ids[i], InitRejection::kReprojection});
      continue;
    }
    points->ids[kept] = points->ids[i];
    points->depth_sigmas[kept] = points->depth_sigmas[i];
    all.points_in_world[kept] = all.points_in_world[i];
    if (!all.modes.empty()) all.modes[kept] = all.modes[i];
    ++kept;
  }
  points->ids.resize(kept);
  points->depth_sigmas.resize(kept);
  all.points_in_world.resize(kept);
  if (!all.modes.empty()) all.modes.resize(kept);
}

// At the points of the solution, between the reference and the last view.
double MedianParallaxDeg(const DeformingWindow& window) {
  const Eigen::Vector3d center = window.cams_from_world.back().OriginInSource();
  std::vector<double> angles;
  for (const Eigen::Vector3d& point : window.points_in_world) angles.push_back(AngleBetween(point, point - center));
  return Median(std::move(angles)) * 180.0 / std::numbers::pi;
}

void Measure(const CertainPoints& points, InitMeasurements* measured) {
  measured->inliers = static_cast<int>(points.ids.size());
  measured->median_depth_sigma =
      points.depth_sigmas.empty() ? 0.0 : Median(points.depth_sigmas) / points.median_distance;
  measured->median_error_px = points.median_error_px;
}

// The points not in the map, each with why.
std::vector<InitRejectedPoint> AllRejected(const InitInput& input, CertainPoints* points) {
  std::set<PointId> others;
  for (const InitFrame& frame : input.frames)
    for (const InitObservation& observation : frame.observations) others.insert(observation.id);
  for (const PointId id : points->ids) others.erase(id);
  for (const InitRejectedPoint& rejected : points->rejected) others.erase(rejected.id);
  for (const PointId id : others) points->rejected.push_back({id, InitRejection::kTooFewViews});
  std::sort(points->rejected.begin(), points->rejected.end(),
            [](const InitRejectedPoint& a, const InitRejectedPoint& b) { return a.id < b.id; });
  return std::move(points->rejected);
}

Status FillOutcome(const InitInput& input, double nominal_depth_mm, CertainPoints* points, InitOutcome* outcome) {
  const DeformingWindow& all = points->all_frames;
  const auto nominal = NominalScale(all.points_in_world, nominal_depth_mm);
  if (!nominal.ok()) return nominal.status();
  const double scale = *nominal;
  for (std::size_t i = 0; i < points->ids.size(); ++i)
    outcome->points.push_back({points->ids[i], scale * all.points_in_world[i], scale * points->depth_sigmas[i], 0.0});
  for (std::size_t k = 0; k < input.frames.size(); ++k) {
    const Rigid3& pose = all.cams_from_world[k];
    InitFrameState state{input.frames[k].frame_idx, Rigid3(pose.rotation, scale * pose.translation), {}};
    for (const InitObservation& observation : input.frames[k].observations)
      if (const int point = PlaceOf(observation.id, points->ids); point >= 0)
        state.positions.push_back({observation.id, scale * all.Position(point, static_cast<int>(k))});
    outcome->frames.push_back(std::move(state));
  }
  outcome->rejected = AllRejected(input, points);
  outcome->decision = InitDecision::kMap;
  return Status::Ok();
}

}  // namespace

Status MakeWindowMap(const InitInput& input, const SolvedWindow& window, const MapDemands& demands,
                     const WindowInitOptions& options, double nominal_depth_mm, InitOutcome* outcome) {
  const double focal_px = input.camera.MeanFocalLengthPx();
  CertainPoints points = ChooseCertain(window, demands, focal_px, options.max_error_px);
  Measure(points, &outcome->measured);
  outcome->measured.median_parallax_deg = MedianParallaxDeg(window.solution.window);
  if (Status status =
          EnoughCertain(input, window, points, demands, options.min_points, outcome->measured.median_parallax_deg);
      !status.ok())
    return status;
  if (Status status = LocateAllFrames(input, window, options, &points); !status.ok()) return status;
  DropContradicting(focal_px, options.max_error_px, &points);
  if (const int left = CountSeen(input.frames.back(), points.ids); left < options.min_points)
    return {ErrorCode::kInsufficient, "only " + std::to_string(left) +
                                          " points agree with the frames between those of the window (at least " +
                                          std::to_string(options.min_points) + " must)"};
  Measure(points, &outcome->measured);
  if (Status status = FillOutcome(input, nominal_depth_mm, &points, outcome); !status.ok()) return status;
  const bool agreed = demands.certainty == Certainty::kPredictedAndAgreed;
  outcome->reason = "first map of " + std::to_string(points.ids.size()) + " points from a " +
                    (window.solution.window.modes.empty() ? "rigid" : "deforming") + " window of " +
                    std::to_string(input.frames.size()) + " frames, " + (agreed ? "" : "predicted ") + "depth noise " +
                    Digits(100.0 * outcome->measured.median_depth_sigma, 1) + " % of the median depth";
  if (window.light_is_of_no_use) outcome->reason += ", without light, which says nothing of distance here";
  if (!agreed) outcome->reason += ", on which samples of the points do not agree";
  return Status::Ok();
}

}  // namespace pliant
