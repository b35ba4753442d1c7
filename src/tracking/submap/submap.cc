// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/submap/submap.h"

#include <algorithm>

#include "tracking/serialize.h"

namespace pliant {

bool Submap::IsBlurred(const PreparedFrame& frame, const TrackerOptions& options,
                       const TrackAbilities& abilities) const {
  return options.track_blurred == Switch::kOn && abilities.tracks_blurred &&
         blurred_frames < options.max_blurred_frames && frame.sharpness < options.min_sharpness * previous.sharpness;
}

// Without what gives its depth, which belongs to the source of the frames.
void Submap::Remember(const PreparedFrame& frame) {
  previous = frame;
  previous.known_depth_mm = nullptr;
  previous.known_points = nullptr;
}

std::vector<PointObservation> Submap::Observations() const {
  std::vector<PointObservation> observations;
  for (const Landmark& landmark : map.landmarks)
    observations.push_back(
        {landmark.id, landmark.pixel, landmark.position, landmark.ssim, DistanceSigma(landmark, last_cam_from_world)});
  return observations;
}

std::vector<Landmark> Submap::KnownLandmarks() const {
  std::vector<Landmark> known = map.landmarks;
  const std::vector<Landmark> lost = lost_points.landmarks();
  known.insert(known.end(), lost.begin(), lost.end());
  return known;
}

void Submap::Commit(const FollowedPoints& points, const Rigid3& cam_from_world, TrackingState before,
                    const TrackerOptions& options, TrackSource* tracks) {
  // What is followed into blur is not kept; what a search that failed before it found would be.
  if (!points.in_blur) tracks->Keep(points.ids);
  Map next;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Landmark* known = map.Find(points.ids[k]);
    Landmark landmark = known != nullptr ? *known : *lost_points.Find(points.ids[k]);
    lost_points.Remove(landmark.id);
    landmark.last_motion = points.solved[k].position - landmark.position;
    landmark.position = points.solved[k].position;
    if (!points.in_blur)
      landmark.sharp_pixel.reset();
    else if (!landmark.sharp_pixel)
      landmark.sharp_pixel = landmark.pixel;
    landmark.pixel = points.pixels[k];
    landmark.ssim = points.ssim[k];
    next.landmarks.push_back(landmark);
  }
  for (const Landmark& landmark : map.landmarks) {
    if (next.Find(landmark.id) != nullptr) continue;
    const bool unseen = std::binary_search(points.unseen.begin(), points.unseen.end(), landmark.id);
    if (unseen && options.find_lost == Switch::kOn)
      lost_points.Add(landmark, last_cam_from_world);
    else
      tracks->Remove(landmark.id);
  }
  for (; static_cast<int>(lost_points.size()) > options.max_lost_points; lost_points.Remove(lost_points.Oldest()))
    tracks->Remove(lost_points.Oldest());
  map = std::move(next);
  lost_points.CountSearches(points.searched);
  lost_points.Move(map.landmarks);  // (R1)
  // After a gap there is no velocity.
  before_last_cam_from_world = before == TrackingState::kTracking ? last_cam_from_world : cam_from_world;
  last_cam_from_world = cam_from_world;
  lost_frames = 0;
  blurred_frames = points.in_blur ? blurred_frames + 1 : 0;
}

void Submap::BecomeProvisional() {
  provisional = true;
  if (depths.signal <= kMinProvisionalSignal) return;
  const double factor = depths.signal / kMinProvisionalSignal;
  for (Landmark& landmark : map.landmarks) landmark.log_distance_sigma *= factor;
  lost_points.ScaleSigmas(factor);
  depths.signal = kMinProvisionalSignal;
}

void Submap::MoveInto(const Sim3& other_from_world) {
  for (Landmark& landmark : map.landmarks) landmark = Moved(other_from_world, landmark);
  lost_points.MoveInto(other_from_world);
  for (Rigid3* pose : {&last_cam_from_world, &before_last_cam_from_world}) *pose = PoseInWorld(other_from_world, *pose);
  for (auto& [step, pose] : recent_poses) pose = PoseInWorld(other_from_world, pose);
}

void Submap::MoveInto(const Rigid3& other_from_world) {
  MoveInto(Sim3{1.0, other_from_world.rotation, other_from_world.translation});
  candidates.Move(other_from_world);
}

void Submap::MoveAllButRest(const Rigid3& motion) {
  for (Landmark& landmark : map.landmarks) {
    landmark.position = motion * landmark.position;
    landmark.determined_at = motion * landmark.determined_at;
    landmark.last_motion = motion.rotation * landmark.last_motion;
  }
  lost_points.MoveAllButRest(motion);
  candidates.Move(motion);
  const Rigid3 back = motion.Inverse();
  for (Rigid3* pose : {&last_cam_from_world, &before_last_cam_from_world}) *pose = *pose * back;
  for (auto& [step, pose] : recent_poses) pose = pose * back;
}

void Submap::TakeOver(Submap&& other, TrackSource* tracks) {
  for (Submap* submap : {this, &other}) {
    for (const CandidateTrack& track : submap->candidates.tracks()) tracks->Remove(track.id);
    submap->candidates.Clear();
    submap->rigid_history.Stop();  // its frames know one map's points alone
  }
  provisional = provisional || other.provisional;
  descriptors.TakeOver(std::move(other.descriptors));
  lost_points.TakeOver(std::move(other.lost_points), map.landmarks);
  TakeRestFrom(map.landmarks, &other.map.landmarks);
  for (const Landmark& landmark : other.map.landmarks) lost_points.Add(landmark, other.last_cam_from_world);
}

void Submap::RemoveFrom(TrackSource* tracks) const {
  for (const Landmark& landmark : KnownLandmarks()) tracks->Remove(landmark.id);
  for (const CandidateTrack& track : candidates.tracks()) tracks->Remove(track.id);
}

void Submap::Serialize(StateArchive& archive) { archive.Members<15>(*this); }
void DepthCertainty::Serialize(StateArchive& archive) { archive.Members<2>(*this); }

}  // namespace pliant
