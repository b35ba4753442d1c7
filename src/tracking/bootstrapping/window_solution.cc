// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/bootstrapping/window_solution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "pliant/base/statistics.h"
#include "pliant/base/text.h"
#include "pliant/estimation/window/shape_basis.h"
#include "pliant/estimation/window/window_refinement.h"
#include "pliant/geometry/triangulation.h"
#include "pliant/scene/frame_report.h"
#include "tracking/bootstrapping/initial_map.h"
#include "tracking/bootstrapping/window_parts.h"

namespace pliant {
namespace {

constexpr std::size_t kMinPoints = 12;
constexpr std::size_t kMinFrames = 6;
// A light that leaves more of the spread of log distances than this says nothing of distance.
constexpr double kMaxOfSpread = 0.8;
constexpr std::ptrdiff_t kMinPriorPoints = 40;  // of a frame, to be compared with the solution

// In the frames that a solution is compared with it in, at least.
bool HasPrior(const InitInput& input, std::size_t frames, const WindowInitOptions& options) {
  if (options.prior == Switch::kOff || frames < kMinFrames) return false;
  return std::ranges::all_of(std::array{std::size_t{0}, frames - 1}, [&](std::size_t k) {
    const auto known = std::ranges::count_if(input.frames[k].observations, [](const InitObservation& observation) {
      return std::isfinite(observation.log_prior);
    });
    return known >= kMinPriorPoints;
  });
}

// `count` of these points, evenly over the image, each where it is first seen.
std::vector<PointId> EvenlyOverImage(const InitInput& input, const std::vector<std::size_t>& views,
                                     const std::vector<PointId>& ids, std::size_t count) {
  std::vector<Eigen::Vector3d> positions;
  std::vector<int> all;
  for (const PointId id : ids) {
    const InitObservation* seen = nullptr;
    for (std::size_t v = 0; seen == nullptr; ++v) seen = FindById(input.frames[views[v]].observations, id);
    all.push_back(static_cast<int>(positions.size()));
    positions.emplace_back(seen->pixel.x(), seen->pixel.y(), 0.0);
  }
  std::vector<PointId> chosen;
  for (const int i : SpreadPositions(positions, all, count)) chosen.push_back(ids[static_cast<std::size_t>(i)]);
  return chosen;
}

// The points that are seen in enough views; where they are too many, those still seen, then those seen most, and of
// those that are seen as often some from everywhere.
std::vector<PointId> ChoosePoints(const InitInput& input, const std::vector<std::size_t>& views,
                                  const WindowInitOptions& options) {
  std::map<PointId, int> seen;
  for (const std::size_t view : views)
    for (const InitObservation& observation : input.frames[view].observations) ++seen[observation.id];
  const auto bonus = static_cast<int>(views.size());
  const int least = std::min(bonus, std::max(options.min_views, options.min_views * bonus / options.views));
  for (const InitObservation& observation : input.frames.back().observations)
    if (const auto found = seen.find(observation.id); found != seen.end() && found->second >= least)
      found->second += bonus;
  std::map<int, std::vector<PointId>, std::greater<>> by_count;
  for (const auto& [id, count] : seen)
    if (count >= least) by_count[count].push_back(id);
  std::vector<PointId> ids;
  for (const auto& [count, of_count] : by_count) {
    const std::size_t left = static_cast<std::size_t>(options.max_points) - ids.size();
    const auto& taken = of_count.size() <= left ? of_count : EvenlyOverImage(input, views, of_count, left);
    ids.insert(ids.end(), taken.begin(), taken.end());
  }
  std::sort(ids.begin(), ids.end());
  return ids;
}

using Positions = std::map<PointId, Eigen::Vector3d>;  // world

// Puts a frame's points that are not known yet at the distance that the light says, relative to the others.
void AddNewPoints(const std::vector<DeformingObservation>& observations, const std::vector<PointId>& ids,
                  const Rigid3& cam_from_world, double nominal_depth_mm, Positions* known) {
  std::vector<double> lights;
  std::vector<double> distances;
  std::vector<double> offsets;  // log distance less the light's
  for (const DeformingObservation& observation : observations) {
    if (std::isfinite(observation.log_cue)) lights.push_back(observation.log_cue);
    const auto found = known->find(ids[static_cast<std::size_t>(observation.point_idx)]);
    if (found == known->end()) continue;
    distances.push_back((cam_from_world * found->second).norm());
    if (std::isfinite(observation.log_cue)) offsets.push_back(std::log(distances.back()) - observation.log_cue);
  }
  const double unlit = distances.empty() ? nominal_depth_mm : Median(distances);
  double offset = 0;
  if (!offsets.empty())
    offset = Median(offsets);
  else if (!lights.empty())
    offset = std::log(nominal_depth_mm) - Median(lights);
  for (const DeformingObservation& observation : observations) {
    const double distance = std::isfinite(observation.log_cue) ? std::exp(offset + observation.log_cue) : unlit;
    known->try_emplace(ids[static_cast<std::size_t>(observation.point_idx)],
                       cam_from_world.Inverse() * (distance * observation.ray));
  }
}

// Points where the light puts them, or all at one distance; views optimized against them as if nothing deformed. A
// point that is first seen in a later view is put there, among those known already. `ids` becomes those of its points.
Result<DeformingWindow> Start(const InitInput& input, const std::vector<std::size_t>& views,
                              const WindowInitOptions& options, double nominal_depth_mm, std::vector<PointId>* ids) {
  DeformingWindow start;
  start.cue = options.cue;
  Positions known;
  Rigid3 near;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const InitFrame& frame = input.frames[views[v]];
    if (v > 0) {
      InitialMap map;
      for (const auto& [id, position] : known) {
        map.ids.push_back(id);
        map.positions.push_back(position);
      }
      const auto pose = EstimateFramePoseRoughly(input.camera, frame, map, near);
      if (!pose.ok()) return pose.status();
      near = *pose;
    }
    start.cams_from_world.push_back(near);
    start.times.push_back(frame.frame_idx - input.frames.front().frame_idx);
    AddNewPoints(SeenIn(input, frame, *ids, 0, options), *ids, near, nominal_depth_mm, &known);
  }
  ids->clear();
  for (const auto& [id, position] : known) {
    ids->push_back(id);
    start.points_in_world.push_back(position);
  }
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto seen = SeenIn(input, input.frames[views[v]], *ids, static_cast<int>(v), options);
    start.observations.insert(start.observations.end(), seen.begin(), seen.end());
  }
  return start;
}

// (W15) As of a map, but of all of the window's points and by their distances in the reference.
double DepthSignal(const DeformingSolution& solution) {
  std::vector<double> distances;
  for (const Eigen::Vector3d& point : solution.window.points_in_world) distances.push_back(point.norm());
  return pliant::DepthSignal(LogSpread(std::move(distances)), MedianSigma(solution));
}

// A window's frames and points, ready to be solved.
struct PreparedWindow {
  std::vector<std::size_t> views;  // frames of the input, ascending
  std::vector<PointId> ids;        // of the window's points, sorted
  DeformingWindow start;
};

Result<PreparedWindow> PrepareWindow(const InitInput& input, std::size_t frames, int views,
                                     const WindowInitOptions& options, double nominal_depth_mm) {
  if (frames < kMinFrames)
    return {ErrorCode::kInsufficient, "a window takes at least " + std::to_string(kMinFrames) + " frames"};
  PreparedWindow window;
  window.views = SpreadViews(frames, static_cast<std::size_t>(views));
  window.ids = ChoosePoints(input, window.views, options);
  if (window.ids.size() < kMinPoints)
    return {ErrorCode::kInsufficient,
            "only " + std::to_string(window.ids.size()) + " points were followed long enough"};
  auto start = Start(input, window.views, options, nominal_depth_mm, &window.ids);
  if (!start.ok()) return start.status();
  window.start = std::move(*start);
  return window;
}

Result<SolvedWindow> SolvedWithCue(const InitInput& input, const PreparedWindow& window,
                                   const WindowInitOptions& options) {
  auto solution = SolveDeformingWindow(window.start, input.camera.MeanFocalLengthPx(), options.window, input.threads);
  if (!solution.ok()) return solution.status();
  return SolvedWindow{window.views, window.ids, std::move(*solution)};
}

// Where the solution contradicts its cue, the depth prior is one, unless it is contradicted too; else there is none.
Result<SolvedWindow> SolveDeforming(const InitInput& input, std::size_t frames, const WindowInitOptions& options,
                                    double nominal_depth_mm) {
  const auto window = PrepareWindow(input, frames, options.views, options, nominal_depth_mm);
  if (!window.ok()) return window.status();
  auto first = SolvedWithCue(input, *window, options);
  if (!first.ok() || !ContradictsLight(first->solution)) return first;
  std::vector<WindowInitOptions> others;
  if (options.cue == DistanceCue::kLight && HasPrior(input, frames, options))
    others.push_back(WithCue(options, DistanceCue::kPrior));
  others.push_back(WithCue(options, DistanceCue::kNone));
  for (const WindowInitOptions& other : others) {
    const auto prepared = PrepareWindow(input, frames, options.views, other, nominal_depth_mm);
    if (!prepared.ok()) continue;
    auto solved = SolvedWithCue(input, *prepared, other);
    if (!solved.ok() || ContradictsLight(solved->solution)) continue;
    if (MedianSigma(solved->solution) > MedianSigma(first->solution)) continue;
    solved->light_is_of_no_use = options.cue == DistanceCue::kLight;
    return solved;
  }
  return first;
}

Result<SolvedWindow> SolvedAsRigid(const InitInput& input, const PreparedWindow& window,
                                   const WindowInitOptions& options) {
  auto solution = SolveRigidWindow(window.start, input.camera.MeanFocalLengthPx(), options.window, input.threads);
  if (!solution.ok()) return solution.status();
  return SolvedWindow{window.views, window.ids, std::move(*solution)};
}

Result<SolvedWindow> SolveRigid(const InitInput& input, const PreparedWindow& window,
                                const WindowInitOptions& options) {
  const auto deforms = [&](double correlation) {
    return Status(ErrorCode::kDegenerate,
                  "the scene deforms: the errors of neighbors under a rigid motion have a correlation of " +
                      Digits(correlation, 2));
  };
  const auto correlation = RigidResidualCorrelation(window.start, input.camera.MeanFocalLengthPx(), options.window);
  if (!correlation.ok()) return correlation.status();
  if (*correlation > options.max_correlation) return deforms(*correlation);
  auto rigid = SolvedAsRigid(input, window, options);
  if (rigid.ok() && rigid->solution.residual_correlation > options.max_correlation)
    return deforms(rigid->solution.residual_correlation);
  return rigid;
}

// (W19) The rigid window in place of the deforming one where it knows depths better, by what its halves say of it, or
// where its depths stand out and the other one's do not.
Result<SolvedWindow> MoreCertain(const InitInput& input, const PreparedWindow& wide, SolvedWindow deforming,
                                 const WindowInitOptions& options, double nominal_depth_mm) {
  auto rigid = SolvedAsRigid(input, wide, options);
  const double sigma = MedianSigma(deforming.solution);
  const bool stands_out = DepthSignal(deforming.solution) >= kMinProvisionalSignal;
  const auto knows_better = [&](const DeformingSolution& solution) {
    return MedianSigma(solution) < sigma || (!stands_out && DepthSignal(solution) >= kMinProvisionalSignal);
  };
  if (!rigid.ok() || !knows_better(rigid->solution)) return deforming;
  const std::vector<double> of_halves = SigmasOfHalves(input, *rigid, options, nominal_depth_mm);
  std::vector<double>& sigmas = rigid->solution.sample_sigmas;
  if (sigmas.empty()) sigmas.assign(of_halves.size(), 0.0);
  std::ranges::transform(sigmas, of_halves, sigmas.begin(), [](double a, double b) { return std::max(a, b); });
  if (!knows_better(rigid->solution)) return deforming;
  rigid->is_contradicted = !(MedianSigma(rigid->solution) < sigma);
  rigid->deforming = std::make_shared<const SolvedWindow>(std::move(deforming));
  return rigid;
}

}  // namespace

double MedianParallaxRad(const DeformingWindow& window, const Rigid3& cam_from_world) {
  const Eigen::Vector3d center = cam_from_world.OriginInSource();
  std::vector<double> angles;
  for (const Eigen::Vector3d& point : window.points_in_world) angles.push_back(AngleBetween(point, point - center));
  return Median(std::move(angles));
}

double MedianSigma(const DeformingSolution& solution) {
  std::vector<double> sigmas;
  for (std::size_t i = 0; i < solution.log_depth_sigmas.size(); ++i) sigmas.push_back(solution.LogDepthSigma(i));
  return Median(std::move(sigmas));
}

double LogSpread(std::vector<double> values) {
  if (std::ranges::any_of(values, [](double value) { return !(value > 0.0); }))
    return std::numeric_limits<double>::infinity();
  const double median = Median(values);
  for (double& value : values) value = std::abs(std::log(value / median));
  return Median(std::move(values));
}

bool ContradictsLight(const DeformingSolution& solution) {
  return solution.light_error > kMaxOfSpread * solution.log_distance_spread;
}

int IndexOf(PointId id, const std::vector<PointId>& ids) {
  const auto found = std::lower_bound(ids.begin(), ids.end(), id);
  return found != ids.end() && *found == id ? static_cast<int>(found - ids.begin()) : -1;
}

WindowInitOptions WithCue(WindowInitOptions options, DistanceCue cue) {
  options.cue = cue;
  return options;
}

std::vector<DeformingObservation> SeenIn(const InitInput& input, const InitFrame& frame,
                                         const std::vector<PointId>& ids, int view_idx,
                                         const WindowInitOptions& options) {
  const PhotometricCalibration light = input.photometric.value_or(PhotometricCalibration{.gamma = options.gamma});
  const bool has_light = options.cue == DistanceCue::kLight && options.light == Switch::kOn;
  std::vector<DeformingObservation> observations;
  for (const WindowObservation& seen : ObservationsOf(input.camera, frame, ids, view_idx)) {
    const InitObservation& observation = *FindById(frame.observations, ids[static_cast<std::size_t>(seen.point_idx)]);
    double log_cue = std::numeric_limits<double>::quiet_NaN();
    if (has_light) log_cue = LogDistanceFromLight(light, observation.brightness, seen.ray);
    if (options.cue == DistanceCue::kPrior) log_cue = observation.log_prior;
    observations.push_back({view_idx, seen.point_idx, seen.ray, log_cue});
  }
  return observations;
}

DeformingWindow InAllFrames(const InitInput& input, const std::vector<std::size_t>& views,
                            const DeformingWindow& solved, const std::vector<PointId>& ids,
                            const WindowInitOptions& options) {
  DeformingWindow all;
  all.points_in_world = solved.points_in_world;
  all.shapes = solved.shapes;
  all.camera = solved.camera;
  all.cue = solved.cue;
  all.coefficients.resize(solved.coefficients.rows(), static_cast<Eigen::Index>(input.frames.size()));
  std::size_t next = 0;  // the first solved view that is not before the frame
  for (std::size_t k = 0; k < input.frames.size(); ++k) {
    while (views[next] < k && next + 1 < views.size()) ++next;
    const std::size_t before = views[next] <= k ? next : next - 1;
    const double share =
        before == next ? 0.0
                       : static_cast<double>(k - views[before]) / static_cast<double>(views[next] - views[before]);
    all.times.push_back(input.frames[k].frame_idx - input.frames.front().frame_idx);
    all.cams_from_world.push_back(Interpolated(solved.cams_from_world[before], solved.cams_from_world[next], share));
    all.coefficients.col(static_cast<Eigen::Index>(k)) =
        (1.0 - share) * solved.coefficients.col(static_cast<Eigen::Index>(before)) +
        share * solved.coefficients.col(static_cast<Eigen::Index>(next));
    const auto seen = SeenIn(input, input.frames[k], ids, static_cast<int>(k), WithCue(options, solved.cue));
    all.observations.insert(all.observations.end(), seen.begin(), seen.end());
  }
  return all;
}

Result<SolvedWindow> SolveAsRigid(const InitInput& input, std::size_t frames, const WindowInitOptions& options,
                                  double nominal_depth_mm) {
  const auto window = PrepareWindow(input, frames, options.rigid_views, options, nominal_depth_mm);
  if (!window.ok()) return window.status();
  return SolvedAsRigid(input, *window, options);
}

Result<SolvedWindow> SolveWindow(const InitInput& input, std::size_t frames, WindowScene scene,
                                 const WindowInitOptions& options, double nominal_depth_mm) {
  const bool prior_alone = options.light == Switch::kOff && HasPrior(input, frames, options);
  const WindowInitOptions cued = prior_alone ? WithCue(options, DistanceCue::kPrior) : options;
  if (scene == WindowScene::kDeforming) return SolveDeforming(input, frames, cued, nominal_depth_mm);
  const auto wide = PrepareWindow(input, frames, cued.rigid_views, cued, nominal_depth_mm);
  if (!wide.ok()) return wide.status();
  auto rigid = SolveRigid(input, *wide, cued);
  if (rigid.ok() || scene == WindowScene::kRigid) return rigid;
  auto deforming = SolveDeforming(input, frames, cued, nominal_depth_mm);
  if (!deforming.ok()) return deforming;
  return MoreCertain(input, *wide, *std::move(deforming), cued, nominal_depth_mm);
}

}  // namespace pliant
