// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/relocalization/relocalizer.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "tracking/image_fault.h"

namespace pliant {
namespace {

// `count` times the motion from one pose to the next.
Rigid3 Repeated(const Rigid3& motion, double count) {
  const Eigen::AngleAxisd turn(motion.rotation);
  return {Eigen::Quaterniond(Eigen::AngleAxisd(count * turn.angle(), turn.axis())), count * motion.translation};
}

}  // namespace

void Relocalizer::RememberPose(int step, Submap* submap) const {
  const auto length = static_cast<std::size_t>(options_.relocalization.velocity_frames) + 1;
  auto& poses = submap->recent_poses;
  // Frames may be tracked backward.
  const auto follows = [&] {
    const int by = step - poses.back().first;
    return poses.size() < 2 ? std::abs(by) == 1 : by == poses.back().first - poses[poses.size() - 2].first;
  };
  if (!poses.empty() && !follows()) poses.clear();
  poses.emplace_back(step, submap->last_cam_from_world);
  if (poses.size() > length) poses.erase(poses.begin());
}

void Relocalizer::RememberView(const PreparedFrame& frame, Submap* submap) const {
  if (options_.relocalization.relocalize == Switch::kOff || !abilities_.sees_appearance) return;
  if (frame.step % options_.relocalization.describe_every != 0) return;
  submap->descriptors.See(frame.gray, submap->map.landmarks);
  std::vector<PointId> known;
  for (const Landmark& landmark : submap->KnownLandmarks()) known.push_back(landmark.id);
  std::sort(known.begin(), known.end());
  submap->descriptors.Keep(known);
}

void Relocalizer::RememberLastView(Submap* submap) const {
  // The landmarks' pixels are of the last frame that was tracked, the image is that of the last sharp one.
  if (options_.relocalization.relocalize == Switch::kOn && submap->blurred_frames == 0)
    submap->descriptors.See(submap->previous.gray, submap->map.landmarks);
}

// Where the camera may be in this frame: where it was, and where it would be had it gone on as it went.
std::vector<Rigid3> Relocalizer::GuessPoses(int step, const Submap& submap) const {
  std::vector<Rigid3> guesses = {submap.last_cam_from_world};
  if (options_.relocalization.relocalize == Switch::kOff || submap.recent_poses.size() < 2) return guesses;
  const auto& [first_step, first] = submap.recent_poses.front();
  const auto& [last_step, last] = submap.recent_poses.back();
  const double frames = static_cast<double>(step - last_step) / (last_step - first_step);
  guesses.insert(guesses.begin(), Repeated(last * first.Inverse(), frames) * submap.last_cam_from_world);
  return guesses;
}

// The points that are found from a guess, when enough of those that it should see agree; else none. Their pose is the
// one on which they agree.
FollowedPoints Relocalizer::FollowFrom(const PreparedFrame& frame, const Rigid3& guess, Submap* submap) const {
  FollowedPoints followed = frame_tracker_->Follow(frame, *submap, guess);
  if (options_.relocalization.relocalize == Switch::kOff) return followed;
  const auto improve = [&] {
    const auto pose =
        EstimateCameraPose(camera_, followed.positions, followed.pixels, followed.cam_from_world, options_.pose);
    if (pose.ok()) followed.cam_from_world = pose->cam_from_world;
  };
  // Once more, from a better pose.
  if (static_cast<int>(followed.size()) >= options_.min_points) improve();
  const Rigid3 better = followed.cam_from_world;
  followed = frame_tracker_->Follow(frame, *submap, better);
  if (options_.find_lost == Switch::kOn && !followed.in_blur)
    frame_tracker_->FindLost(frame, better, submap, &followed);
  FollowedPoints none;
  none.expected = followed.expected;
  none.unconfirmed = followed.size();
  if (static_cast<int>(followed.size()) < options_.min_points) return none;
  improve();
  return IsConfirmed(followed) ? followed : none;
}

bool Relocalizer::IsConfirmed(const FollowedPoints& followed) const {
  int agree = 0;
  for (std::size_t k = 0; k < followed.size(); ++k) {
    const auto pixel = camera_.Project(followed.cam_from_world * followed.positions[k]);
    if (pixel && (*pixel - followed.pixels[k]).norm() <= options_.relocalization.max_error_px) ++agree;
  }
  return agree >= options_.min_points &&
         static_cast<double>(agree) >= options_.relocalization.min_share * static_cast<double>(followed.expected);
}

const DescribedImage& Relocalizer::Described(const PreparedFrame& frame) {
  if (described_frame_idx_ != frame.frame_idx) {
    described_ = Describe(frame.gray, frame.mask, options_.corners, options_.relocalization);
    described_frame_idx_ = frame.frame_idx;
  }
  return described_;
}

FollowedPoints Relocalizer::Relocalize(const PreparedFrame& frame, Submap* submap) {
  if (!Blankness(frame.gray, frame.mask).empty()) return {};
  FollowedPoints best;  // none; what is said of it
  const auto is_found = [&](const Rigid3& guess) {
    FollowedPoints followed = FollowFrom(frame, guess, submap);
    if (followed.size() > 0 || followed.unconfirmed > best.unconfirmed) best = std::move(followed);
    return best.size() > 0;
  };
  for (const Rigid3& guess : GuessPoses(frame.step, *submap))
    if (is_found(guess)) return best;
  if (options_.relocalization.relocalize == Switch::kOff) return best;
  const auto recognized = submap->descriptors.Recognize(Described(frame), camera_, submap->KnownLandmarks());
  if (recognized.ok()) is_found(recognized->cam_from_world);
  return best;
}

}  // namespace pliant
