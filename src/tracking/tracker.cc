// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/tracker.h"

#include <algorithm>
#include <iterator>
#include <string>

#include "pliant/base/random.h"
#include "pliant/image/serialize.h"
#include "pliant/scene/serialize.h"
#include "pliant/tracking/stage_times.h"
#include "tracking/bootstrapping/bootstrapper.h"
#include "tracking/bootstrapping/oracle_initializer.h"
#include "tracking/catch_up.h"
#include "tracking/frame/frame_tracker.h"
#include "tracking/frame_result.h"
#include "tracking/image_fault.h"
#include "tracking/map_upkeep/map_updater.h"
#include "tracking/relocalization/relocalizer.h"
#include "tracking/relocalization/submaps.h"
#include "tracking/tracks/make_track_source.h"

namespace pliant {
namespace {

constexpr std::size_t kFramesAtOnce = 3;  // that a map catches up with in the time of one

// Attempts beside tracking take about half of the time until they are answered, and ask for no more than the map: some
// of those that would be made are left out. The last one is not earlier than it would be.
void AttemptLessOften(int handover_frames, WindowInitOptions* window) {
  const int steps = std::max(1, (handover_frames / 2 + window->every - 1) / window->every);
  window->every *= steps;
  const int attempts = (window->last_frame - window->first_frame + window->every - 1) / window->every;
  window->last_frame = std::max(window->last_frame, window->first_frame + attempts * window->every);
  window->focal_length_check = Switch::kOff;
}

// What follows from other options. As published, the graph is wider after a start from metric depth.
TrackerOptions Completed(TrackerOptions options) {
  if (options.init.IsMetric()) options.graph.sigma_mm = options.sigma_metric_mm;
  options.init.window.prior = options.depth_prior.window;
  options.init.prior_kind = options.depth_prior.kind;
  options.init.window.window.patch_px = options.point_tracker.lucas_kanade.patch_size;
  if (options.handover_frames > 0) AttemptLessOften(options.handover_frames, &options.init.window);
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
std::shared_ptr<const Initializer> MakeAlternative(const TrackerOptions& options, std::uint64_t seed,
                                                   const TrackerInputs& inputs) {
  if (inputs.extensions.initializer || options.init.method != InitMethod::kWindow || options.oracle.Any())
    return nullptr;
  return MakeGatedInitializer(options.init.monocular, Random(seed).Child("alternative initializer"));
}

// A start from known depth needs one frame alone, and another program's is asked where it was given.
int HandoverOfFirstMap(const TrackerOptions& options, const TrackerInputs& inputs) {
  const bool at_once = options.init.TakesKnownDepth() || options.init.method == InitMethod::kDepthPrior ||
                       options.oracle.Any() || inputs.extensions.initializer != nullptr;
  return at_once ? 0 : options.handover_frames;
}

}  // namespace

Tracker::Tracker(const Camera& camera, const TrackerOptions& options, std::uint64_t seed, int threads,
                 const TrackerInputs& inputs)
    : options_(Completed(options)),
      oracle_poses_(std::make_unique<OraclePoses>(options.oracle, inputs.truth, NominalDepth(options.init))),
      tracks_(MakeTrackSource(options_, seed, threads, inputs)),
      bootstrapper_(std::make_unique<Bootstrapper>(camera, options_, threads, HandoverOfFirstMap(options_, inputs),
                                                   inputs.photometric, inputs.camera_origin, tracks_.get(),
                                                   oracle_poses_.get(), MakeFirstInitializer(options_, seed, inputs),
                                                   MakeAlternative(options_, seed, inputs))),
      frame_tracker_(std::make_unique<FrameTracker>(camera, options_, threads, tracks_.get(), oracle_poses_.get(),
                                                    inputs.extensions.cost)),
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

void Tracker::TakeMap(const PreparedFrame& frame, const FrameReport& report, const FirstMapEvidence& evidence) {
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
  submap.depths = {.sigma = evidence.depth_sigma, .signal = DepthSignal(evidence.depth_spread, evidence.depth_sigma)};
  submap.last_cam_from_world = *report.cam_from_world;
  submap.before_last_cam_from_world = *report.cam_from_world;
  submap.Remember(frame);
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
  last_gray_ = frame.gray;

  const std::optional<int> since = bootstrapper_->AwaitsMapSince();
  const auto first_held = since ? std::ranges::find(held_, *since, &FrameReport::frame_idx) : held_.end();
  std::vector<FrameReport> done(std::make_move_iterator(held_.begin()), std::make_move_iterator(first_held));
  held_.erase(held_.begin(), first_held);
  return done;
}

// While the current map is lost, or another one awaited, those that were left are searched. What there is of one that
// is awaited is dropped.
void Tracker::FindSubmapAgain(const PreparedFrame& frame) {
  if (state_ == TrackingState::kTracking || catch_up_) return;
  if (options_.relocalization.relocalize == Switch::kOff) return;
  if (frame.step % options_.relocalization.search_every != 0) return;
  const auto former = state_ == TrackingState::kLost ? Submaps::Former::kInactive : Submaps::Former::kDropped;
  if (!submaps_->FindAgain(frame, former, relocalizer_.get())) return;
  bootstrapper_->Abandon();
  Apply(TrackingEvent::kMapFoundAgain);
}

FrameResult Tracker::Bootstrap(const PreparedFrame& frame, StageTimes* times) {
  BootstrapStep step = bootstrapper_->Process(frame, &submaps_->current(), times);
  for (const TrackingEvent event : step.events) Apply(event);
  MarkAmbiguous(step.ambiguity, step.ambiguous_since_frame_idx, &held_);
  FrameResult result{.tracked = step.tracked, .losses = std::move(step.losses), .note = std::move(step.note)};
  if (step.has_to_catch_up) {
    BeginCatchUp(*std::move(step.map));
  } else if (step.map) {
    StartMap(*step.map);
    result.first_map = std::move(step.map);
    result.map_frame = std::move(step.map_frame);
  }
  if (!catch_up_) return result;
  const std::vector<InitFrame>& frames = bootstrapper_->followed();
  catch_up_->GoOn(frames, kFramesAtOnce, &held_, times, &result);
  if (catch_up_->reached() == frames.size() && frames.back().frame_idx == frame.frame_idx) {
    EndCatchUp(&result);
    if (state_ == TrackingState::kTracking) {
      relocalizer_->RememberPose(frame.step, &submaps_->current());
      relocalizer_->RememberView(frame, &submaps_->current());
    } else {
      relocalizer_->RememberLastView(&submaps_->current());
    }
  }
  return result;
}

void Tracker::BeginCatchUp(FirstMap first) {
  catch_up_ = std::make_unique<CatchUp>(std::move(first), submaps_->current(), bootstrapper_->followed().back(),
                                        options_, tracks_.get(), frame_tracker_.get(), map_updater_.get());
}

// The map has reached the present frame, and becomes the current one.
void Tracker::EndCatchUp(FrameResult* result) {
  Submap submap = catch_up_->TakeSubmap(bootstrapper_->followed().back());
  submap.previous = submaps_->current().previous;
  submaps_->current() = std::move(submap);
  submaps_->CountMap();
  result->first_map = catch_up_->TakeFirst();
  result->has_caught_up = true;
  result->note = catch_up_->failure().empty() ? result->first_map->outcome.reason : catch_up_->failure();
  Apply(TrackingEvent::kMapCreated);
  if (catch_up_->state() == TrackingState::kLost) Apply(TrackingEvent::kTooFewPoints);
  bootstrapper_->Release();
  catch_up_.reset();
}

// The frames after it are still to come: their reports are set aside, before those that were so already.
void Tracker::GoBackTo(const PreparedFrame& frame) {
  goes_back_to_ = frame.frame_idx;
  const auto after =
      std::ranges::find_if(held_, [&](const FrameReport& report) { return report.frame_idx > frame.frame_idx; });
  set_aside_.insert(set_aside_.begin(), std::make_move_iterator(after), std::make_move_iterator(held_.end()));
  held_.erase(after, held_.end());
  submaps_->current().blurred_frames = 0;
  submaps_->current().Remember(frame);
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
  AddSolved(solved, &result);
  relocalizer_->RememberPose(frame.step, &submap);
  if (solved.points.in_blur) {
    result.note = "the image is blurred";
    return result;
  }
  relocalizer_->RememberView(frame, &submap);
  result.update = map_updater_->Update(frame, &submap, times);  // (W13), (G1) to (G8)
  result.losses.Add(result.update.losses);
  result.note = WithFault(result.update.note, ImageFault(frame, submap.previous.gray));
  submap.Remember(frame);
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
  map_updater_->Forget();
  Apply(TrackingEvent::kTooFewPoints);
  const std::string fault = ImageFault(frame, last_gray_);
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
  const std::vector<RefinedPoint> moved = std::exchange(moved_rests_, {});
  report.refined_points.insert(report.refined_points.begin(), moved.begin(), moved.end());
  if (found) {
    report.merge = found->merge;
    report.note = WithFault(report.note, "map " + std::to_string(found->merge.submap) + " is now part of map " +
                                             std::to_string(found->merge.into) + ", which this image shows too");
  }
  held_.push_back(std::move(report));
  if (result.map_frame) GoBackTo(*result.map_frame);
  if (result.first_map) {
    CompleteHeld(*result.first_map);
    if (!result.map_frame && held_.back().cam_from_world)
      AddCoverage(frame, submaps_->current().candidates, &held_.back());
  }
  if (found) {
    submaps_->Apply(*found);
    map_updater_->Forget();
    for (const Landmark& lost : submaps_->current().lost_points.landmarks())
      moved_rests_.push_back({lost.id, lost.rest_position});
  }
}

// The reports of the frames that the first map was made of. Those since are complete, or were passed over.
void Tracker::CompleteHeld(const FirstMap& first) {
  const auto since = std::ranges::find_if(
      held_, [&](const FrameReport& report) { return report.frame_idx > first.frames.back().frame_idx; });
  std::vector<FrameReport> later(std::make_move_iterator(since), std::make_move_iterator(held_.end()));
  held_.erase(since, held_.end());
  held_ = bootstrapper_->Completed(first, std::move(held_));
  for (FrameReport& report : later) {
    if (report.state == TrackingState::kInitializing) report.state = TrackingState::kLost;
    held_.push_back(std::move(report));
  }
}

std::vector<FrameReport> Tracker::Finish() {
  std::vector<FrameReport> reports = std::exchange(held_, {});
  std::ranges::move(std::exchange(set_aside_, {}), std::back_inserter(reports));
  return reports;
}

void Tracker::EndSequence() {
  if (!bootstrapper_->AwaitsMapSince() || held_.empty()) return;
  StageTimes times;
  FrameResult result;
  if (!catch_up_) {
    BootstrapStep step = bootstrapper_->EndSequence(&times);
    for (const TrackingEvent event : step.events) Apply(event);
    AddLastAttempt(step, times, &held_.back());
    MarkAmbiguous(step.ambiguity, step.ambiguous_since_frame_idx, &held_);
    if (step.has_to_catch_up) {
      BeginCatchUp(*std::move(step.map));
    } else if (step.map) {
      StartMap(*step.map);
      if (step.map_frame) GoBackTo(*step.map_frame);
      CompleteHeld(*step.map);
    }
  }
  if (!catch_up_) return;
  const std::vector<InitFrame>& frames = bootstrapper_->followed();
  catch_up_->GoOn(frames, frames.size(), &held_, &times, &result);
  EndCatchUp(&result);
  CompleteHeld(*result.first_map);
}

bool Tracker::IsSerializable() const {
  return catch_up_ == nullptr && !options_.oracle.Any() && tracks_->IsSerializable();
}

void Tracker::Serialize(StateArchive& archive) {
  tracks_->Serialize(archive);
  archive(*bootstrapper_, *map_updater_, *submaps_, state_, held_, goes_back_to_, set_aside_, last_gray_, moved_rests_);
}

}  // namespace pliant
