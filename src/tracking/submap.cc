// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/submap.h"

namespace pliant {

void Tracker::Submap::MoveInto(const Sim3& other_from_world) {
  for (Landmark& landmark : map.landmarks) landmark = Moved(other_from_world, landmark);
  lost_points.MoveInto(other_from_world);
  for (Rigid3* pose : {&last_cam_from_world, &before_last_cam_from_world}) *pose = PoseInWorld(other_from_world, *pose);
  for (auto& [frame_idx, pose] : recent_poses) pose = PoseInWorld(other_from_world, pose);
}

void Tracker::Submap::MoveAllButRest(const Rigid3& motion) {
  for (Landmark& landmark : map.landmarks) {
    landmark.position = motion * landmark.position;
    landmark.last_motion = motion.rotation * landmark.last_motion;
  }
  lost_points.MoveAllButRest(motion);
  candidates.Move(motion);
  const Rigid3 back = motion.Inverse();
  for (Rigid3* pose : {&last_cam_from_world, &before_last_cam_from_world}) *pose = *pose * back;
  for (auto& [frame_idx, pose] : recent_poses) pose = pose * back;
}

void Tracker::Submap::TakeOver(Submap&& other) {
  for (Submap* submap : {this, &other}) {
    for (const CandidateTrack& track : submap->candidates.tracks()) submap->point_tracker.Remove(track.id);
    submap->candidates.Clear();
    submap->rigid_history.Stop();  // its frames know one map's points alone
  }
  point_tracker.TakeOver(std::move(other.point_tracker));
  places.TakeOver(std::move(other.places));
  lost_points.TakeOver(std::move(other.lost_points), map.landmarks);
  TakeRestFrom(map.landmarks, &other.map.landmarks);
  for (const Landmark& landmark : other.map.landmarks) lost_points.Add(landmark, other.last_cam_from_world);
}

}  // namespace pliant
