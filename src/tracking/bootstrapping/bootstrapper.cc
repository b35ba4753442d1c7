// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/bootstrapping/bootstrapper.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <utility>

#include "tracking/depth_prior/prior_distances.h"
#include "tracking/image_fault.h"
#include "tracking/serialize.h"

namespace pliant {
namespace {

constexpr std::size_t kAskAlternativeEvery = 5;  // frames
constexpr int kMaxLate = 2;                      // by handover_frames: later ones are not asked for
// So many references of WindowInit.last_frame frames have the time to give a better map than a weak one.
constexpr int kWeakReferences = 3;

bool DecidesNothing(const InitOutcome& outcome) {
  return outcome.decision == InitDecision::kWait && !outcome.ambiguous && !outcome.camera_may_stand_still;
}

}  // namespace

Bootstrapper::Bootstrapper(const Camera& camera, const TrackerOptions& options, int threads, int handover_frames,
                           const std::optional<PhotometricCalibration>& photometric, CameraOrigin camera_origin,
                           TrackSource* tracks, OraclePoses* oracle_poses,
                           std::shared_ptr<const Initializer> initializer,
                           std::shared_ptr<const Initializer> alternative)
    : camera_(camera),
      options_(options),
      threads_(threads),
      handover_frames_(handover_frames),
      photometric_(photometric),
      camera_origin_(camera_origin),
      tracks_(tracks),
      oracle_poses_(oracle_poses),
      initializer_(std::move(initializer)),
      alternative_(std::move(alternative)) {}

BootstrapStep Bootstrapper::Process(const PreparedFrame& frame, Submap* submap, StageTimes* times) {
  assert(submap->map.landmarks.empty());
  waiting_.CountFrame();
  if (!HasReference()) {
    BootstrapStep step = TakeReference(frame, submap, times);
    const bool is_refused = std::ranges::find(step.events, TrackingEvent::kTooFewCorners) != step.events.end();
    if (is_refused && !step.map && given_up_.frames > 0) step.note = given_up_.reason + "; " + step.note;
    return step;
  }
  if (submap->IsBlurred(frame, options_, tracks_->abilities())) {
    // A dark or blurred frame is passed over: the points are searched again in the next one.
    ++submap->blurred_frames;
    return {.tracked = static_cast<int>(frames_.back().observations.size()),
            .note = WithFault("passed over: the image is blurred or dark", ImageFault(frame, submap->previous.gray))};
  }
  submap->blurred_frames = 0;
  return FollowReference(frame, submap, times);
}

BootstrapStep Bootstrapper::TakeReference(const PreparedFrame& frame, Submap* submap, StageTimes* times) {
  DropReference();
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
    step.events = {TrackingEvent::kTooFewCorners};
    step.note = WithFault((given_up_.frames == 0 ? "no reference yet: " : "no reference since then: ") +
                              NumberOfPoints(step.tracked) + ", of at least " + std::to_string(needed),
                          ImageFault(frame, submap->previous.gray));
    GiveUpReference(&step);
  } else {
    TryInitialize(frame, times, &step);
    if (HasReference()) {
      step.events.push_back(TrackingEvent::kReferenceFound);
      step.note = "reference with " + NumberOfPoints(step.tracked);
    }
  }
  submap->Remember(frame);
  return step;
}

// What a reference has, in words.
std::string Bootstrapper::NumberOfPoints(int count) const {
  if (initializer_->TakesKnownPoints()) return std::to_string(count) + " points of known depth";
  return std::to_string(count) + (tracks_->abilities().adds_always ? " tracks" : " corners");
}

BootstrapStep Bootstrapper::FollowReference(const PreparedFrame& frame, Submap* submap, StageTimes* times) {
  BootstrapStep step;
  {
    const StageTimer timer(times, Stage::kPhotometric);
    frames_.push_back(FollowedFrame(frame, *submap, &step.losses));
    step.tracked = static_cast<int>(frames_.back().observations.size());
  }
  image_fault_ = ImageFault(frame, submap->previous.gray);
  TryInitialize(frame, times, &step);
  if (!HasReference() && !step.map) {  // the reference is spent: this image becomes the next one
    BootstrapStep next = TakeReference(frame, submap, times);
    next.events.insert(next.events.begin(), TrackingEvent::kReferenceSpent);
    next.ambiguity = std::move(step.ambiguity);
    next.ambiguous_since_frame_idx = step.ambiguous_since_frame_idx;
    step.losses.Add(next.losses);
    next.losses = std::move(step.losses);
    next.note = step.note + "; " + next.note;
    step = std::move(next);
  }
  step.note = WithFault(step.note, image_fault_);
  submap->Remember(frame);
  return step;
}

// Asks the initializer, unless a map catches up. Afterwards there is a map in the step, or it waits and the reference
// stays, or there is none.
void Bootstrapper::TryInitialize(const PreparedFrame& frame, StageTimes* times, BootstrapStep* step) {
  if (has_map_) {
    step->note = "the first map catches up";
    step->events.push_back(TrackingEvent::kMapAwaited);
  } else if (auto answer = NextAnswer(frame, times)) {
    TakeAnswer(*std::move(answer), step);
  } else {
    step->note = last_reason_;
    step->events.push_back(TrackingEvent::kMapAwaited);
  }
}

// To this frame or to an earlier one; nothing: none was asked for that long ago.
std::optional<Bootstrapper::Answer> Bootstrapper::NextAnswer(const PreparedFrame& frame, StageTimes* times) {
  const StageTimer timer(times, Stage::kInitialize);
  if (handover_frames_ == 0) {
    const auto alternative = frames_.size() % kAskAlternativeEvery == 0 ? AlternativeToAsk() : nullptr;
    const bool knows_depth = frames_.size() == 1 && frame.known_depth_mm;
    return AskInitializers(frames_, knows_depth ? frame.known_depth_mm() : cv::Mat(), known_depths_, doubts_, frame,
                           InitMoment::kMoreFollow, alternative.get());
  }
  const auto step = static_cast<int>(frames_.size());
  const WorkPlace place = threads_ > 1 ? WorkPlace::kBeside : WorkPlace::kHere;
  if (answers_.size() < static_cast<std::size_t>(kMaxLate * handover_frames_))
    answers_.Ask(step + handover_frames_, place,
                 [this, frame, frames = frames_, known_depths = known_depths_, doubts = doubts_] {
                   return AskInitializers(frames, {}, known_depths, doubts, frame, InitMoment::kMoreFollow, nullptr);
                 });
  if (options_.handover_waits == Switch::kOn) return answers_.Take(step);
  auto answer = answers_.TakeIfThere(step);
  // Where they are late more than one may be there. What an attempt says that decides nothing, the next one says.
  while (answer && DecidesNothing(answer->outcome)) {
    auto next = answers_.TakeIfThere(step);
    if (!next) break;
    answer = std::move(next);
  }
  return answer;
}

// Beside tracking it reads only what does not change. `alternative`: null: it is not asked.
Bootstrapper::Answer Bootstrapper::AskInitializers(const std::vector<InitFrame>& frames,
                                                   const cv::Mat& reference_depth_mm,
                                                   const std::vector<double>& known_depths, const Doubts& doubts,
                                                   const PreparedFrame& last, InitMoment moment,
                                                   const Initializer* alternative) const {
  Answer answer{.frames = frames.size(), .last = last};
  answer.outcome = initializer_->Try({camera_, frames, reference_depth_mm, moment, threads_, known_depths, photometric_,
                                      doubts.camera_may_stand_still, doubts.was_ambiguous, camera_origin_});
  const bool is_settled = answer.outcome.decision == InitDecision::kMap || answer.outcome.ambiguous;
  if (alternative != nullptr && !is_settled)
    answer.alternative = alternative->Try({camera_, frames, {}, moment, threads_, {}, photometric_});
  return answer;
}

// Null where what it would answer is known.
std::shared_ptr<const Initializer> Bootstrapper::AlternativeToAsk() const {
  return would_start_.empty() ? alternative_ : nullptr;
}

void Bootstrapper::TakeAnswer(Answer answer, BootstrapStep* step) {
  // Of an attempt beside tracking, which did not know of the others' doubts (W18).
  const bool is_map =
      answer.outcome.decision == InitDecision::kMap || answer.outcome.decision == InitDecision::kProvisional;
  if (is_map && answer.outcome.moves_by_depth && doubts_.camera_may_stand_still) {
    answer.outcome.decision = InitDecision::kWait;
    answer.outcome.ambiguous = true;
    answer.outcome.reason =
        "camera and scene cannot be told apart: in another window the camera may as well stand still; move it further "
        "and not evenly";
  }
  const InitOutcome& outcome = answer.outcome;
  last_reason_ = outcome.reason;
  step->note = outcome.reason;
  TakeAlternative(answer);
  switch (outcome.decision) {
    case InitDecision::kMap:
      if (IsWeak(outcome)) {
        waiting_.Put(MapOf(std::move(answer)));
        GiveUpReference(step);
      } else {
        FinishMapOrGoBack(std::move(answer), step);
      }
      break;
    case InitDecision::kProvisional:
      waiting_.Put(MapOf(std::move(answer)));
      step->events.push_back(TrackingEvent::kMapAwaited);
      break;
    case InitDecision::kWait:
      step->events.push_back(TrackingEvent::kMapAwaited);
      break;
    case InitDecision::kNewReference:
      TellAmbiguity(outcome, step);
      if (frames_.size() >= given_up_.frames) given_up_ = {frames_.size(), outcome.reason};
      doubts_.was_ambiguous |= outcome.ambiguous;
      GiveUpReference(step);
      break;
  }
}

// Of a reference that is given up.
void Bootstrapper::TellAmbiguity(const InitOutcome& outcome, BootstrapStep* step) const {
  if (!outcome.ambiguous && !(outcome.camera_may_stand_still && waiting_.IsEmpty())) return;
  step->ambiguity = outcome.reason;
  step->ambiguous_since_frame_idx = frames_.front().frame_idx;
}

void Bootstrapper::TakeAlternative(const Answer& answer) {
  // What is less certain, or takes more for granted, is no answer then.
  if (answer.outcome.ambiguous) waiting_.Doubt(answer.outcome.camera_may_stand_still);
  if (answer.outcome.ambiguous || answer.outcome.camera_may_stand_still) ForgetAlternative();
  doubts_.camera_may_stand_still |= answer.outcome.camera_may_stand_still;
  if (!answer.alternative || answer.alternative->decision != InitDecision::kMap || AlternativeToAsk() == nullptr)
    return;
  would_start_ = "--Init.method " + std::string(alternative_->name()) + " would have made a map by frame " +
                 std::to_string(answer.last.frame_idx) +
                 ", right only if the camera moves and the scene hardly deforms";
}

// There is a map, or it is known that it takes too much for granted.
void Bootstrapper::ForgetAlternative() {
  alternative_.reset();
  would_start_.clear();
}

MadeMap Bootstrapper::MapOf(Answer answer) const {
  const auto end = frames_.begin() + static_cast<std::ptrdiff_t>(answer.frames);
  return {{{frames_.begin(), end}, std::move(answer.outcome)}, std::move(answer.last)};
}

// Whether most of its points are still there; where frames do not come again, as many as a map needs.
bool Bootstrapper::IsFollowed(const FirstMap& map) const {
  const std::vector<InitPosition>& points = map.outcome.frames.back().positions;
  const auto followed = std::ranges::count_if(
      points, [&](const InitPosition& point) { return FindById(frames_.back().observations, point.id) != nullptr; });
  return 2 * followed >= std::ssize(points) || (handover_frames_ > 0 && followed >= options_.init.window.min_points);
}

// A map that is provisional itself does not replace a better one that was put aside.
void Bootstrapper::FinishMapOrGoBack(Answer answer, BootstrapStep* step) {
  if (answer.outcome.provisional && waiting_.HasBetterThan(answer.outcome)) {
    waiting_.EndWait();
    GoBack(*waiting_.Take(), step);
    return;
  }
  MadeMap made = MapOf(std::move(answer));
  if (IsFollowed(made.map))
    FinishMap(std::move(made.map), step);
  else
    Retrack(std::move(made), step);
}

// To the best map that was put aside, if there is one. A weak one waits where the frames since then can be read again.
void Bootstrapper::GiveUpReference(BootstrapStep* step) {
  const int max_wait = handover_frames_ == 0 ? kWeakReferences * options_.init.window.last_frame : 0;
  if (auto made = waiting_.GiveUpReference(static_cast<int>(frames_.size()), max_wait))
    GoBack(*std::move(made), step);
  else
    DropReference();
}

// To a map that was put aside.
void Bootstrapper::GoBack(MadeMap made, BootstrapStep* step) {
  step->note = made.map.outcome.reason;
  if (handover_frames_ > 0 && IsFollowed(made.map))
    FinishMap(std::move(made.map), step);
  else
    Retrack(std::move(made), step);
}

std::optional<int> Bootstrapper::AwaitsMapSince() const {
  if (const auto since = waiting_.WeakSince()) return since;
  return HasReference() ? std::optional(frames_.front().frame_idx) : std::nullopt;
}

// The points of the map are followed again from the frame that it is of.
void Bootstrapper::Retrack(MadeMap made, BootstrapStep* step) {
  const bool present = !frames_.empty() && made.frame.frame_idx == frames_.back().frame_idx;
  Abandon();
  std::erase_if(made.map.frames.back().observations,
                [&](const InitObservation& seen) { return !tracks_->Resume(seen.id, seen.pixel, made.frame); });
  std::erase_if(made.map.outcome.frames.back().positions, [&](const InitPosition& point) {
    return FindById(made.map.frames.back().observations, point.id) == nullptr;
  });
  frames_ = made.map.frames;
  FinishMap(std::move(made.map), step);
  if (!present) step->map_frame = std::move(made.frame);
}

// Of the first frames since the reference, or of all. The bootstrapper begins anew.
void Bootstrapper::FinishMap(FirstMap map, BootstrapStep* step) {
  for (const InitRejectedPoint& rejected : map.outcome.rejected)
    if (rejected.reason != InitRejection::kLostOnTheWay) step->losses.Add(InitRejectionName(rejected.reason), 1);
  waiting_.DropAll();
  doubts_ = {};
  given_up_ = {};
  ForgetAlternative();
  map.outcome.decision = InitDecision::kMap;
  oracle_poses_->TakeWorld({camera_, map.frames, {}}, &map.outcome);
  has_map_ = step->has_to_catch_up = map.frames.size() < frames_.size();
  answers_.Drop();
  step->map = std::move(map);
  if (has_map_) return;
  frames_.clear();
  step->events.push_back(TrackingEvent::kMapCreated);
}

void Bootstrapper::Release() {
  frames_.clear();
  has_map_ = false;
}

BootstrapStep Bootstrapper::EndSequence(StageTimes* times) {
  BootstrapStep step;
  const StageTimer timer(times, Stage::kInitialize);
  while (auto answer = answers_.Take(std::numeric_limits<int>::max())) {
    TakeAnswer(*std::move(answer), &step);
    if (step.map || !HasReference()) return step;
  }
  if (!HasReference()) {
    waiting_.EndWait();
    if (auto made = waiting_.Take()) GoBack(*std::move(made), &step);
    return step;
  }
  PreparedFrame last;
  last.frame_idx = frames_.back().frame_idx;
  const auto alternative = waiting_.IsEmpty() ? AlternativeToAsk() : nullptr;
  Answer answer = AskInitializers(frames_, {}, known_depths_, doubts_, last, InitMoment::kLastFrame, alternative.get());
  // What a reference of the last few images lacks says less than why one that lasted longer was given up.
  const bool says_less = frames_.size() < given_up_.frames && !answer.outcome.ambiguous;
  step.note = WithFault(says_less ? given_up_.reason : answer.outcome.reason, image_fault_);
  TakeAlternative(answer);
  waiting_.EndWait();
  if (answer.outcome.decision == InitDecision::kNewReference) TellAmbiguity(answer.outcome, &step);
  if (answer.outcome.decision == InitDecision::kMap)
    FinishMapOrGoBack(std::move(answer), &step);
  else if (auto made = waiting_.Take())
    GoBack(*std::move(made), &step);
  return step;
}

void Bootstrapper::Abandon() {
  DropReference();
  waiting_.DropAll();
  given_up_ = {};
}

void Bootstrapper::DropReference() {
  if (!frames_.empty())
    for (const InitObservation& seen : frames_.back().observations) tracks_->Remove(seen.id);
  frames_.clear();
  known_depths_.clear();
  waiting_.DropReference();
  doubts_.camera_may_stand_still = false;
  has_map_ = false;
  last_reason_ = "the first map is attempted beside tracking";
  answers_.Drop();
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
  std::vector<std::pair<InitObservation, double>> added;
  for (const PixelDepth& known : frame.known_points()) {
    if (static_cast<int>(added.size()) == options_.corners.max_corners) break;
    const auto id = tracks_->Add(known.pixel, frame);
    if (!id) continue;
    added.push_back(
        {{*id, known.pixel, 1.0, brightness.At(known.pixel), ColorAt(frame.image, known.pixel)}, known.depth});
  }
  std::ranges::sort(added, {}, [](const auto& point) { return point.first.id; });
  for (const auto& [observation, depth] : added) {
    points->observations.push_back(observation);
    known_depths_.push_back(depth);
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
      // The source knows no more of what a map rejects that catches up.
      if (track.failure != PatchFailure::kUnknownPoint) losses->Add(EnumName(track.failure), 1);
    }
  }
  tracks_->Keep(kept);
  const bool is_due =
      tracks_->abilities().adds_always || frames_.size() % static_cast<std::size_t>(options_.top_up_frames) == 0;
  if (initializer_->TakesLaterPoints() && is_due)
    AddCorners(frame, brightness, options_.corners.max_corners - static_cast<int>(kept.size()), &followed);
  return followed;
}

void Bootstrapper::Serialize(StateArchive& archive) {
  bool asks_alternative = alternative_ != nullptr;
  archive(asks_alternative);
  if (!asks_alternative) alternative_.reset();
  archive(has_map_, frames_, known_depths_, image_fault_, waiting_, doubts_, would_start_, last_reason_, given_up_,
          answers_);
}
void Bootstrapper::GivenUp::Serialize(StateArchive& archive) { archive.Members<2>(*this); }
void Bootstrapper::Doubts::Serialize(StateArchive& archive) { archive.Members<2>(*this); }
void Bootstrapper::Answer::Serialize(StateArchive& archive) { archive.Members<4>(*this); }

}  // namespace pliant
