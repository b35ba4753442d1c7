// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How a submap's map changes after a frame was committed: the points' common motion is removed, the map is refined
// while the scene is rigid, grown where the image shows more, and re-estimated every Nth frame.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/base/delayed_answers.h"
#include "pliant/camera/camera.h"
#include "pliant/camera/photometric_calibration.h"
#include "pliant/scene/frame_report.h"
#include "pliant/tracking/stage_times.h"
#include "pliant/tracking/tracker_options.h"
#include "pliant/tracking/tracks/track_source.h"
#include "tracking/bootstrapping/first_map.h"
#include "tracking/bootstrapping/window_solution.h"
#include "tracking/map_upkeep/replace_map.h"
#include "tracking/submap/submap.h"
#include "tracking/tracks/loss_counts.h"

namespace pliant {

// What an update changed, for the frame's report.
struct MapUpdate {
  LossCounts losses;
  std::vector<NewPoint> new_points;                    // sorted by id
  std::vector<RefinedPoint> refined_points;            // in the order of the updates
  std::optional<double> median_reprojection_error_px;  // where it changed
  std::string note;                                    // one sentence; empty: nothing to say
  FramePrior prior;
};

class MapUpdater {
 public:
  // `tracks` must outlive this. `threads` >= 1 do not change the result. A re-estimated map is taken over
  // options.handover_frames updates after it was due, one of a rigid scene after a third of them; it is then made
  // beside tracking.
  MapUpdater(const Camera& camera, const TrackerOptions& options, int threads,
             const std::optional<PhotometricCalibration>& photometric, TrackSource* tracks);

  // An empty submap gets its first map; points of uncertain depth become candidates.
  void Start(FirstMap first, Submap* submap);
  // A map that has just been started is of an earlier frame than `present`: only what is still followed there stays.
  void KeepFollowed(const InitFrame& present, Submap* submap) const;
  // After a frame was committed into which the points were followed before there was a map.
  void AddFollowed(const InitFrame& frame, Submap* submap) const;
  // The other points of the last of these frames become candidates, except those that the map's own frame `known`
  // shows: they were rejected.
  void AdoptFollowed(const InitFrame& known, const InitFrame& present, Submap* submap) const;
  // What all points have done together since rest is given to the camera, a share in each frame (E12).
  void RemoveCommonMotion(Submap* submap) const;
  // After a sharp frame was committed.
  MapUpdate Update(const PreparedFrame& frame, Submap* submap, StageTimes* times);
  // What is under way is not wanted any more: the view was lost, or another map or world is the current one.
  void Forget() { reestimations_.Drop(); }

  void Serialize(StateArchive& archive);

 private:
  // A map made anew of the pixels of the frames up to the one of `then`, in which the present map was that.
  struct Reestimation {
    WindowScene scene = WindowScene::kAny;
    MapInFrame then;
    InitOutcome outcome = {};
    void Serialize(StateArchive& archive);
  };

  bool GrowsMap() const;
  bool EstimatesPoses() const;

  void Reestimate(const std::vector<InitFrame>& frames, WindowScene scene, const Submap& submap);
  void TakeReestimations(Submap* submap, MapUpdate* update);
  void TakeRigid(const Reestimation& reestimation, Submap* submap, MapUpdate* update) const;
  void TakeAny(const Reestimation& reestimation, Submap* submap, MapUpdate* update) const;
  Rigid3 PoseInReplaced(const Submap& submap) const;
  bool AddToRigidHistory(int frame_idx, Submap* submap) const;
  void Grow(const PreparedFrame& frame, Submap* submap, StageTimes* times, MapUpdate* update);
  void FollowCandidates(const PreparedFrame& frame, Submap* submap) const;
  void AddCandidates(const PreparedFrame& frame, Submap* submap) const;
  void Promote(const Candidates::CertainPoint& point, Submap* submap, MapUpdate* update) const;

  void ComparePrior(const PreparedFrame& frame, const Submap& submap, FramePrior* prior) const;
  void RememberWindow(const PreparedFrame& frame, Submap* submap) const;
  void AddToWindow(InitFrame frame, Submap* submap) const;
  bool IsReestimationDue(int step, const Submap& submap) const;

  void Remove(PointId id, Submap* submap) const;
  void RejectReprojectionOutliers(const InitOutcome& outcome, Submap* submap, LossCounts* losses) const;
  void RejectDrifted(std::vector<InitPosition>* reestimated, Submap* submap, LossCounts* losses) const;

  Camera camera_;
  TrackerOptions options_;
  int threads_;
  std::optional<PhotometricCalibration> photometric_;
  TrackSource* tracks_;
  int updates_ = 0;
  DelayedAnswers<Reestimation> reestimations_;  // steps: updates; ends before what it reads
};

}  // namespace pliant
