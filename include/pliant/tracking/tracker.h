// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Camera pose and deformation from one image after another (Gomez Rodriguez, Montiel, Tardos, IROS 2022). The tracker
// is given images and answers with reports; it owns the map. It neither reads nor writes files. From the reference
// frame on reports are held back until the first map is made, which gives those frames their poses and points, or the
// reference is given up. One frame's way: docs/architecture.md; equations: docs/method.md.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pliant/camera/camera.h"
#include "pliant/scene/frame_report.h"
#include "pliant/scene/map.h"
#include "pliant/tracking/prepared_frame.h"
#include "pliant/tracking/state.h"
#include "pliant/tracking/tracker_inputs.h"
#include "pliant/tracking/tracker_options.h"

namespace pliant {

class Bootstrapper;
class CatchUp;
class FrameTracker;
class MapUpdater;
class OraclePoses;
class Relocalizer;
class StageTimes;
class StateArchive;
class Submaps;
class TrackSource;
struct FirstMap;
struct FollowedPoints;
struct FrameResult;
struct Submap;

// The conductor: it hands each frame to the part whose turn it is, commits what that found, and reports the end state.
//   Bootstrapper  from the reference image to the first map
//   FrameTracker  follows the points into a frame and solves it: the paper's frame
//   Relocalizer   the way back after the view was lost
//   MapUpdater    common motion, growth, re-estimation
//   Submaps       the current map and those that were left; merging
class Tracker {
 public:
  // `threads` >= 1 work on one frame; the result does not depend on it. `seed` decides RANSAC's samples.
  Tracker(const Camera& camera, const TrackerOptions& options, std::uint64_t seed, int threads,
          const TrackerInputs& inputs = {});
  ~Tracker();

  // Begins with the map that was reported in this frame, instead of a first map of its own: the points that are
  // observed there, at rest where they are new. `evidence` is what that map rests on. To be called before any Process;
  // the frames that follow may come in any order of time.
  void TakeMap(const PreparedFrame& frame, const FrameReport& report, const FirstMapEvidence& evidence);

  // Ids of new points: the next one's, at least; and to leave those below `next` to others, who report points of the
  // same run.
  PointId next_point_id() const;
  void SkipPointIds(PointId next);

  // The reports that became final with this frame, in order of time; each frame is reported once.
  std::vector<FrameReport> Process(const PreparedFrame& frame);
  // The reports that are held back, in order of time, the last processed frame's last: those since the reference while
  // there is no map, else none. So far they are in state initializing.
  const std::vector<FrameReport>& held() const { return held_; }
  // Where the last call went back to a provisional map, since no certain one came: the frame in which that was made.
  // The frames after it are not reported yet; they are to be processed again, or are left out where they cannot be.
  // Nothing when asked again.
  std::optional<int> TakeGoesBackTo() { return std::exchange(goes_back_to_, std::nullopt); }
  // No frame will follow: while the first map is awaited, a last attempt at one. Its frames come from Finish.
  void EndSequence();
  // To be called when no more frames come, whatever the reason: the reports held back become final as they are.
  std::vector<FrameReport> Finish();

  // Whether the next frames' depth images or known points can be of use: before the first map, when that is to come
  // from them, and while another one may be begun.
  bool WantsDepth() const;
  // Whether the next one's is.
  bool NeedsDepth() const;

  TrackingState state() const { return state_; }
  // Whether there are inactive submaps: left, and neither found again nor merged.
  bool HasInactiveSubmaps() const;
  const Map& map() const;
  // While the first map is awaited: another Init.method that would have made one, as a sentence; empty: none.
  const std::string& WouldStart() const;
  // Whether all that the tracker keeps can be written: not while a first map catches up, nor with parts of a calling
  // program, or of the truth, that keep something of their own.
  bool IsSerializable() const;
  // Between two calls of Process. What is read was written by a tracker that was made alike.
  void Serialize(StateArchive& archive);

  // Lost for max_lost_frames frames that are neither dark nor frozen, and no new map is to be begun.
  bool GaveUp() const;

 private:
  void Apply(TrackingEvent event) { state_ = NextState(state_, event); }
  bool LeavesMap() const;
  void FindSubmapAgain(const PreparedFrame& frame);
  FrameResult Bootstrap(const PreparedFrame& frame, StageTimes* times);
  void StartMap(const FirstMap& first);
  void BeginCatchUp(FirstMap first);
  void EndCatchUp(FrameResult* result);
  void CompleteHeld(const FirstMap& first);
  void GoBackTo(const PreparedFrame& frame);
  FrameResult TrackFrame(const PreparedFrame& frame, StageTimes* times);
  FollowedPoints Follow(const PreparedFrame& frame, Submap* submap, StageTimes* times);
  std::string Lose(const PreparedFrame& frame, const std::string& reason, Submap* submap);
  void Report(const PreparedFrame& frame, const FrameResult& result, StageTimes* times);

  TrackerOptions options_;
  std::unique_ptr<OraclePoses> oracle_poses_;
  std::unique_ptr<TrackSource> tracks_;
  std::unique_ptr<Bootstrapper> bootstrapper_;
  std::unique_ptr<FrameTracker> frame_tracker_;
  std::unique_ptr<Relocalizer> relocalizer_;
  std::unique_ptr<MapUpdater> map_updater_;
  std::unique_ptr<Submaps> submaps_;
  TrackingState state_ = TrackingState::kWaitingForReference;
  std::unique_ptr<CatchUp> catch_up_;  // while the first map is of an earlier frame
  std::vector<FrameReport> held_;      // since the reference
  std::optional<int> goes_back_to_;
  std::vector<FrameReport> set_aside_;     // of the frames after the one gone back to, until they are processed again
  cv::Mat last_gray_;                      // the last image that was processed
  std::vector<RefinedPoint> moved_rests_;  // of points that a merge has given another rest, for the next report
};

}  // namespace pliant
