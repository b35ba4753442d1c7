// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/refinement/refine_recording.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "pliant/base/statistics.h"
#include "refinement/bundle.h"
#include "refinement/residual_correlation.h"

namespace pliant {
namespace {

constexpr std::size_t kMinPoints = 8;
constexpr int kRounds = 3;  // solutions, each with the sigmas and the tracks that the one before has found
constexpr double kStartNoisePx = 0.3;
constexpr double kMinNoisePx = 0.02;
constexpr double kRayleighMedian = 1.1774;  // median length of a 2D normal vector by its standard deviation
constexpr double kMinShapeSigma = 0.002;    // below it a scene moves by less than its noise
constexpr double kWrongTrack = 3.0;         // times the median track's error
constexpr double kMinWrongTrackPx = 0.5;
constexpr int kMinViews = 3;  // of a point that has a part in the solution

Status CheckRecording(const Recording& recording, const RefineOptions& options) {
  const std::size_t views = recording.times.size();
  if (views < 2 || recording.rest_positions.size() < kMinPoints)
    return {ErrorCode::kInsufficient, "a refinement needs 2 frames and " + std::to_string(kMinPoints) +
                                          " points, and there are " + std::to_string(views) + " and " +
                                          std::to_string(recording.rest_positions.size())};
  if (recording.cams_from_world.size() != views || options.rank < 1 || !(recording.log_depth_sigma > 0))
    return {ErrorCode::kInvalidArgument,
            "a recording needs a time and a pose for every view, a rank and a sigma above 0"};
  for (std::size_t v = 1; v < views; ++v)
    if (!(recording.times[v] > recording.times[v - 1]))
      return {ErrorCode::kInvalidArgument, "the times of a recording must ascend"};
  for (const RecordedObservation& o : recording.observations) {
    const bool known = o.view_idx >= 0 && static_cast<std::size_t>(o.view_idx) < views && o.point_idx >= 0 &&
                       static_cast<std::size_t>(o.point_idx) < recording.rest_positions.size();
    if (!known || !o.pixel.allFinite() || !o.position.allFinite())
      return {ErrorCode::kInvalidArgument, "an observation of a recording has an index or a number that is none"};
  }
  return Status::Ok();
}

class Refinement {
 public:
  Refinement(const Camera& camera, const Recording& start, const RefineOptions& options,
             const RefinementCallback& callback)
      : camera_(camera), start_(start), options_(options), callback_(callback) {
    UseAll();
    std::vector<double> distances;
    for (const RecordedObservation& o : start.observations)
      distances.push_back((start.cams_from_world[static_cast<std::size_t>(o.view_idx)] * o.position).norm());
    distance_ = Median(distances);
  }

  Result<RefinedRecording> Run() {
    BundleState state;
    state.cams_from_world = start_.cams_from_world;
    state.rest_positions = start_.rest_positions;
    bool rigid = options_.model == RefinementModel::kRigid;
    if (options_.model == RefinementModel::kAuto) {
      if (Status status = Solve("rigid", 1, &state); !status.ok()) return status;
      refined_.residual_correlation =
          ResidualCorrelation(start_, used_, ReprojectionErrors(camera_, start_, state), start_.patch_px);
      rigid = refined_.residual_correlation <= options_.max_correlation;
    }
    if (!rigid) {
      UseAll();
      state = DeformingStart(start_, options_);
      graph_ = MakeGraph(state, options_.neighbors);
    }
    if (Status status = Solve(rigid ? "rigid" : "deforming", kRounds, &state); !status.ok()) return status;
    refined_.deforming = !rigid;
    refined_.recording = InUnitOfStart(state);
    refined_.is_inlier = used_;
    refined_.stopped = stopped_;
    return refined_;
  }

 private:
  void UseAll() {
    used_.assign(start_.observations.size(), true);
    KeepPointsSeenOften();
  }

  void KeepPointsSeenOften() {
    std::vector<int> views(start_.rest_positions.size(), 0);
    for (std::size_t o = 0; o < used_.size(); ++o)
      if (used_[o]) ++views[static_cast<std::size_t>(start_.observations[o].point_idx)];
    for (std::size_t o = 0; o < used_.size(); ++o)
      if (views[static_cast<std::size_t>(start_.observations[o].point_idx)] < kMinViews) used_[o] = false;
  }

  // Several solutions, the first with the sigmas of the start.
  Status Solve(std::string_view stage, int rounds, BundleState* state) {
    BundleSigmas sigmas;
    sigmas.noise_px = kStartNoisePx;
    sigmas.log_distance = start_.log_depth_sigma;
    for (int round = 0; round < rounds && !stopped_; ++round) {
      const auto on_iteration = [&](double cost) {
        stopped_ = stopped_ || (callback_ && !callback_({stage, iterations_++, cost}));
        return !stopped_;
      };
      const auto summary =
          SolveBundle(camera_, start_, used_, graph_, sigmas, distance_, options_.max_iterations, on_iteration, state);
      if (!summary.ok()) return summary.status();
      refined_.initial_cost = summary->initial_cost;
      refined_.final_cost = summary->final_cost;
      const auto errors_px = ReprojectionErrors(camera_, start_, *state);
      sigmas = FoundSigmas(*state, errors_px, sigmas);
      refined_.noise_px = sigmas.noise_px;
      if (round == 0) RejectWrongTracks(errors_px);
    }
    return Status::Ok();
  }

  BundleSigmas FoundSigmas(const BundleState& state, const std::vector<Eigen::Vector2d>& errors_px,
                           const BundleSigmas& sigmas) const {
    BundleSigmas found = sigmas;
    std::vector<double> lengths;
    for (std::size_t o = 0; o < errors_px.size(); ++o)
      if (used_[o]) lengths.push_back(errors_px[o].norm());
    found.noise_px = std::max(kMinNoisePx, Median(lengths) / kRayleighMedian);
    if (state.rank() == 0) return found;
    const ShapeSizes sizes = SizesOf(state.nodes);
    found.size = std::max(kMinShapeSigma, sizes.size / distance_);
    found.gradient = std::max(kMinShapeSigma, sizes.gradient);
    return found;
  }

  // Tracks whose error is far above that of the others.
  void RejectWrongTracks(const std::vector<Eigen::Vector2d>& errors_px) {
    std::vector<double> squares(start_.rest_positions.size(), 0.0);
    std::vector<int> counts(squares.size(), 0);
    for (std::size_t o = 0; o < errors_px.size(); ++o) {
      const auto point = static_cast<std::size_t>(start_.observations[o].point_idx);
      squares[point] += errors_px[o].squaredNorm();
      ++counts[point];
    }
    std::vector<double> rms;
    for (std::size_t i = 0; i < squares.size(); ++i)
      if (counts[i] >= kMinViews) rms.push_back(std::sqrt(squares[i] / counts[i]));
    if (rms.empty()) return;
    const double bound = std::max(kWrongTrack * Median(rms), kMinWrongTrackPx);
    for (std::size_t o = 0; o < errors_px.size(); ++o) {
      const auto point = static_cast<std::size_t>(start_.observations[o].point_idx);
      used_[o] = std::sqrt(squares[point] / counts[point]) <= bound;
    }
    KeepPointsSeenOften();
  }

  double DistanceRatio(const BundleState& state, const RecordedObservation& o) const {
    const auto view = static_cast<std::size_t>(o.view_idx);
    return (start_.cams_from_world[view] * o.position).norm() /
           (state.cams_from_world[view] * state.Position(o.point_idx, o.view_idx)).norm();
  }

  // The solution in the start's unit: distances are the start's in the median. A point that had no part in it keeps
  // its place before the camera.
  Recording InUnitOfStart(const BundleState& state) const {
    Recording result = start_;
    std::vector<double> ratios;
    for (std::size_t o = 0; o < used_.size(); ++o)
      if (used_[o]) ratios.push_back(DistanceRatio(state, start_.observations[o]));
    const double scale = ratios.empty() ? 1.0 : Median(ratios);
    const Eigen::Vector3d origin = state.cams_from_world.front().OriginInSource();
    const auto scaled = [&](const Eigen::Vector3d& x) { return Eigen::Vector3d(origin + scale * (x - origin)); };
    for (std::size_t v = 0; v < result.cams_from_world.size(); ++v) {
      const Rigid3& pose = state.cams_from_world[v];
      result.cams_from_world[v] = {pose.rotation, pose.rotation * -scaled(pose.OriginInSource())};
    }
    for (std::size_t i = 0; i < result.rest_positions.size(); ++i)
      result.rest_positions[i] = scaled(state.rest_positions[i]);
    for (std::size_t o = 0; o < used_.size(); ++o) {
      RecordedObservation& observation = result.observations[o];
      const auto view = static_cast<std::size_t>(observation.view_idx);
      observation.position =
          used_[o] ? scaled(state.Position(observation.point_idx, observation.view_idx))
                   : result.cams_from_world[view].Inverse() * (start_.cams_from_world[view] * observation.position);
    }
    return result;
  }

  const Camera& camera_;
  const Recording& start_;
  const RefineOptions& options_;
  const RefinementCallback& callback_;
  std::vector<bool> used_;  // an observation each
  double distance_ = 1;     // median, of the points from the cameras
  BundleGraph graph_;
  RefinedRecording refined_;
  int iterations_ = 0;
  bool stopped_ = false;
};

}  // namespace

void RefineOptions::List(OptionTable& table) {
  table.BeginGroup("Refine", "refinement of a whole recording");
  table.AddChoice("model", &model, "auto: rigid where that explains all but noise, else deforming");
  table.Add("max_correlation", &max_correlation, "1",
            "auto: correlation of neighbors' residuals in the rigid solution, up to which the scene is rigid", -1.0,
            1.0);
  table.Add("max_iterations", &max_iterations, "", "of one solution", 1, 1000);
  table.Add("rank", &rank, "", "basis shapes of the deformation", 1, 10);
  table.Add("nodes_in_view", &nodes_in_view, "", "nodes of the surface, in the mean over the frames", 4, 1000);
  table.Add("neighbors", &neighbors, "", "nodes with which a node's basis shapes are compared", 1, 100);
}

Result<RefinedRecording> RefineRecording(const Camera& camera, const Recording& start, const RefineOptions& options,
                                         const RefinementCallback& callback) {
  if (Status status = CheckRecording(start, options); !status.ok()) return status;
  return Refinement(camera, start, options, callback).Run();
}

}  // namespace pliant
