// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/bootstrapping/bootstrapper.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "tracking/depth_prior/prior_distances.h"
#include "tracking/image_fault.h"

namespace pliant {
namespace {

constexpr std::size_t kAskAlternativeEvery = 5;  // frames

// Of two provisional maps.
bool IsBetter(const InitOutcome& a, const InitOutcome& b) {
  return a.measured.DepthSignal() >= b.measured.DepthSignal();
}

}  // namespace

Bootstrapper::Bootstrapper(const Camera& camera, const TrackerOptions& options, int threads,
                           const std::optional<PhotometricCalibration>& photometric, TrackSource* tracks,
                           OraclePoses* oracle_poses, std::shared_ptr<const Initializer> initializer,
                           std::unique_ptr<Initializer> alternative)
    : camera_(camera),
      options_(options),
      threads_(threads),
      photometric_(photometric),
      tracks_(tracks),
      oracle_poses_(oracle_poses),
      initializer_(std::move(initializer)),
      alternative_(std::move(alternative)) {}

BootstrapStep Bootstrapper::Process(const PreparedFrame& frame, Submap* submap, StageTimes* times) {
  assert(submap->map.landmarks.empty());
  if (!HasReference()) return TakeReference(frame, submap, times);
  if (options_.track_blurred == Switch::kOn && submap->IsBlurred(frame, options_)) {
    // A dark or blurred frame is passed over: the points are searched again in the next one.
    ++submap->blurred_frames;
    return {.tracked = static_cast<int>(frames_.back().observations.size()),
            .note = WithFault("passed over: the image is blurred or dark", ImageFault(frame, submap->previous))};
  }
  submap->blurred_frames = 0;
  return FollowReference(frame, submap, times);
}

BootstrapStep Bootstrapper::TakeReference(const PreparedFrame& frame, Submap* submap, StageTimes* times) {
  Abandon();
  BootstrapStep step;
  {
    const StageTimer timer(times, Stage::kInitialize);
    InitFrame reference{frame.frame_idx, {}};
    const LocalBrightness brightness(frame.image, frame.mask.valid());
    if (initializer_->TakesKnownPoints())
      AddKnownPoints(frame, brightness, &reference);
    else
      AddCorners(frame, brightness, options_.corners.max_corners, &reference);
    step.tracked = static_cast<int>(reference.observations.size());
    frames_.push_back(std::move(reference));
  }
  const int needed =
      tracks_->abilities().adds_always ? std::min(kFewestPoints, options_.min_corners) : options_.min_corners;
  if (step.tracked < needed) {
    Abandon();
    step.events = {TrackingEvent::kTooFewCorners};
    step.note = WithFault("no reference yet: " + std::to_string(step.tracked) +
                              (initializer_->TakesKnownPoints() ? " points of the model" : " corners") +
                              ", of at least " + std::to_string(needed),
                          ImageFault(frame, submap->previous));
  } else {
    TryInitialize(frame, times, &step);
    if (HasReference()) {
      step.events.push_back(TrackingEvent::kReferenceFound);
      step.note = "reference with " + std::to_string(step.tracked) + " corners";
    }
  }
  submap->previous = frame;
  return step;
}

BootstrapStep Bootstrapper::FollowReference(const PreparedFrame& frame, Submap* submap, StageTimes* times) {
  BootstrapStep step;
  {
    const StageTimer timer(times, Stage::kPhotometric);
    frames_.push_back(FollowedFrame(frame, *submap, &step.losses));
    step.tracked = static_cast<int>(frames_.back().observations.size());
  }
  image_fault_ = ImageFault(frame, submap->previous);
  TryInitialize(frame, times, &step);
  if (!HasReference() && !step.map) {  // the reference is spent: this image becomes the next one
    BootstrapStep next = TakeReference(frame, submap, times);
    next.events.insert(next.events.begin(), TrackingEvent::kReferenceSpent);
    next.ambiguity = std::move(step.ambiguity);
    step.losses.Add(next.losses);
    next.losses = std::move(step.losses);
    next.note = step.note + "; " + next.note;
    step = std::move(next);
  }
  step.note = WithFault(step.note, image_fault_);
  submap->previous = frame;
  return step;
}

// Asks the initializer. Afterwards there is a map in the step, or it waits and the reference stays, or there is none.
void Bootstrapper::TryInitialize(const PreparedFrame& frame, StageTimes* times, BootstrapStep* step) {
  InitOutcome outcome = AskInitializer(frame.depth_mm, InitMoment::kMoreFollow, times);
  step->note = outcome.reason;
  if (outcome.decision != InitDecision::kMap && frames_.size() % kAskAlternativeEvery == 0)
    AskAlternative(InitMoment::kMoreFollow, times);
  switch (outcome.decision) {
    case InitDecision::kMap:
      FinishMapOrGoBack(std::move(outcome), step);
      break;
    case InitDecision::kProvisional:
      PutAside(std::move(outcome), frame);
      step->events.push_back(TrackingEvent::kMapAwaited);
      break;
    case InitDecision::kWait:
      step->events.push_back(TrackingEvent::kMapAwaited);
      break;
    case InitDecision::kNewReference:
      if (outcome.ambiguous) step->ambiguity = outcome.reason;
      if (provisional_)
        GoBack(step);
      else
        Abandon();
      break;
  }
}

// A map that is provisional itself does not replace a better one that was put aside.
void Bootstrapper::FinishMapOrGoBack(InitOutcome outcome, BootstrapStep* step) {
  if (outcome.provisional && provisional_ && IsBetter(provisional_->map.outcome, outcome))
    GoBack(step);
  else
    FinishMap(std::move(outcome), step);
}

// The one whose depths stand out most from their uncertainty is kept.
void Bootstrapper::PutAside(InitOutcome outcome, const PreparedFrame& frame) {
  if (provisional_ && IsBetter(provisional_->map.outcome, outcome)) return;
  provisional_ = Provisional{{frames_, std::move(outcome)}, frame};
}

// To the map that was put aside: its points are followed again from the frame it was made in.
void Bootstrapper::GoBack(BootstrapStep* step) {
  Provisional provisional = *std::exchange(provisional_, std::nullopt);
  const bool present = provisional.frame.frame_idx == frames_.back().frame_idx;
  Abandon();
  std::erase_if(provisional.map.frames.back().observations,
                [&](const InitObservation& seen) { return !tracks_->Resume(seen.id, seen.pixel, provisional.frame); });
  std::erase_if(provisional.map.outcome.frames.back().positions, [&](const InitPosition& point) {
    return FindById(provisional.map.frames.back().observations, point.id) == nullptr;
  });
  step->note = provisional.map.outcome.reason;
  frames_ = std::move(provisional.map.frames);
  FinishMap(std::move(provisional.map.outcome), step);
  if (!present) step->map_frame = std::move(provisional.frame);
}

BootstrapStep Bootstrapper::EndSequence(StageTimes* times) {
  BootstrapStep step;
  InitOutcome outcome = AskInitializer({}, InitMoment::kLastFrame, times);
  step.note = WithFault(outcome.reason, image_fault_);
  if (outcome.ambiguous && outcome.decision == InitDecision::kNewReference) step.ambiguity = outcome.reason;
  if (outcome.decision == InitDecision::kMap)
    FinishMapOrGoBack(std::move(outcome), &step);
  else if (provisional_)
    GoBack(&step);
  else
    AskAlternative(InitMoment::kLastFrame, times);
  return step;
}

void Bootstrapper::Abandon() {
  if (!frames_.empty())
    for (const InitObservation& seen : frames_.back().observations) tracks_->Remove(seen.id);
  frames_.clear();
  known_depths_.clear();
  provisional_.reset();
}

InitOutcome Bootstrapper::AskInitializer(const cv::Mat& depth_mm, InitMoment moment, StageTimes* times) {
  const StageTimer timer(times, Stage::kInitialize);
  const InitInput input{camera_, frames_, depth_mm, moment, threads_, known_depths_, photometric_};
  InitOutcome outcome = initializer_->Try(input);
  if (outcome.ambiguous) {  // what is less certain, or takes more for granted, is no answer then
    provisional_.reset();
    ForgetAlternative();
  }
  return outcome;
}

void Bootstrapper::AskAlternative(InitMoment moment, StageTimes* times) {
  if (alternative_ == nullptr || !would_start_.empty()) return;
  const StageTimer timer(times, Stage::kInitialize);
  const InitOutcome outcome = alternative_->Try({camera_, frames_, {}, moment, threads_, {}, photometric_});
  if (outcome.decision != InitDecision::kMap) return;
  would_start_ = "--Init.method " + std::string(alternative_->name()) + " would have made a map by frame " +
                 std::to_string(frames_.back().frame_idx) + ", which is right if the scene hardly deforms";
}

// There is a map, or it is known that it takes too much for granted.
void Bootstrapper::ForgetAlternative() {
  alternative_.reset();
  would_start_.clear();
}

void Bootstrapper::FinishMap(InitOutcome outcome, BootstrapStep* step) {
  for (const InitRejectedPoint& rejected : outcome.rejected)
    if (rejected.reason != InitRejection::kLostOnTheWay) step->losses.Add(InitRejectionName(rejected.reason), 1);
  provisional_.reset();
  ForgetAlternative();
  outcome.decision = InitDecision::kMap;
  oracle_poses_->TakeWorld({camera_, frames_, {}}, &outcome);
  step->map = FirstMap{std::exchange(frames_, {}), std::move(outcome)};
  step->events.push_back(TrackingEvent::kMapCreated);
}

// Constant velocity in the image: there is no map yet.
std::vector<PointPrediction> Bootstrapper::PredictPixels(int frame_idx) const {
  const std::vector<InitObservation>& last = frames_.back().observations;
  const std::vector<Eigen::Vector2d> from = PixelsOf(last);
  std::vector<Eigen::Vector2d> to = from;
  if (frames_.size() >= 2) {
    const InitFrame& earlier = frames_[frames_.size() - 2];
    const double steps =
        static_cast<double>(frame_idx - frames_.back().frame_idx) / (frames_.back().frame_idx - earlier.frame_idx);
    for (std::size_t k = 0; k < last.size(); ++k)
      if (const InitObservation* before = FindById(earlier.observations, last[k].id); before != nullptr)
        to[k] = (1 + steps) * last[k].pixel - steps * before->pixel;
  }
  const std::vector<Eigen::Matrix2d> affines = NeighborhoodAffines(from, to);
  std::vector<PointPrediction> predictions;
  for (std::size_t k = 0; k < last.size(); ++k) predictions.push_back({last[k].id, to[k], affines[k]});
  return predictions;
}

// Adds new points away from those that are there.
void Bootstrapper::AddCorners(const PreparedFrame& frame, const LocalBrightness& brightness, int max_corners,
                              InitFrame* points) {
  if (max_corners <= 0) return;
  const std::vector<Eigen::Vector2d> existing = PixelsOf(points->observations);
  CornerOptions corners = options_.corners;
  corners.max_corners = max_corners;
  const PriorDistances prior(frame, camera_, options_.depth_prior);
  for (const NewTrack& track : tracks_->AddNew(frame, existing, corners))
    points->observations.push_back({track.id, track.pixel, 1.0, brightness.At(track.pixel),
                                    ColorAt(frame.image, track.pixel), prior.LogAt(track.pixel)});
  std::ranges::sort(points->observations, {}, &InitObservation::id);
}

void Bootstrapper::AddKnownPoints(const PreparedFrame& frame, const LocalBrightness& brightness, InitFrame* points) {
  if (!frame.known_points) return;
  for (const PixelDepth& known : frame.known_points()) {
    if (static_cast<int>(points->observations.size()) == options_.corners.max_corners) break;
    const auto id = tracks_->Add(known.pixel, frame);
    if (!id) continue;
    points->observations.push_back(
        {*id, known.pixel, 1.0, brightness.At(known.pixel), ColorAt(frame.image, known.pixel)});
    known_depths_.push_back(known.depth);
  }
}

// The reference's points in this frame, and every Nth frame, or whenever the source has them, new ones where there are
// none.
InitFrame Bootstrapper::FollowedFrame(const PreparedFrame& frame, const Submap& submap, LossCounts* losses) {
  InitFrame followed{frame.frame_idx, {}};
  const LocalBrightness brightness(frame.image, frame.mask.valid());
  const PriorDistances prior(frame, camera_, options_.depth_prior);
  std::vector<PointId> kept;
  for (const PointTrack& track : tracks_->Track(submap.previous, frame, PredictPixels(frame.frame_idx))) {
    if (track.failure == PatchFailure::kNone) {
      followed.observations.push_back({track.id, track.pixel, track.ssim, brightness.At(track.pixel),
                                       ColorAt(frame.image, track.pixel), prior.LogAt(track.pixel)});
      kept.push_back(track.id);
    } else {
      tracks_->Remove(track.id);
      losses->Add(EnumName(track.failure), 1);
    }
  }
  tracks_->Keep(kept);
  const bool is_due =
      tracks_->abilities().adds_always || frames_.size() % static_cast<std::size_t>(options_.top_up_frames) == 0;
  if (initializer_->TakesLaterPoints() && is_due)
    AddCorners(frame, brightness, options_.corners.max_corners - static_cast<int>(kept.size()), &followed);
  return followed;
}

}  // namespace pliant
