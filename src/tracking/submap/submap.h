// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A map with all that belongs to it: what the tracker goes on with, and what it keeps of a map that it left.
#pragma once

#include <utility>
#include <vector>

#include "pliant/geometry/rigid3.h"
#include "pliant/geometry/sim3.h"
#include "pliant/scene/frame_report.h"
#include "pliant/scene/map.h"
#include "pliant/tracking/prepared_frame.h"
#include "pliant/tracking/tracks/track_source.h"
#include "tracking/submap/candidates.h"
#include "tracking/submap/landmark_descriptors.h"
#include "tracking/submap/lost_points.h"
#include "tracking/submap/rigid_history.h"
#include "tracking/tracks/followed_points.h"

namespace pliant {

// (W15) How well the depths of a map were known when it was made.
struct DepthCertainty {
  double sigma = 0;   // of the points, by their distance, in the median; 0: from metric depth
  double signal = 0;  // their spread by their sigma; 0: from metric depth
  void Serialize(StateArchive& archive);
};

struct Submap {
  Submap(int submap_idx, const Camera& camera, const TrackerOptions& options)
      : idx(submap_idx), candidates(camera, options.growth), descriptors(options.relocalization) {}

  // Whether an image is blurred, or dark, against the last sharp one, and that matters to the source of tracks. Of many
  // such images in a row the later ones are not: the blur stays.
  bool IsBlurred(const PreparedFrame& frame, const TrackerOptions& options, const TrackAbilities& abilities) const;
  // The frame is the one that the next one's points are followed from.
  void Remember(const PreparedFrame& frame);
  // The landmarks as this submap's last frame shows them; sorted by id.
  std::vector<PointObservation> Observations() const;
  // The landmarks in sight and those that were lost.
  std::vector<Landmark> KnownLandmarks() const;

  // A solved frame becomes the map's present. What was not found in the image is lost, and may be found again; what
  // was found and contradicts the rest is forgotten. `before`: the state before this frame.
  void Commit(const FollowedPoints& points, const Rigid3& cam_from_world, TrackingState before,
              const TrackerOptions& options, TrackSource* tracks);
  // (W13) A map of a rigid window, of a scene that turns out to deform: its sigmas knew nothing of that. They become
  // those of depths that just stand out.
  void BecomeProvisional();
  // Into another world; where the two are one. Without its candidates, which are not kept where maps are merged.
  void MoveInto(const Sim3& other_from_world);
  // Into another world of the same unit, with all that it knows.
  void MoveInto(const Rigid3& other_from_world);
  // Moves what is now, cameras and points alike, and not where the points rest.
  void MoveAllButRest(const Rigid3& motion);
  // All that `other`, which is in the same world, knows besides: its points are lost ones, which are found where they
  // are in sight. The candidates of both are removed.
  void TakeOver(Submap&& other, TrackSource* tracks);
  // The source forgets all points of this submap.
  void RemoveFrom(TrackSource* tracks) const;

  void Serialize(StateArchive& archive);

  int idx;
  Map map;
  bool provisional = false;  // it is less certain than demanded, or hardly better than one constant depth
  DepthCertainty depths;
  LostPoints lost_points;
  RigidHistory rigid_history;
  Candidates candidates;
  LandmarkDescriptors descriptors;
  std::vector<InitFrame> window_frames;  // the last ones in which there was a map, with their candidates
  PreparedFrame previous;                // the last frame in which points were seen
  Rigid3 last_cam_from_world;
  Rigid3 before_last_cam_from_world;
  std::vector<std::pair<int, Rigid3>> recent_poses;  // by step, of the last frames in a row that were tracked
  int blurred_frames = 0;                            // in a row, up to now
  int lost_frames = 0;                               // in a row that show something, up to now
};

}  // namespace pliant
