// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// From the reference image to the first map: takes a reference, follows its points, and asks the initializer in every
// frame. When a reference has had half of its time the next one is begun beside it, so that a map does not depend on
// where references happen to begin. It works on the submap that awaits its map and returns what it found; the map is
// made by the caller.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pliant/base/delayed_answers.h"
#include "pliant/camera/camera.h"
#include "pliant/camera/photometric_calibration.h"
#include "pliant/image/brightness.h"
#include "pliant/tracking/stage_times.h"
#include "pliant/tracking/state.h"
#include "pliant/tracking/tracker_options.h"
#include "pliant/tracking/tracks/track_source.h"
#include "tracking/bootstrapping/first_map.h"
#include "tracking/bootstrapping/reference.h"
#include "tracking/bootstrapping/reference_tracks.h"
#include "tracking/bootstrapping/waiting_maps.h"
#include "tracking/frame/oracle_poses.h"
#include "tracking/submap/submap.h"
#include "tracking/tracks/loss_counts.h"

namespace pliant {

// What one frame was good for on the way to the first map.
struct BootstrapStep {
  std::vector<TrackingEvent> events = {};  // in their order
  int tracked = 0;                         // points found in this frame, or followed into it
  LossCounts losses = {};
  std::string note = {};  // one sentence
  // Why camera and scene cannot be told apart in the frames since a reference that was given up for it; else empty.
  std::string ambiguity = {};
  int ambiguous_since_frame_idx = 0;           // that reference
  std::optional<FirstMap> map = std::nullopt;  // when the initializer made one; the bootstrapper then begins anew
  // Where the map is of an earlier frame, one of the two: it has to catch up with the frames in which the bootstrapper
  // follows its points until Release; or tracking goes on after that frame.
  bool has_to_catch_up = false;
  std::optional<PreparedFrame> map_frame = std::nullopt;
};

class Bootstrapper {
 public:
  // `tracks` and `oracle_poses` must outlive this. `threads` >= 1 do not change the result. `handover_frames` >= 0
  // after a frame it is known whether it makes a map; the initializer is then asked beside tracking. `alternative`,
  // which may be null, takes more for granted than `initializer`: it makes no map, but is asked whether it would
  // (WouldStart).
  Bootstrapper(const Camera& camera, const TrackerOptions& options, int threads, int handover_frames,
               const std::optional<PhotometricCalibration>& photometric, CameraOrigin camera_origin,
               TrackSource* tracks, OraclePoses* oracle_poses, std::shared_ptr<const Initializer> initializer,
               std::shared_ptr<const Initializer> alternative);

  // The next frame; `submap` has no landmarks yet.
  BootstrapStep Process(const PreparedFrame& frame, Submap* submap, StageTimes* times);
  // No frame will follow: a last attempt with those that were processed since the reference, if there is one.
  BootstrapStep EndSequence(StageTimes* times);
  // The reports of the frames since the reference, with what the first map knows of them.
  std::vector<FrameReport> Completed(const FirstMap& first, std::vector<FrameReport> reports) const {
    return CompletedReports(camera_, first, std::move(reports));
  }
  // Gives the reference up, its points, and what earlier references left.
  void Abandon();
  // While a map catches up: the frames since the reference, of which the last may be the present one.
  const std::vector<InitFrame>& followed() const { return reference_.frames; }
  // It has caught up: its points are others' now.
  void Release();

  // What the alternative answered the first time that it would have made a map: one sentence; empty: it never would,
  // there has been a map, or camera and scene could not be told apart.
  const std::string& WouldStart() const { return would_start_; }

  void Serialize(StateArchive& archive);

  bool HasReference() const { return reference_.IsThere(); }
  // The first frame for which a map may still come that was put aside, or is made: a reference. Nothing: there is none.
  std::optional<int> AwaitsMapSince() const;

 private:
  BootstrapStep TakeReference(const PreparedFrame& frame, Submap* submap, StageTimes* times);
  BootstrapStep FollowReference(const PreparedFrame& frame, Submap* submap, StageTimes* times);
  std::string NumberOfPoints(int count) const;
  // The reference that lasted longest of those that were given up since the last map: what it lacked says most.
  struct GivenUp {
    std::size_t frames = 0;  // 0: none was given up
    std::string reason = {};
    void Serialize(StateArchive& archive);
  };
  // What the initializers say of the frames up to one of them.
  struct Answer {
    std::size_t frames = 0;  // since the reference
    PreparedFrame last;      // of these
    InitOutcome outcome = {};
    std::optional<InitOutcome> alternative = std::nullopt;  // where it was asked
    void Serialize(StateArchive& archive);
  };

  // What the initializers are asked of a reference, besides its frames.
  struct Question {
    std::vector<double> known_depths;
    bool camera_may_stand_still = false;
    bool was_ambiguous = false;
    cv::Mat reference_depth_mm = {};
    InitMoment moment = InitMoment::kMoreFollow;
    std::shared_ptr<const Initializer> alternative = nullptr;  // null: it is not asked
  };

  Question QuestionOf(const Reference& reference) const;
  Answer AskInitializers(const std::vector<InitFrame>& frames, const Question& question,
                         const PreparedFrame& last) const;
  std::shared_ptr<const Initializer> AlternativeToAsk() const;
  std::optional<Answer> NextAnswer(const PreparedFrame& frame, StageTimes* times);
  void TryInitialize(const PreparedFrame& frame, StageTimes* times, BootstrapStep* step);
  void TryNextReference(const PreparedFrame& frame, StageTimes* times, BootstrapStep* step);
  void TakeAnswer(Answer answer, Reference* reference, BootstrapStep* step);
  void TellAmbiguity(const InitOutcome& outcome, const Reference& reference, BootstrapStep* step) const;
  void TakeAlternative(const Answer& answer, Reference* reference);
  void ForgetAlternative();
  static MadeMap MapOf(Answer answer, const Reference& reference);
  bool IsFollowed(const FirstMap& map) const;
  void FinishMap(FirstMap map, BootstrapStep* step);
  void FinishMapOrGoBack(Answer answer, BootstrapStep* step);
  void AttemptLast(Reference* reference, BootstrapStep* step);
  void GiveUpReference(Reference* reference, BootstrapStep* step);
  void DropReference();
  void BeginNextReference(const PreparedFrame& frame, StageTimes* times);
  void MakePresent(Reference* reference);
  void GoBack(MadeMap made, BootstrapStep* step);
  void Retrack(MadeMap made, BootstrapStep* step);

  Camera camera_;
  TrackerOptions options_;
  int threads_;
  int handover_frames_;
  std::optional<PhotometricCalibration> photometric_;
  CameraOrigin camera_origin_;
  TrackSource* tracks_;
  OraclePoses* oracle_poses_;
  std::shared_ptr<const Initializer> initializer_;
  std::shared_ptr<const Initializer> alternative_;
  ReferenceTracks reference_tracks_;

  bool has_map_ = false;        // one that catches up
  Reference reference_;         // the present one
  Reference next_;              // takes its place when it is given up
  std::string image_fault_;     // of the last frame
  WeakMap weak_;                // of references that were given up
  bool was_ambiguous_ = false;  // when a reference was given up, since the last map
  std::string would_start_;
  GivenUp given_up_;
  DelayedAnswers<Answer> answers_;  // steps: the number of frames since the reference; ends before what it reads
};

}  // namespace pliant
