// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// One frame with a map, as in the paper: from predicted pixels to the pose and the displacements of this frame. It
// reads a submap and returns what it found; the tracker decides what becomes of it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pliant/camera/camera.h"
#include "pliant/deformation/graph.h"
#include "pliant/scene/frame_report.h"
#include "pliant/tracking/stage_times.h"
#include "pliant/tracking/tracker_options.h"
#include "pliant/tracking/tracks/track_source.h"
#include "tracking/frame/oracle_poses.h"
#include "tracking/submap/submap.h"
#include "tracking/tracks/followed_points.h"

namespace pliant {

// A frame as its points and the map explain it.
struct SolvedFrame {
  std::string failure = {};     // why there is no solution, one sentence; empty: there is one
  int tracked = 0;              // points that were followed, before any was rejected
  FollowedPoints points = {};   // those that the solution explains
  FrameSolution solution = {};  // pose and costs
};

class FrameTracker {
 public:
  // `tracks` and `oracle_poses` must outlive this. `cost`: a term of the program's own, or null.
  FrameTracker(const Camera& camera, const TrackerOptions& options, int threads, TrackSource* tracks,
               const OraclePoses* oracle_poses, std::shared_ptr<const FrameCost> cost)
      : camera_(camera),
        options_(options),
        threads_(threads),
        tracks_(tracks),
        oracle_poses_(oracle_poses),
        cost_(std::move(cost)) {}

  // The pose that is known without estimating it: the truth's, or that of a camera that stands still.
  std::optional<Rigid3> KnownPose(int frame_idx, const Submap& submap) const;

  // The landmarks, followed from where they are expected by a camera at this pose (P1). The other overload predicts the
  // pose itself (E6).
  FollowedPoints Follow(const PreparedFrame& frame, const Submap& submap, const Rigid3& cam_from_world) const;
  FollowedPoints Follow(const PreparedFrame& frame, const Submap& submap) const;
  // The landmarks as they were followed into this frame before there was a map.
  FollowedPoints Followed(const InitFrame& frame, const Submap& submap) const;
  // Adds lost points that are where they are expected (R2). They take part in the frame's problem like the others.
  void FindLost(const PreparedFrame& frame, const Rigid3& cam_from_world, Submap* submap,
                FollowedPoints* followed) const;

  // The frame's pose and displacements from the points that were followed into it. `state`: before this frame; lost
  // points are searched while it is tracking.
  SolvedFrame Solve(const PreparedFrame& frame, TrackingState state, FollowedPoints followed, Submap* submap,
                    StageTimes* times) const;

 private:
  Rigid3 PredictPose(int frame_idx, const Submap& submap) const;
  std::vector<PointPrediction> PredictPixels(const Submap& submap, const Rigid3& cam_from_world) const;
  Rigid3 EstimatePose(const FollowedPoints& followed, StageTimes* times) const;
  DeformationGraph BuildGraph(const FollowedPoints& followed, StageTimes* times) const;
  void RejectNeighborOutliers(const Rigid3& cam_from_world, const DeformationGraph& graph,
                              FollowedPoints* followed) const;
  void RejectReprojectionOutliers(FollowedPoints* followed) const;
  std::string TooFewPoints(int count, const Submap& submap) const;
  std::string Unconfirmed(const FollowedPoints& followed) const;

  Camera camera_;
  TrackerOptions options_;
  int threads_;
  TrackSource* tracks_;
  const OraclePoses* oracle_poses_;
  std::shared_ptr<const FrameCost> cost_;
};

}  // namespace pliant
