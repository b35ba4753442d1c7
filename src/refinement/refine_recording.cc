// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/refinement/refine_recording.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "pliant/base/statistics.h"
#include "refinement/bundle.h"
#include "refinement/check_recording.h"
#include "refinement/key_views.h"
#include "refinement/residual_correlation.h"

namespace pliant {
namespace {

constexpr int kRounds = 2;  // solutions of few views, each with the sigmas and the tracks that the one before has found
constexpr int kFewViewsPerTrack = 15;      // of the median track, in these; with all of them follows one more solution
constexpr double kUsualIterations = 10.0;  // of a solution
constexpr double kMinShapeSigma = 0.002;   // below it a scene moves by less than its noise
constexpr double kMinWrongTrackPx = 0.5;
constexpr int kRankStep = 2;
constexpr double kSignificant = 2.0;  // times its standard error: then a correlation asks for more shapes

// Of a solution for every so many views, up to a factor: the square of the numbers of a point in each of them.
double WorkOf(int rank, int stride) { return (1.0 + rank) * (1.0 + rank) / stride; }

class Refinement {
 public:
  Refinement(const Camera& camera, const Recording& start, const RefineOptions& options,
             const RefinementCallback& callback)
      : start_(start), options_(options), callback_(callback), input_{.camera = camera, .recording = start} {
    UseAll();
    stride_ = StrideOfKeyViews(start_, input_.used, options.views_per_track);
    wide_stride_ = std::max(stride_, StrideOfKeyViews(start_, input_.used, kFewViewsPerTrack));
    input_.distance = MedianDistance(start);
  }

  Result<RefinedRecording> Run() {
    BundleState state;
    state.cams_from_world = start_.cams_from_world;
    state.rest_positions = start_.rest_positions;
    bool rigid = options_.model == RefinementModel::kRigid;
    work_ = WorkOfAll(rigid ? 0 : options_.rank);
    if (options_.model == RefinementModel::kAuto) {
      work_ += WorkOf(0, wide_stride_);
      if (Status status = SolveForFewViews("rigid", 1, &state); !status.ok()) return status;
      if (stopped_) return Interrupted();
      refined_.residual_correlation = CorrelationOf(state, wide_stride_).value;
      rigid = refined_.residual_correlation <= options_.max_correlation;
      if (rigid) work_ = WorkOf(0, wide_stride_) + WorkOfAll(0);
    }
    if (Status status = rigid ? Solve("rigid", &state) : SolveDeforming(&state); !status.ok()) return status;
    if (!is_whole_) return Interrupted();
    refined_.deforming = !rigid;
    refined_.is_inlier = input_.used;
    const double scale = ScaleToStart(state);
    if (callback_ && !stopped_) callback_({"uncertainty", refined_.final_cost, 1.0});
    refined_.recording = InUnitOfStart(state, scale);
    AddCovariance(state, scale);
    refined_.stopped = stopped_;
    return refined_;
  }

 private:
  // A solution of few views, or one on its way, may be further from the truth than the start is.
  static Status Interrupted() {
    return {ErrorCode::kInterrupted,
            "it was stopped before all frames were solved for once, and what there is until "
            "then is not better than the run"};
  }

  // With more and more shapes, until neighbors' residuals are not alike any more. One that was stopped, or failed,
  // leaves the one before.
  Status SolveDeforming(BundleState* state) {
    for (int rank = options_.rank;; rank += kRankStep) {
      const BundleState state_before = *state;
      const RefinedRecording refined_before = refined_;
      const BundleInput input_before = input_;
      UseAll();
      *state = DeformingStart(start_, rank, options_.nodes_in_view);
      input_.graph = MakeGraph(*state, options_.neighbors);
      Status status = Solve("deforming", state);
      const bool is_first = rank == options_.rank;
      if (!status.ok() && is_first) return status;
      if (!is_first && (stopped_ || !status.ok())) {
        *state = state_before;
        refined_ = refined_before;
        input_.used = input_before.used;
        input_.graph = input_before.graph;
        input_.sigmas = input_before.sigmas;
      }
      if (stopped_ || !status.ok() || rank + kRankStep > options_.max_rank) return Status::Ok();
      const NeighborCorrelation left = CorrelationOf(*state, stride_);
      if (left.value <= kSignificant * left.standard_error) return Status::Ok();
      work_ += WorkOfAll(rank + kRankStep);
    }
  }

  double WorkOfAll(int rank) const { return kRounds * WorkOf(rank, wide_stride_) + WorkOf(rank, stride_); }

  // Of neighbors' residuals (W11), in the views that were solved for.
  NeighborCorrelation CorrelationOf(const BundleState& state, int stride) const {
    return ResidualCorrelation(start_, UsedInKeyViews(start_, input_.used, stride),
                               ReprojectionErrors(input_.camera, start_, state), start_.patch_px);
  }

  void UseAll() {
    input_.used.assign(start_.observations.size(), true);
    KeepDetermined(start_, &input_.used);
  }

  // Several solutions for few views, the first with the sigmas of the start, the others with those that the one before
  // has found.
  Status SolveForFewViews(std::string_view stage, int rounds, BundleState* state) {
    input_.sigmas = {};
    input_.sigmas.noise_px = kStartNoisePx;
    input_.sigmas.log_distance = start_.log_depth_sigma;
    for (int round = 0; round < rounds && !stopped_; ++round) {
      if (Status status = SolveKeyViews(stage, wide_stride_, state); !status.ok()) return status;
      if (round == 0) RejectWrongTracks(*state, UsedInKeyViews(start_, input_.used, wide_stride_));
    }
    return Status::Ok();
  }

  // For few views, for as many as were asked for, for all.
  Status Solve(std::string_view stage, BundleState* state) {
    if (Status status = SolveForFewViews(stage, kRounds, state); !status.ok()) return status;
    if (Status status = FollowKeyViews(wide_stride_, state); !status.ok() || stopped_) return status;
    RejectWrongTracks(*state, input_.used);  // also those that few views did not see
    SetFoundSigmas(*state, input_.used);     // few views leave residuals that are too small: more of them adapts
    if (Status status = SolveKeyViews(stage, stride_, state); !status.ok() || stopped_) return status;
    is_whole_ = true;
    return FollowKeyViews(stride_, state);
  }

  Status CheckUsed() const {
    const std::vector<int> counts = CountViews(start_, input_.used);
    const auto points = std::ranges::count_if(counts, [](int count) { return count > 0; });
    if (points >= kMinRefinedPoints) return Status::Ok();
    return {ErrorCode::kInsufficient, std::to_string(points) +
                                          " points are seen in three frames or more and agree with the others; a "
                                          "refinement needs " +
                                          std::to_string(kMinRefinedPoints)};
  }

  Status SolveKeyViews(std::string_view stage, int stride, BundleState* state) {
    if (Status status = CheckUsed(); !status.ok()) return status;
    int iterations = 0;
    const auto on_iteration = [&](double cost) {
      const double of_solution = iterations / (iterations + kUsualIterations);
      const double share = (work_done_ + WorkOf(state->rank(), stride) * of_solution) / work_;
      ++iterations;
      stopped_ = stopped_ || (callback_ && !callback_({stage, cost, share}));
      return !stopped_;
    };
    BundleInput input = input_;
    input.used = UsedInKeyViews(start_, input_.used, stride);
    const auto summary = SolveBundle(input, options_.max_iterations, on_iteration, state);
    if (!summary.ok()) return summary.status();
    refined_.initial_cost = summary->initial_cost;
    refined_.final_cost = summary->final_cost;
    work_done_ += WorkOf(state->rank(), stride);
    SetFoundSigmas(*state, input.used);
    return Status::Ok();
  }

  // All views by the points of the key views, all points by the views, and the views once more: many small problems,
  // which no stop interrupts, since they bring all into one world. Views without points go along with the others.
  Status FollowKeyViews(int stride, BundleState* state) const {
    InterpolateViews(start_, UsedInKeyViews(start_, input_.used, stride), state);
    if (stride == 1) return Status::Ok();
    BundleInput input = input_;
    for (const BundlePart part : {BundlePart::kViews, BundlePart::kPoints, BundlePart::kViews}) {
      input.part = part;
      const auto of_part = SolveBundle(input, options_.max_iterations, {}, state);
      if (!of_part.ok()) return of_part.status();
    }
    return Status::Ok();
  }

  void SetFoundSigmas(const BundleState& state, const std::vector<bool>& used) {
    const auto errors_px = ReprojectionErrors(input_.camera, start_, state);
    input_.sigmas.noise_px = NoisePx(errors_px, used);
    refined_.noise_px = input_.sigmas.noise_px;
    if (auto errors = MeasuredDistanceErrors(start_, used, state, input_.distance); !errors.empty())
      input_.sigmas.measured_log_distance = MeasuredSigma(std::move(errors));
    if (state.rank() == 0) return;
    const ShapeSizes sizes = SizesOf(state.nodes);
    input_.sigmas.size = std::max(kMinShapeSigma, sizes.size / input_.distance);
    input_.sigmas.gradient = std::max(kMinShapeSigma, sizes.gradient);
  }

  // Tracks whose error, in those observations, is far above that of the others.
  void RejectWrongTracks(const BundleState& state, const std::vector<bool>& used) {
    const auto errors_px = ReprojectionErrors(input_.camera, start_, state);
    const std::vector<double> squares = MeanSquareErrors(start_, used, errors_px);
    const std::vector<int> counts = CountViews(start_, used);
    std::vector<double> rms;
    for (std::size_t i = 0; i < squares.size(); ++i)
      if (counts[i] > 0) rms.push_back(std::sqrt(squares[i]));
    if (rms.empty()) return;
    const double bound = std::max(kWrongTrack * Median(rms), kMinWrongTrackPx);
    for (std::size_t o = 0; o < errors_px.size(); ++o) {
      const auto point = static_cast<std::size_t>(start_.observations[o].point_idx);
      if (std::sqrt(squares[point]) > bound) input_.used[o] = false;
    }
    KeepDetermined(start_, &input_.used);
  }

  // Where the terms do not determine their variables, nothing is known.
  void AddCovariance(const BundleState& state, double scale) {
    refined_.sigmas.assign(input_.used.size(), 0.0);
    BundleInput input = input_;
    input.used = UsedInKeyViews(start_, input_.used, stride_);
    const auto covariance = CovarianceOfBundle(input, state);
    if (!covariance.ok()) return;
    for (std::size_t o = 0; o < input_.used.size(); ++o) {
      const RecordedObservation& observation = refined_.recording.observations[o];
      const auto view = static_cast<std::size_t>(observation.view_idx);
      const double distance = (refined_.recording.cams_from_world[view] * observation.position).norm();
      // A point that too few key views see is known at least as well as at the start.
      const double sigma =
          covariance->log_distance_sigmas[o] > 0.0 ? covariance->log_distance_sigmas[o] : start_.log_depth_sigma;
      if (input_.used[o]) refined_.sigmas[o] = sigma * distance;
    }
    for (PoseCovariance pose : covariance->poses) {
      pose.topRows<3>() *= scale;
      pose.leftCols<3>() *= scale;
      refined_.pose_covariances.push_back(pose);
    }
  }

  double DistanceRatio(const BundleState& state, const RecordedObservation& o) const {
    const auto view = static_cast<std::size_t>(o.view_idx);
    return (start_.cams_from_world[view] * o.position).norm() /
           (state.cams_from_world[view] * state.Position(o.point_idx, o.view_idx)).norm();
  }

  // Where distances were measured the solution has their unit.
  double ScaleToStart(const BundleState& state) const {
    if (start_.measured_view_idx >= 0) return 1.0;
    std::vector<double> ratios;
    for (std::size_t o = 0; o < input_.used.size(); ++o)
      if (input_.used[o]) ratios.push_back(DistanceRatio(state, start_.observations[o]));
    return ratios.empty() ? 1.0 : Median(ratios);
  }

  // The solution in the start's unit: distances are the start's in the median. A point that had no part in it keeps
  // its place before the camera.
  Recording InUnitOfStart(const BundleState& state, double scale) const {
    Recording result = start_;
    const Eigen::Vector3d origin = state.cams_from_world.front().OriginInSource();
    const auto scaled = [&](const Eigen::Vector3d& x) { return Eigen::Vector3d(origin + scale * (x - origin)); };
    for (std::size_t v = 0; v < result.cams_from_world.size(); ++v) {
      const Rigid3& pose = state.cams_from_world[v];
      result.cams_from_world[v] = {pose.rotation, pose.rotation * -scaled(pose.OriginInSource())};
    }
    for (std::size_t i = 0; i < result.rest_positions.size(); ++i)
      result.rest_positions[i] = scaled(state.rest_positions[i]);
    for (std::size_t o = 0; o < input_.used.size(); ++o) {
      RecordedObservation& observation = result.observations[o];
      const auto view = static_cast<std::size_t>(observation.view_idx);
      observation.position = input_.used[o] ? scaled(state.Position(observation.point_idx, observation.view_idx))
                                            : result.cams_from_world[view].Inverse() *
                                                  (start_.cams_from_world[view] * observation.position);
    }
    return result;
  }

  const Recording& start_;
  const RefineOptions& options_;
  const RefinementCallback& callback_;
  BundleInput input_;
  int stride_ = 1;       // of the key views
  int wide_stride_ = 1;  // of the few views that are solved for first
  RefinedRecording refined_;
  double work_ = 0.0;  // of all solutions that are known to be needed
  double work_done_ = 0.0;
  bool stopped_ = false;
  bool is_whole_ = false;  // one model was solved for to its end
};

}  // namespace

void RefineOptions::List(OptionTable& table) {
  table.BeginGroup("Refine", "refinement of a whole recording");
  table.AddChoice("model", &model, "auto: rigid where that explains all but noise, else deforming");
  table.Add("max_correlation", &max_correlation, "1",
            "auto: correlation of neighbors' residuals in the rigid solution, up to which the scene is rigid", -1.0,
            1.0);
  table.Add("max_iterations", &max_iterations, "", "of one solution", 1, 1000);
  table.Add("rank", &rank, "", "basis shapes of the deformation, at first", 1, 10);
  table.Add("max_rank", &max_rank, "",
            "at most; two more are tried as long as neighbors' residuals are alike, no more where it is below rank", 1,
            20);
  table.Add("nodes_in_view", &nodes_in_view, "", "nodes of the surface, in the mean over the frames", 4, 1000);
  table.Add("views_per_track", &views_per_track, "",
            "of the median track, that are solved for together; more frames than these are solved for after it", 3,
            100000);
  table.AddChoice(
      "focal_length", &focal_length,
      "of the run's camera, with its distortion, from its largest rigid submap; auto: estimated where the camera was "
      "assumed");
  table.Add("neighbors", &neighbors, "", "nodes with which a node's basis shapes are compared", 1, 100);
}

Result<RefinedRecording> RefineRecording(const Camera& camera, const Recording& start, const RefineOptions& options,
                                         const RefinementCallback& callback) {
  if (Status status = CheckRecording(start, options); !status.ok()) return status;
  return Refinement(camera, start, options, callback).Run();
}

}  // namespace pliant
