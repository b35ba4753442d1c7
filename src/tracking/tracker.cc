// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/tracker.h"

#include <algorithm>
#include <iterator>
#include <string>

#include "pliant/base/random.h"
#include "pliant/base/statistics.h"
#include "pliant/image/coverage.h"
#include "pliant/tracking/stage_times.h"
#include "tracking/bootstrapping/bootstrapper.h"
#include "tracking/bootstrapping/oracle_initializer.h"
#include "tracking/frame/frame_tracker.h"
#include "tracking/image_fault.h"
#include "tracking/map_upkeep/map_updater.h"
#include "tracking/relocalization/relocalizer.h"
#include "tracking/relocalization/submaps.h"
#include "tracking/tracks/make_track_source.h"

namespace pliant {

// What one frame gave, for its report.
struct FrameResult {
  int tracked = 0;  // points followed into the frame, before any was rejected
  LossCounts losses = {};
  std::string note = {};
  std::vector<CostTerm> costs = NoFrameCosts();
  double median_reprojection_error_px = 0;
  MapUpdate update = {};
  std::optional<FirstMap> first_map = std::nullopt;
  std::optional<PreparedFrame> map_frame = std::nullopt;  // that made it, where it was an earlier one
};

namespace {

// What follows from other options. As published, the graph is wider after a start from metric depth.
TrackerOptions Completed(TrackerOptions options) {
  if (options.init.IsMetric()) options.graph.sigma_mm = options.sigma_metric_mm;
  options.init.window.prior = options.depth_prior.window;
  options.init.prior_kind = options.depth_prior.kind;
  options.init.window.window.patch_px = options.point_tracker.lucas_kanade.patch_size;
  return options;
}

std::optional<double> NominalDepth(const InitOptions& options) {
  return options.IsMetric() ? std::nullopt : std::optional(options.monocular.nominal_depth_mm);
}

std::shared_ptr<const Initializer> MakeFirstInitializer(const TrackerOptions& options, std::uint64_t seed,
                                                        const TrackerInputs& inputs) {
  if (inputs.extensions.initializer) return inputs.extensions.initializer;
  auto initializer = MakeInitializer(options.init, Random(seed).Child("initializer"));
  if (options.oracle.first_map == Switch::kOff) return initializer;
  return MakeOracleInitializer(inputs.truth, NominalDepth(options.init), options.min_points, std::move(initializer));
}

// A start that takes the scene as rigid needs less.
std::unique_ptr<Initializer> MakeAlternative(const TrackerOptions& options, std::uint64_t seed,
                                             const TrackerInputs& inputs) {
  if (inputs.extensions.initializer || options.init.method != InitMethod::kWindow || options.oracle.Any())
    return nullptr;
  return MakeGatedInitializer(options.init.monocular, Random(seed).Child("alternative initializer"));
}

double CoverageIn(const PreparedFrame& frame, const std::vector<PointObservation>& observations) {
  std::vector<Eigen::Vector2d> pixels;
  for (const PointObservation& seen : observations) pixels.push_back(seen.pixel);
  return CoverageOf(frame.mask.valid(), pixels);
}

// The report of a frame in this state, made of its result and of the submap as it is in the end.
FrameReport MakeReport(const PreparedFrame& frame, TrackingState state, const Submap& submap, const FrameResult& result,
                       const StageTimes& times) {
  FrameReport report;
  report.frame_idx = frame.frame_idx;
  report.name = frame.name;
  report.timestamp_s = frame.timestamp_s;
  report.state = state == TrackingState::kTracking && submap.provisional ? TrackingState::kProvisional : state;
  report.note = result.note;
  report.submap = submap.idx;
  report.tracked = result.tracked + static_cast<int>(result.update.new_points.size());
  report.losses = result.losses.by_reason();
  report.lost = result.losses.total();
  report.stage_ms = times.ByName();
  report.costs = result.costs;
  if (state != TrackingState::kTracking || result.first_map) return report;
  report.cam_from_world = submap.last_cam_from_world;
  report.observations = submap.Observations();
  report.optimized = static_cast<int>(report.observations.size());
  report.new_points = result.update.new_points;
  report.added = static_cast<int>(report.new_points.size());
  report.refined_points = result.update.refined_points;
  report.coverage = CoverageIn(frame, report.observations);
  report.median_reprojection_error_px =
      result.update.median_reprojection_error_px.value_or(result.median_reprojection_error_px);
  return report;
}

// The attempt after the last frame is reported with that frame.
void AddLastAttempt(const BootstrapStep& step, const StageTimes& times, FrameReport* report) {
  LossCounts losses;
  for (const auto& [reason, count] : report->losses) losses.Add(reason, count);
  losses.Add(step.losses);
  report->losses = losses.by_reason();
  report->lost = losses.total();
  report->note = step.note;
  const auto added = times.ByName();
  for (std::size_t k = 0; k < added.size(); ++k) report->stage_ms[k].second += added[k].second;
}

// Frames in which points were followed from a reference that came to nothing, since camera and scene could not be told
// apart; nothing where there is no `reason`.
void MarkAmbiguous(const std::string& reason, std::vector<FrameReport>* reports) {
  if (reason.empty()) return;
  for (FrameReport& report : *reports) {
    if (report.state != TrackingState::kInitializing) continue;
    report.state = TrackingState::kAmbiguous;
    report.note = reason;
  }
}

double MedianError(const FollowedPoints& points) {
  std::vector<double> errors;
  for (const FramePoint& point : points.solved) errors.push_back(point.reprojection_error_px);
  return Median(std::move(errors));
}

}  // namespace

Tracker::Tracker(const Camera& camera, const TrackerOptions& options, std::uint64_t seed, int threads,
                 const TrackerInputs& inputs)
    : options_(Completed(options)),
      oracle_poses_(std::make_unique<OraclePoses>(options.oracle, inputs.truth, NominalDepth(options.init))),
      tracks_(MakeTrackSource(options_, seed, threads, inputs)),
      bootstrapper_(std::make_unique<Bootstrapper>(camera, options_, threads, inputs.photometric, tracks_.get(),
                                                   oracle_poses_.get(), MakeFirstInitializer(options_, seed, inputs),
                                                   MakeAlternative(options_, seed, inputs))),
      frame_tracker_(std::make_unique<FrameTracker>(camera, options_, tracks_.get(), oracle_poses_.get())),
      relocalizer_(std::make_unique<Relocalizer>(camera, options_, tracks_->abilities(), frame_tracker_.get())),
      map_updater_(std::make_unique<MapUpdater>(camera, options_, threads, inputs.photometric, tracks_.get())),
      submaps_(std::make_unique<Submaps>(camera, options_, tracks_.get())) {}

Tracker::~Tracker() = default;

const Map& Tracker::map() const { return submaps_->current().map; }

bool Tracker::HasInactiveSubmaps() const { return submaps_->HasInactive(); }

const std::string& Tracker::WouldStart() const { return bootstrapper_->WouldStart(); }

bool Tracker::NeedsDepth() const { return options_.init.TakesKnownDepth() && map().landmarks.empty(); }

bool Tracker::WantsDepth() const {
  return NeedsDepth() || (options_.init.TakesKnownDepth() && options_.submaps == Switch::kOn);
}

bool Tracker::LeavesMap() const { return submaps_->current().lost_frames >= options_.max_lost_frames; }

bool Tracker::GaveUp() const { return LeavesMap() && options_.submaps == Switch::kOff; }

void Tracker::TakeMap(const PreparedFrame& frame, const FrameReport& report) {
  Submap& submap = submaps_->current();
  for (const PointObservation& seen : report.observations) {
    if (!tracks_->Resume(seen.id, seen.pixel, frame)) continue;
    const auto point = std::ranges::find(report.new_points, seen.id, &NewPoint::id);
    Landmark landmark{.id = seen.id, .rest_position = seen.position, .position = seen.position, .pixel = seen.pixel};
    landmark.log_distance_sigma = seen.sigma / (*report.cam_from_world * seen.position).norm();
    landmark.determined_at = seen.position;
    if (point != report.new_points.end()) landmark.rest_position = point->position;
    submap.map.landmarks.push_back(landmark);
  }
  submap.idx = report.submap;
  submap.provisional = report.state == TrackingState::kProvisional;
  if (report.first_map) submap.depth_sigma = report.first_map->evidence.depth_sigma;
  submap.last_cam_from_world = *report.cam_from_world;
  submap.before_last_cam_from_world = *report.cam_from_world;
  submap.previous = frame;
  submaps_->CountMap();
  Apply(TrackingEvent::kMapCreated);
}

PointId Tracker::next_point_id() const { return tracks_->next_id(); }

void Tracker::SkipPointIds(PointId next) { tracks_->SkipIds(next); }

std::vector<FrameReport> Tracker::Process(const PreparedFrame& frame) {
  StageTimes times;
  times.Add(Stage::kPrepare, frame.prepare_ms);
  if (LeavesMap() && options_.submaps == Switch::kOn) {
    submaps_->LeaveCurrent();
    Apply(TrackingEvent::kMapLeft);
  }
  FindSubmapAgain(frame);
  const bool has_map = state_ == TrackingState::kTracking || state_ == TrackingState::kLost;
  FrameResult result = has_map ? TrackFrame(frame, &times) : Bootstrap(frame, &times);
  std::erase_if(set_aside_, [&](const FrameReport& report) { return report.frame_idx <= frame.frame_idx; });
  Report(frame, result, &times);

  const auto first_held = state_ == TrackingState::kInitializing
                              ? std::ranges::find(held_, bootstrapper_->reference_frame_idx(), &FrameReport::frame_idx)
                              : held_.end();
  std::vector<FrameReport> done(std::make_move_iterator(held_.begin()), std::make_move_iterator(first_held));
  held_.erase(held_.begin(), first_held);
  return done;
}

// While the current map is lost, or another one awaited, those that were left are searched. What there is of one that
// is awaited is dropped.
void Tracker::FindSubmapAgain(const PreparedFrame& frame) {
  if (state_ == TrackingState::kTracking || frame.frame_idx % options_.relocalization.search_every != 0) return;
  const auto former = state_ == TrackingState::kLost ? Submaps::Former::kInactive : Submaps::Former::kDropped;
  if (!submaps_->FindAgain(frame, former, relocalizer_.get())) return;
  bootstrapper_->Abandon();
  Apply(TrackingEvent::kMapFoundAgain);
}

FrameResult Tracker::Bootstrap(const PreparedFrame& frame, StageTimes* times) {
  BootstrapStep step = bootstrapper_->Process(frame, &submaps_->current(), times);
  for (const TrackingEvent event : step.events) Apply(event);
  MarkAmbiguous(step.ambiguity, &held_);
  if (step.map) StartMap(*step.map);
  return {.tracked = step.tracked,
          .losses = std::move(step.losses),
          .note = std::move(step.note),
          .first_map = std::move(step.map),
          .map_frame = std::move(step.map_frame)};
}

// The frames after it are still to come: their reports are set aside, before those that were so already.
void Tracker::GoBackTo(const PreparedFrame& frame) {
  goes_back_to_ = frame.frame_idx;
  const auto after =
      std::ranges::find_if(held_, [&](const FrameReport& report) { return report.frame_idx > frame.frame_idx; });
  set_aside_.insert(set_aside_.begin(), std::make_move_iterator(after), std::make_move_iterator(held_.end()));
  held_.erase(after, held_.end());
  submaps_->current().blurred_frames = 0;
  submaps_->current().previous = frame;
}

void Tracker::StartMap(const FirstMap& first) {
  submaps_->CountMap();
  map_updater_->Start(first, &submaps_->current());
}

// One frame, as in the paper; the names in brackets are those of docs/method.md.
FrameResult Tracker::TrackFrame(const PreparedFrame& frame, StageTimes* times) {
  Submap& submap = submaps_->current();
  FollowedPoints followed = Follow(frame, &submap, times);  // (E6), (P1); after a loss (R3)
  const SolvedFrame solved =
      frame_tracker_->Solve(frame, state_, std::move(followed), &submap, times);  // (E7), (R2), (D1), (A3), (E5)
  FrameResult result{.tracked = solved.tracked};
  if (!solved.failure.empty()) {
    result.note = Lose(frame, solved.failure, &submap);
    return result;
  }
  submap.Commit(solved.points, solved.solution.cam_from_world, state_, options_, tracks_.get());  // (R1)
  map_updater_->RemoveCommonMotion(&submap);                                                      // (E12)
  Apply(TrackingEvent::kFrameTracked);
  result.losses = solved.points.losses;
  result.costs = solved.solution.costs;
  result.median_reprojection_error_px = MedianError(solved.points);
  if (solved.points.in_blur) {
    result.note = "the image is blurred";
    return result;
  }
  relocalizer_->Remember(frame, &submap);
  result.update = map_updater_->Update(frame, &submap, times);  // (W13), (G1) to (G8)
  result.losses.Add(result.update.losses);
  result.note = WithFault(result.update.note, ImageFault(frame, submap.previous));
  submap.previous = frame;
  return result;
}

FollowedPoints Tracker::Follow(const PreparedFrame& frame, Submap* submap, StageTimes* times) {
  const StageTimer timer(times, Stage::kPhotometric);
  if (state_ == TrackingState::kTracking || frame_tracker_->KnownPose(frame.frame_idx, *submap))
    return frame_tracker_->Follow(frame, *submap);
  return relocalizer_->Relocalize(frame, submap);
}

// Nothing is given up: the map and the tracks stay as they were in the last good frame. Returns the frame's note.
std::string Tracker::Lose(const PreparedFrame& frame, const std::string& reason, Submap* submap) {
  if (state_ == TrackingState::kTracking) relocalizer_->RememberLastView(submap);
  Apply(TrackingEvent::kTooFewPoints);
  const std::string fault = ImageFault(frame, submap->previous);
  if (fault.empty()) ++submap->lost_frames;
  return WithFault(reason, fault);
}

// The frame's report joins those that are held. Submaps that meet in this frame become one after it was reported.
void Tracker::Report(const PreparedFrame& frame, const FrameResult& result, StageTimes* times) {
  const TrackingState state = result.map_frame ? TrackingState::kInitializing : state_;  // of this very frame
  std::optional<Submaps::FoundMerge> found;
  if (state == TrackingState::kTracking) {
    const StageTimer timer(times, Stage::kInitialize);
    found = submaps_->FindMerge(frame, relocalizer_.get());
  }
  FrameReport report = MakeReport(frame, state, submaps_->current(), result, *times);
  if (found) {
    report.merge = found->merge;
    report.note = WithFault(report.note, "map " + std::to_string(found->merge.submap) + " is now part of map " +
                                             std::to_string(found->merge.into) + ", which this image shows too");
  }
  held_.push_back(std::move(report));
  if (result.map_frame) GoBackTo(*result.map_frame);
  if (result.first_map) {
    held_ = bootstrapper_->Completed(*result.first_map, std::move(held_));
    if (!result.map_frame) held_.back().coverage = CoverageIn(frame, held_.back().observations);
  }
  if (found) submaps_->Apply(*found);
}

std::vector<FrameReport> Tracker::Finish() {
  std::vector<FrameReport> reports = std::exchange(held_, {});
  std::ranges::move(std::exchange(set_aside_, {}), std::back_inserter(reports));
  return reports;
}

void Tracker::EndSequence() {
  if (state_ != TrackingState::kInitializing || held_.empty()) return;
  StageTimes times;
  BootstrapStep step = bootstrapper_->EndSequence(&times);
  for (const TrackingEvent event : step.events) Apply(event);
  AddLastAttempt(step, times, &held_.back());
  MarkAmbiguous(step.ambiguity, &held_);
  if (!step.map) return;
  StartMap(*step.map);
  if (step.map_frame) GoBackTo(*step.map_frame);
  held_ = bootstrapper_->Completed(*step.map, std::move(held_));
}

}  // namespace pliant
