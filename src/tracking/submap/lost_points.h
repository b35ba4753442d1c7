// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Points of the map that are out of sight. Each stays what it was, with its id and its patch, and is taken along by the
// points around it that are seen (docs/method.md, eq. R1), so that it can be searched when it comes back.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "pliant/camera/camera.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/geometry/sim3.h"
#include "pliant/scene/map.h"
#include "pliant/tracking/tracks/point_tracker.h"

namespace pliant {

class StateArchive;

// The displacement since rest of the landmarks around each of `positions` (weights as in R1). Neighbors are searched
// among `anchors`, one a landmark: where it is now, or at rest. Zero where there are no landmarks.
std::vector<Eigen::Vector3d> DisplacementsAt(const std::vector<Landmark>& landmarks,
                                             const std::vector<Eigen::Vector3d>& anchors,
                                             const std::vector<Eigen::Vector3d>& positions);

// Landmarks of another map as if these had always been around them: each is where it is, and at rest where it would be
// had it moved as they have.
void TakeRestFrom(const std::vector<Landmark>& seen, std::vector<Landmark>* others);

class LostPoints {
 public:
  // Takes a landmark over that was last seen by a camera at this pose.
  void Add(const Landmark& landmark, const Rigid3& cam_from_world);
  // Lets go of a point that was found, or that is to be forgotten.
  void Remove(PointId id) { points_.erase(id); }
  void Clear() { points_.clear(); }
  std::size_t size() const { return points_.size(); }
  // The one that has been lost the longest; there has to be one.
  PointId Oldest() const;

  // Into another world.
  void MoveInto(const Sim3& other_from_world);
  // Moves where they are now, and not where they rest.
  void MoveAllButRest(const Rigid3& motion);
  // Multiplies the standard deviations of their distances.
  void ScaleSigmas(double factor);
  // All of `other`, which is in the same world and has other ids; as if they had been lost before these. Each is at
  // rest where it would be had it moved as the landmarks around it that are seen.
  void TakeOver(LostPoints&& other, const std::vector<Landmark>& seen);

  // Where each is now, as the landmarks that are seen say (R1). `seen` sorted by id.
  void Move(const std::vector<Landmark>& seen);

  // Those that a camera at this pose should see, at most `count`, and where: those searched least often first. The
  // affine change is that of a surface that faces the camera.
  std::vector<PointPrediction> Expected(const Camera& camera, const Rigid3& cam_from_world, std::size_t count) const;
  // These were searched where the camera, as it turned out, should have seen them. Those that are not lost count for
  // nothing.
  void CountSearches(const std::vector<PointId>& ids);

  // Where a camera at this pose should see them; without those that were searched in vain so often that another point
  // may take their place.
  std::vector<Eigen::Vector2d> Pixels(const Camera& camera, const Rigid3& cam_from_world) const;

  // All of them, each where it is thought to be now; sorted by id.
  std::vector<Landmark> landmarks() const;
  // Null where it is not lost.
  const Landmark* Find(PointId id) const;

  void Serialize(StateArchive& archive);

 private:
  struct Point {
    Landmark landmark;        // `position` is where it is thought to be now
    Rigid3 cam_from_world;    // when it was last seen
    Eigen::Vector3d seen_at;  // where it was then
    // Of its displacement then: what its neighbors did not share. Set by the first Move.
    std::optional<Eigen::Vector3d> own_share;
    int searches = 0;
    std::int64_t order = 0;  // in which they were lost
    void Serialize(StateArchive& archive);
  };
  std::map<PointId, Point> points_;
  std::int64_t next_order_ = 0;
};

}  // namespace pliant
