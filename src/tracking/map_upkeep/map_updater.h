// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How a submap's map changes after a frame was committed: the points' common motion is removed, the map is refined
// while the scene is rigid, grown where the image shows more, and re-estimated every Nth frame.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/camera/camera.h"
#include "pliant/camera/photometric_calibration.h"
#include "pliant/scene/frame_report.h"
#include "pliant/tracking/stage_times.h"
#include "pliant/tracking/tracker_options.h"
#include "pliant/tracking/tracks/track_source.h"
#include "tracking/bootstrapping/first_map.h"
#include "tracking/bootstrapping/window_solution.h"
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
};

class MapUpdater {
 public:
  // `tracks` must outlive this. `threads` >= 1 do not change the result.
  MapUpdater(const Camera& camera, const TrackerOptions& options, int threads,
             const std::optional<PhotometricCalibration>& photometric, TrackSource* tracks);

  // An empty submap gets its first map; points of uncertain depth become candidates.
  void Start(FirstMap first, Submap* submap) const;
  // What all points have done together since rest is given to the camera, a share in each frame (E12).
  void RemoveCommonMotion(Submap* submap) const;
  // After a sharp frame was committed.
  MapUpdate Update(const PreparedFrame& frame, Submap* submap, StageTimes* times) const;

 private:
  bool GrowsMap() const;
  bool EstimatesPoses() const;
  InitOutcome Reestimate(const std::vector<InitFrame>& frames, WindowScene scene) const;

  void RefineRigid(int frame_idx, Submap* submap, MapUpdate* update) const;
  void Grow(const PreparedFrame& frame, Submap* submap, StageTimes* times, MapUpdate* update) const;
  void FollowCandidates(const PreparedFrame& frame, Submap* submap) const;
  void AddCandidates(const PreparedFrame& frame, Submap* submap) const;
  void Promote(const Candidates::CertainPoint& point, Submap* submap, MapUpdate* update) const;

  void RememberWindow(const PreparedFrame& frame, Submap* submap) const;
  bool IsReestimationDue(int frame_idx, const Submap& submap) const;
  void ReestimateAny(Submap* submap, MapUpdate* update) const;

  void Remove(PointId id, Submap* submap) const;
  void RejectReprojectionOutliers(const InitOutcome& outcome, Submap* submap, LossCounts* losses) const;
  void RejectDrifted(std::vector<InitPosition>* reestimated, Submap* submap, LossCounts* losses) const;

  Camera camera_;
  TrackerOptions options_;
  int threads_;
  std::optional<PhotometricCalibration> photometric_;
  TrackSource* tracks_;
};

}  // namespace pliant
