// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The way back after the view was lost (docs/method.md, eq. R3): where the camera may be, and which of these guesses
// the image confirms.
#include <algorithm>
#include <ranges>

#include "pliant/tracking/tracker.h"
#include "tracking/followed.h"
#include "tracking/lost_points.h"
#include "tracking/oracle_answers.h"
#include "tracking/places.h"
#include "tracking/submap.h"
#include "tracking/tracker_support.h"

namespace pliant {
namespace {

// `count` times the motion from one pose to the next.
Rigid3 Repeated(const Rigid3& motion, double count) {
  const Eigen::AngleAxisd turn(motion.rotation);
  return {Eigen::Quaterniond(Eigen::AngleAxisd(count * turn.angle(), turn.axis())), count * motion.translation};
}

}  // namespace

void RelocalizationOptions::List(OptionTable& table) {
  table.BeginGroup("Relocalization", "the way back after the view was lost");
  table.AddChoice("relocalize", &relocalize,
                  "look for the map's points wherever the camera may be; off: only where it was");
  table.Add("remember_every", &remember_every, "frames", "from one description of the points in view to the next", 1,
            1000000);
  table.Add("seek_every", &seek_every, "frames", "while another map is awaited, those left are looked for so often", 1,
            1000000);
  table.Add("velocity_frames", &velocity_frames, "frames", "over which the camera's velocity before the loss is taken",
            1, 1000);
  table.Add("max_corners", &max_corners, "-", "of a lost frame, to compare with the map's points", 8, 100000);
  table.Add("max_ratio", &max_ratio, "-", "nearest by second nearest description", 0.1, 1);
  table.Add("max_error_px", &max_error_px, "px", "of a point that agrees with a pose", 0.1, 100);
  table.Add("min_share", &min_share, "-", "of the points that a pose should see: those that agree", 0, 1);
  pose.List(table);
}

// Of the frames in a row that led to this one, the poses.
void Tracker::Remember(const TrackerFrame& frame, const FrameReport& report) {
  const auto length = static_cast<std::size_t>(options_.relocalization.velocity_frames) + 1;
  if (!recent_poses_.empty() && recent_poses_.back().first + 1 != frame.frame_idx) recent_poses_.clear();
  recent_poses_.emplace_back(frame.frame_idx, *report.cam_from_world);
  if (recent_poses_.size() > length) recent_poses_.erase(recent_poses_.begin());
  if (options_.relocalization.relocalize == Switch::kOff || oracle_->gives_tracks()) return;
  if (frame.frame_idx % options_.relocalization.remember_every != 0) return;
  places_->See(frame.grey, map_.landmarks);
  std::vector<PointId> known;
  for (const Landmark& landmark : KnownLandmarks()) known.push_back(landmark.id);
  std::sort(known.begin(), known.end());
  places_->Keep(known);
}

// Those in sight and those that were lost.
std::vector<Landmark> Tracker::KnownLandmarks() const {
  std::vector<Landmark> known = map_.landmarks;
  const std::vector<Landmark> lost = lost_points_->landmarks();
  known.insert(known.end(), lost.begin(), lost.end());
  return known;
}

void Tracker::RememberLastView() {
  if (options_.relocalization.relocalize == Switch::kOn) places_->See(previous_.grey, map_.landmarks);
}

// Where the camera may be in this frame: where it was, and where it would be had it gone on as it went.
std::vector<Rigid3> Tracker::GuessPoses(int frame_idx) const {
  std::vector<Rigid3> guesses = {last_cam_from_world_};
  if (options_.relocalization.relocalize == Switch::kOff || recent_poses_.size() < 2) return guesses;
  const auto& [first_idx, first] = recent_poses_.front();
  const auto& [last_idx, last] = recent_poses_.back();
  const double frames = static_cast<double>(frame_idx - last_idx) / (last_idx - first_idx);
  guesses.insert(guesses.begin(), Repeated(last * first.Inverse(), frames) * last_cam_from_world_);
  return guesses;
}

// The points that are found from a guess, when enough of those that it should see agree; else none. The guess becomes
// the pose they agree on.
Tracker::Followed Tracker::FollowFrom(const TrackerFrame& frame, Rigid3* cam_from_world) {
  const RelocalizationOptions& options = options_.relocalization;
  losses_.clear();
  point_tracker_.Undo();
  Followed followed = FollowPoints(frame, PredictPixels(*cam_from_world));
  if (options.relocalize == Switch::kOff) return followed;
  const auto improve = [&] {
    const auto pose = EstimateCameraPose(camera_, followed.positions, followed.pixels, *cam_from_world, options_.pose);
    if (pose.ok()) *cam_from_world = pose->cam_from_world;
  };
  // Once more, from a better pose.
  if (static_cast<int>(followed.size()) >= options_.min_points) improve();
  losses_.clear();
  point_tracker_.Undo();
  const std::vector<PointPrediction> predictions = PredictPixels(*cam_from_world);
  followed = FollowPoints(frame, predictions);
  auto expected = std::count_if(predictions.begin(), predictions.end(),
                                [&](const PointPrediction& prediction) { return camera_.Contains(prediction.pixel); });
  if (options_.find_lost == Switch::kOn && !followed.in_blur) expected += FindLost(frame, *cam_from_world, &followed);
  if (static_cast<int>(followed.size()) < options_.min_points) return {};
  improve();
  const auto agree = std::ranges::count_if(std::views::iota(std::size_t{0}, followed.size()), [&](std::size_t k) {
    const auto pixel = camera_.Project(*cam_from_world * followed.positions[k]);
    return pixel && (*pixel - followed.pixels[k]).norm() <= options.max_error_px;
  });
  const bool confirmed =
      agree >= options_.min_points && static_cast<double>(agree) >= options.min_share * static_cast<double>(expected);
  return confirmed ? followed : Followed{};
}

Tracker::Followed Tracker::Relocalize(const TrackerFrame& frame, Rigid3* cam_from_world) {
  if (!Blankness(frame.grey).empty()) return {};
  for (const Rigid3& guess : GuessPoses(frame.frame_idx)) {
    *cam_from_world = guess;
    if (Followed followed = FollowFrom(frame, cam_from_world); followed.size() > 0) return followed;
  }
  if (options_.relocalization.relocalize == Switch::kOff) return {};
  const auto recognized = places_->Recognize(frame.grey, frame.mask, camera_, KnownLandmarks());
  if (!recognized.ok()) return {};
  *cam_from_world = recognized->cam_from_world;
  return FollowFrom(frame, cam_from_world);
}

// The present map changes places with another one.
void Tracker::Exchange(Submap* other) {
  std::swap(submap_, other->idx);
  std::swap(map_, other->map);
  std::swap(point_tracker_, other->point_tracker);
  std::swap(lost_points_, other->lost_points);
  std::swap(rigid_history_, other->rigid_history);
  std::swap(candidates_, other->candidates);
  std::swap(places_, other->places);
  std::swap(window_frames_, other->window_frames);
  std::swap(previous_, other->previous);
  std::swap(last_cam_from_world_, other->last_cam_from_world);
  std::swap(before_last_cam_from_world_, other->before_last_cam_from_world);
  std::swap(recent_poses_, other->recent_poses);
}

// The next map has its own world, unit and points.
void Tracker::LeaveMap() {
  auto next = std::make_unique<Submap>(options_.point_tracker);
  next->idx = static_cast<int>(left_.size()) + 1;
  next->lost_points = std::make_unique<LostPoints>();
  next->rigid_history = std::make_unique<RigidHistory>();
  next->candidates = std::make_unique<Candidates>(camera_, options_.growth);
  next->places = std::make_unique<Places>(options_.corners, options_.relocalization);
  Exchange(next.get());
  left_.push_back(std::move(next));
  lost_frames_ = 0;
  blurred_frames_ = 0;
  Apply(TrackingEvent::kMapLeft);
}

// While the present map is lost, or another one awaited, those that were left are looked for, the last one first. What
// there is of one that is awaited is let go of.
void Tracker::FindMapAgain(const TrackerFrame& frame) {
  if (state_ == TrackingState::kTracking || frame.frame_idx % options_.relocalization.seek_every != 0) return;
  for (std::size_t k = left_.size(); k-- > 0;) {
    Exchange(left_[k].get());
    Rigid3 cam_from_world;
    const bool found = Relocalize(frame, &cam_from_world).size() > 0;
    losses_.clear();
    point_tracker_.Undo();
    if (found) {
      if (state_ != TrackingState::kLost) left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(k));
      init_frames_.clear();
      lost_frames_ = 0;
      Apply(TrackingEvent::kMapFoundAgain);
      return;
    }
    Exchange(left_[k].get());
  }
}

}  // namespace pliant
