// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/bootstrapping/bootstrapper.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <utility>

#include "tracking/image_fault.h"
#include "tracking/serialize.h"

namespace pliant {
namespace {

constexpr std::size_t kAskAlternativeEvery = 5;  // frames
constexpr int kMaxLate = 2;                      // by handover_frames: later ones are not asked for
// So many references of WindowInit.last_frame frames have the time to give a better map than a weak one.
constexpr int kWeakReferences = 3;

// Another reference follows in this step on one that was given up.
void Join(BootstrapStep next, BootstrapStep* step) {
  next.events.insert(next.events.begin(), TrackingEvent::kReferenceSpent);
  if (!step->ambiguity.empty()) {
    next.ambiguity = std::move(step->ambiguity);
    next.ambiguous_since_frame_idx = step->ambiguous_since_frame_idx;
  }
  step->losses.Add(next.losses);
  next.losses = std::move(step->losses);
  next.note = step->note + "; " + next.note;
  *step = std::move(next);
}

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
      alternative_(std::move(alternative)),
      reference_tracks_(camera, options, tracks, initializer_.get()) {}

BootstrapStep Bootstrapper::Process(const PreparedFrame& frame, Submap* submap, StageTimes* times) {
  assert(submap->map.landmarks.empty());
  weak_.CountFrame();
  if (!HasReference()) {
    BootstrapStep step = TakeReference(frame, submap, times);
    const bool is_refused = std::ranges::find(step.events, TrackingEvent::kTooFewCorners) != step.events.end();
    if (is_refused && !step.map && given_up_.frames > 0) step.note = given_up_.reason + "; " + step.note;
    return step;
  }
  if (submap->IsBlurred(frame, options_, tracks_->abilities())) {
    // A dark or blurred frame is passed over: the points are searched again in the next one.
    ++submap->blurred_frames;
    return {.tracked = reference_.Points(),
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
    reference_ = reference_tracks_.Take(frame);
    step.tracked = reference_.Points();
  }
  const int needed =
      tracks_->abilities().adds_always ? std::min(kFewestPoints, options_.min_corners) : options_.min_corners;
  if (step.tracked < needed) {
    step.events = {TrackingEvent::kTooFewCorners};
    step.note = WithFault((given_up_.frames == 0 ? "no reference yet: " : "no reference since then: ") +
                              NumberOfPoints(step.tracked) + ", of at least " + std::to_string(needed),
                          ImageFault(frame, submap->previous.gray));
    GiveUpReference(&reference_, &step);
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
    reference_tracks_.Follow(submap->previous, frame, &reference_, &next_, &step.losses);
    step.tracked = reference_.Points();
  }
  image_fault_ = ImageFault(frame, submap->previous.gray);
  TryInitialize(frame, times, &step);
  if (next_.IsThere()) TryNextReference(frame, times, &step);
  if (!HasReference() && !step.map) Join(TakeReference(frame, submap, times), &step);
  if (HasReference() && !has_map_) BeginNextReference(frame, times);
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
    TakeAnswer(*std::move(answer), &reference_, step);
  } else {
    step->note = reference_.last_reason;
    step->events.push_back(TrackingEvent::kMapAwaited);
  }
}

// The next reference takes the present one's place if that was given up. Otherwise its map counts alone, which is taken
// if it is certain.
void Bootstrapper::TryNextReference(const PreparedFrame& frame, StageTimes* times, BootstrapStep* step) {
  if (!HasReference()) {
    MakePresent(&next_);
    BootstrapStep next{.events = {TrackingEvent::kReferenceFound}, .tracked = reference_.Points()};
    TryInitialize(frame, times, &next);
    Join(std::move(next), step);
    return;
  }
  BootstrapStep next{.tracked = next_.Points()};
  {
    const StageTimer timer(times, Stage::kInitialize);
    TakeAnswer(AskInitializers(next_.frames, QuestionOf(next_), frame), &next_, &next);
  }
  if (next.map) {
    next.losses.Add(step->losses);
    *step = std::move(next);
  } else if (step->ambiguity.empty()) {
    step->ambiguity = std::move(next.ambiguity);
    step->ambiguous_since_frame_idx = next.ambiguous_since_frame_idx;
  }
}

// Of the present reference, to this frame or to an earlier one; nothing: none was asked for that long ago.
std::optional<Bootstrapper::Answer> Bootstrapper::NextAnswer(const PreparedFrame& frame, StageTimes* times) {
  const StageTimer timer(times, Stage::kInitialize);
  if (handover_frames_ == 0) {
    Question question = QuestionOf(reference_);
    if (reference_.frames.size() % kAskAlternativeEvery == 0) question.alternative = AlternativeToAsk();
    if (reference_.frames.size() == 1 && frame.known_depth_mm) question.reference_depth_mm = frame.known_depth_mm();
    return AskInitializers(reference_.frames, question, frame);
  }
  const auto step = static_cast<int>(reference_.frames.size());
  const WorkPlace place = threads_ > 1 ? WorkPlace::kBeside : WorkPlace::kHere;
  if (answers_.size() < static_cast<std::size_t>(kMaxLate * handover_frames_))
    answers_.Ask(step + handover_frames_, place,
                 [this, frame, frames = reference_.frames, question = QuestionOf(reference_)] {
                   return AskInitializers(frames, question, frame);
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

Bootstrapper::Question Bootstrapper::QuestionOf(const Reference& reference) const {
  return {.known_depths = reference.known_depths,
          .camera_may_stand_still = reference.camera_may_stand_still,
          .was_ambiguous = was_ambiguous_};
}

// Beside tracking it reads only what does not change.
Bootstrapper::Answer Bootstrapper::AskInitializers(const std::vector<InitFrame>& frames, const Question& question,
                                                   const PreparedFrame& last) const {
  Answer answer{.frames = frames.size(), .last = last};
  answer.outcome =
      initializer_->Try({camera_, frames, question.reference_depth_mm, question.moment, threads_, question.known_depths,
                         photometric_, question.camera_may_stand_still, question.was_ambiguous, camera_origin_});
  const bool is_settled = answer.outcome.decision == InitDecision::kMap || answer.outcome.ambiguous;
  if (question.alternative != nullptr && !is_settled)
    answer.alternative = question.alternative->Try({camera_, frames, {}, question.moment, threads_, {}, photometric_});
  return answer;
}

// Null where what it would answer is known.
std::shared_ptr<const Initializer> Bootstrapper::AlternativeToAsk() const {
  return would_start_.empty() ? alternative_ : nullptr;
}

void Bootstrapper::TakeAnswer(Answer answer, Reference* reference, BootstrapStep* step) {
  // Of an attempt beside tracking, which did not know of the others' doubts (W18).
  const bool is_map =
      answer.outcome.decision == InitDecision::kMap || answer.outcome.decision == InitDecision::kProvisional;
  if (is_map && answer.outcome.moves_by_depth && reference->camera_may_stand_still) {
    answer.outcome.decision = InitDecision::kWait;
    answer.outcome.ambiguous = true;
    answer.outcome.reason =
        "camera and scene cannot be told apart: in another window the camera may as well stand still; move it further "
        "and not evenly";
  }
  const InitOutcome& outcome = answer.outcome;
  reference->last_reason = outcome.reason;
  step->note = outcome.reason;
  TakeAlternative(answer, reference);
  switch (outcome.decision) {
    case InitDecision::kMap:
      if (IsWeak(outcome)) {
        PutAside(MapOf(std::move(answer), *reference), &reference->provisional);
        GiveUpReference(reference, step);
      } else {
        MakePresent(reference);
        FinishMapOrGoBack(std::move(answer), step);
      }
      break;
    case InitDecision::kProvisional:
      PutAside(MapOf(std::move(answer), *reference), &reference->provisional);
      step->events.push_back(TrackingEvent::kMapAwaited);
      break;
    case InitDecision::kWait:
      step->events.push_back(TrackingEvent::kMapAwaited);
      break;
    case InitDecision::kNewReference:
      TellAmbiguity(outcome, *reference, step);
      if (reference->frames.size() >= given_up_.frames) given_up_ = {reference->frames.size(), outcome.reason};
      was_ambiguous_ |= outcome.ambiguous;
      if (outcome.ambiguous || outcome.camera_may_stand_still)
        DoubtRigidity(reference == &next_ ? &reference_.provisional : &next_.provisional);
      GiveUpReference(reference, step);
      break;
  }
}

// Of a reference that is given up.
void Bootstrapper::TellAmbiguity(const InitOutcome& outcome, const Reference& reference, BootstrapStep* step) const {
  const bool has_map = reference.provisional || weak_.IsThere();
  if (!outcome.ambiguous && !(outcome.camera_may_stand_still && !has_map)) return;
  step->ambiguity = outcome.reason;
  step->ambiguous_since_frame_idx = reference.frames.front().frame_idx;
}

void Bootstrapper::TakeAlternative(const Answer& answer, Reference* reference) {
  // What is less certain, or takes more for granted, is no answer then.
  if (answer.outcome.ambiguous) {
    // Of the other reference too: they have frames in common.
    for (Reference* doubted : {&reference_, &next_})
      Doubt(answer.outcome.camera_may_stand_still, &doubted->provisional);
    weak_.Doubt();
  }
  if (answer.outcome.ambiguous || answer.outcome.camera_may_stand_still) ForgetAlternative();
  reference->camera_may_stand_still |= answer.outcome.camera_may_stand_still;
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

MadeMap Bootstrapper::MapOf(Answer answer, const Reference& reference) {
  const auto end = reference.frames.begin() + static_cast<std::ptrdiff_t>(answer.frames);
  return {{{reference.frames.begin(), end}, std::move(answer.outcome)}, std::move(answer.last)};
}

// Whether most of its points are still there; where frames do not come again, as many as a map needs.
bool Bootstrapper::IsFollowed(const FirstMap& map) const {
  const std::vector<InitPosition>& points = map.outcome.frames.back().positions;
  const auto followed = std::ranges::count_if(points, [&](const InitPosition& point) {
    return FindById(reference_.frames.back().observations, point.id) != nullptr;
  });
  return 2 * followed >= std::ssize(points) || (handover_frames_ > 0 && followed >= options_.init.window.min_points);
}

// A map of the present reference that is provisional itself does not replace a better one that was put aside.
void Bootstrapper::FinishMapOrGoBack(Answer answer, BootstrapStep* step) {
  if (answer.outcome.provisional && weak_.HasBetterThan(answer.outcome, reference_.provisional)) {
    GoBack(*weak_.EndWait(std::exchange(reference_.provisional, std::nullopt)), step);
    return;
  }
  MadeMap made = MapOf(std::move(answer), reference_);
  if (IsFollowed(made.map))
    FinishMap(std::move(made.map), step);
  else
    Retrack(std::move(made), step);
}

// To the best map that was put aside, if there is one. A weak one waits where the frames since then can be read again;
// what the next reference had waits for the present one.
void Bootstrapper::GiveUpReference(Reference* reference, BootstrapStep* step) {
  if (reference == &next_) {
    if (auto made = std::exchange(next_.provisional, std::nullopt)) PutAside(*std::move(made), &reference_.provisional);
    reference_tracks_.Drop(&next_);
    return;
  }
  const int max_wait = handover_frames_ == 0 ? kWeakReferences * options_.init.window.last_frame : 0;
  if (auto made = weak_.GiveUpReference(std::exchange(reference_.provisional, std::nullopt),
                                        static_cast<int>(reference_.frames.size()), max_wait))
    GoBack(*std::move(made), step);
  else
    DropReference();
}

// The other one is dropped; what it put aside may still be better.
void Bootstrapper::MakePresent(Reference* reference) {
  if (reference == &reference_) return;
  std::optional<MadeMap> best = std::exchange(reference_.provisional, std::nullopt);
  if (next_.provisional) PutAside(*std::move(next_.provisional), &best);
  DropReference();
  reference_ = std::exchange(next_, {});
  reference_.provisional = std::move(best);
}

// Halfway through the present one's time. Frames that do not come again leave no time for more than one.
void Bootstrapper::BeginNextReference(const PreparedFrame& frame, StageTimes* times) {
  if (next_.IsThere() || handover_frames_ > 0 || !reference_tracks_.CanOverlap()) return;
  const int past_half = static_cast<int>(reference_.frames.size()) - 1 - options_.init.window.last_frame / 2;
  if (past_half < 0 || past_half % options_.top_up_frames != 0) return;
  const StageTimer timer(times, Stage::kInitialize);
  next_ = reference_tracks_.Take(frame);
  if (next_.Points() < options_.min_corners) reference_tracks_.Drop(&next_);
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
  if (const auto since = weak_.Since()) return since;
  return HasReference() ? std::optional(reference_.frames.front().frame_idx) : std::nullopt;
}

// The points of the map are followed again from the frame that it is of.
void Bootstrapper::Retrack(MadeMap made, BootstrapStep* step) {
  const bool present = HasReference() && made.frame.frame_idx == reference_.frames.back().frame_idx;
  Abandon();
  std::erase_if(made.map.frames.back().observations,
                [&](const InitObservation& seen) { return !tracks_->Resume(seen.id, seen.pixel, made.frame); });
  std::erase_if(made.map.outcome.frames.back().positions, [&](const InitPosition& point) {
    return FindById(made.map.frames.back().observations, point.id) == nullptr;
  });
  reference_.frames = made.map.frames;
  FinishMap(std::move(made.map), step);
  if (!present) step->map_frame = std::move(made.frame);
}

// Of the first frames since the reference, or of all. The bootstrapper begins anew.
void Bootstrapper::FinishMap(FirstMap map, BootstrapStep* step) {
  for (const InitRejectedPoint& rejected : map.outcome.rejected)
    if (rejected.reason != InitRejection::kLostOnTheWay) step->losses.Add(InitRejectionName(rejected.reason), 1);
  weak_.Drop();
  was_ambiguous_ = false;
  given_up_ = {};
  ForgetAlternative();
  map.outcome.decision = InitDecision::kMap;
  oracle_poses_->TakeWorld({camera_, map.frames, {}}, &map.outcome);
  has_map_ = step->has_to_catch_up = map.frames.size() < reference_.frames.size();
  answers_.Drop();
  step->map = std::move(map);
  reference_tracks_.Drop(&next_);
  reference_.provisional.reset();
  if (has_map_) return;
  reference_ = {};
  step->events.push_back(TrackingEvent::kMapCreated);
}

void Bootstrapper::Release() {
  reference_ = {};
  has_map_ = false;
}

BootstrapStep Bootstrapper::EndSequence(StageTimes* times) {
  BootstrapStep step;
  const StageTimer timer(times, Stage::kInitialize);
  while (auto answer = answers_.Take(std::numeric_limits<int>::max())) {
    TakeAnswer(*std::move(answer), &reference_, &step);
    if (step.map || !HasReference()) return step;
  }
  if (HasReference()) AttemptLast(&reference_, &step);
  // All frames of the next one are the present one's too: where that cannot tell camera and scene apart it cannot
  // either.
  if (!step.ambiguity.empty()) reference_tracks_.Drop(&next_);
  if (next_.IsThere() && !step.map) AttemptLast(&next_, &step);
  if (step.map) return step;
  if (next_.provisional) PutAside(*std::exchange(next_.provisional, std::nullopt), &reference_.provisional);
  if (auto made = weak_.EndWait(std::exchange(reference_.provisional, std::nullopt))) GoBack(*std::move(made), &step);
  return step;
}

void Bootstrapper::AttemptLast(Reference* reference, BootstrapStep* step) {
  PreparedFrame last;
  last.frame_idx = reference->frames.back().frame_idx;
  Question question = QuestionOf(*reference);
  question.moment = InitMoment::kLastFrame;
  if (!reference->provisional && !weak_.IsThere()) question.alternative = AlternativeToAsk();
  Answer answer = AskInitializers(reference->frames, question, last);
  // What a reference of the last few images lacks says less than why one that lasted longer was given up.
  const bool says_less = reference->frames.size() < given_up_.frames && !answer.outcome.ambiguous;
  if (!says_less) given_up_ = {reference->frames.size(), answer.outcome.reason};
  step->note = WithFault(given_up_.reason, image_fault_);
  TakeAlternative(answer, reference);
  if (answer.outcome.decision == InitDecision::kNewReference && step->ambiguity.empty())
    TellAmbiguity(answer.outcome, *reference, step);
  if (answer.outcome.decision != InitDecision::kMap) return;
  // Where a longer one gave no map, depths that hardly stand out do so by chance.
  const InitMeasurements& measured = answer.outcome.measured;
  const bool hardly_stand_out = measured.median_depth_sigma > 0 && measured.DepthSignal() < kMinProvisionalSignal;
  if (says_less && answer.outcome.provisional && hardly_stand_out) return;
  MakePresent(reference);
  FinishMapOrGoBack(std::move(answer), step);
}

void Bootstrapper::Abandon() {
  DropReference();
  reference_tracks_.Drop(&next_);
  weak_.Drop();
  given_up_ = {};
}

// The present one.
void Bootstrapper::DropReference() {
  reference_tracks_.Drop(&reference_);
  has_map_ = false;
  answers_.Drop();
}

void Bootstrapper::Serialize(StateArchive& archive) {
  bool asks_alternative = alternative_ != nullptr;
  archive(asks_alternative);
  if (!asks_alternative) alternative_.reset();
  archive(has_map_, reference_, next_, image_fault_, weak_, was_ambiguous_, would_start_, given_up_, answers_);
}
void Bootstrapper::GivenUp::Serialize(StateArchive& archive) { archive.Members<2>(*this); }
void Bootstrapper::Answer::Serialize(StateArchive& archive) { archive.Members<4>(*this); }

}  // namespace pliant
