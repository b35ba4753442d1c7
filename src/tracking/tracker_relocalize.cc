// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The way back after the view was lost (docs/method.md, eq. R3): where the camera may be, and which of these guesses
// the image confirms.
#include <algorithm>
#include <utility>

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
  table.Add("max_left", &max_left, "-", "maps that were left and are remembered; memory grows with them", 1, 1000);
  table.AddChoice("join", &join,
                  "maps become one when a map that was left is found in the image of another; needs relocalize, "
                  "find_lost and adaptive patches, and no oracle");
  table.Add("join_every", &join_every, "frames",
            "while another map is tracked, one of those left is looked for so often", 1, 1000000);
  table.Add("max_unit_spread", &max_unit_spread, "-",
            "two maps are joined whose points agree on their units: median deviation of the ratio's logarithm", 0, 10);
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
  if (!current_->recent_poses.empty() && current_->recent_poses.back().first + 1 != frame.frame_idx)
    current_->recent_poses.clear();
  current_->recent_poses.emplace_back(frame.frame_idx, *report.cam_from_world);
  if (current_->recent_poses.size() > length) current_->recent_poses.erase(current_->recent_poses.begin());
  if (options_.relocalization.relocalize == Switch::kOff || oracle_->gives_tracks()) return;
  if (frame.frame_idx % options_.relocalization.remember_every != 0) return;
  current_->places.See(frame.gray, current_->map.landmarks);
  std::vector<PointId> known;
  for (const Landmark& landmark : KnownLandmarks()) known.push_back(landmark.id);
  std::sort(known.begin(), known.end());
  current_->places.Keep(known);
}

// Those in sight and those that were lost.
std::vector<Landmark> Tracker::KnownLandmarks() const {
  std::vector<Landmark> known = current_->map.landmarks;
  const std::vector<Landmark> lost = current_->lost_points.landmarks();
  known.insert(known.end(), lost.begin(), lost.end());
  return known;
}

void Tracker::RememberLastView() {
  if (options_.relocalization.relocalize == Switch::kOn)
    current_->places.See(current_->previous.gray, current_->map.landmarks);
}

// Where the camera may be in this frame: where it was, and where it would be had it gone on as it went.
std::vector<Rigid3> Tracker::GuessPoses(int frame_idx) const {
  std::vector<Rigid3> guesses = {current_->last_cam_from_world};
  if (options_.relocalization.relocalize == Switch::kOff || current_->recent_poses.size() < 2) return guesses;
  const auto& [first_idx, first] = current_->recent_poses.front();
  const auto& [last_idx, last] = current_->recent_poses.back();
  const double frames = static_cast<double>(frame_idx - last_idx) / (last_idx - first_idx);
  guesses.insert(guesses.begin(), Repeated(last * first.Inverse(), frames) * current_->last_cam_from_world);
  return guesses;
}

// The points that are found from a guess, when enough of those that it should see agree; else none. The guess becomes
// the pose they agree on.
Tracker::Followed Tracker::FollowFrom(const TrackerFrame& frame, Rigid3* cam_from_world) {
  const RelocalizationOptions& options = options_.relocalization;
  losses_.clear();
  current_->point_tracker.Undo();
  Followed followed = FollowPoints(frame, PredictPixels(*cam_from_world));
  if (options.relocalize == Switch::kOff) return followed;
  const auto improve = [&] {
    const auto pose = EstimateCameraPose(camera_, followed.positions, followed.pixels, *cam_from_world, options_.pose);
    if (pose.ok()) *cam_from_world = pose->cam_from_world;
  };
  // Once more, from a better pose.
  if (static_cast<int>(followed.size()) >= options_.min_points) improve();
  losses_.clear();
  current_->point_tracker.Undo();
  const std::vector<PointPrediction> predictions = PredictPixels(*cam_from_world);
  followed = FollowPoints(frame, predictions);
  auto expected = std::count_if(predictions.begin(), predictions.end(),
                                [&](const PointPrediction& prediction) { return camera_.Contains(prediction.pixel); });
  if (options_.find_lost == Switch::kOn && !followed.in_blur) expected += FindLost(frame, *cam_from_world, &followed);
  if (static_cast<int>(followed.size()) < options_.min_points) return {};
  improve();
  int agree = 0;
  for (std::size_t k = 0; k < followed.size(); ++k) {
    const auto pixel = camera_.Project(*cam_from_world * followed.positions[k]);
    if (pixel && (*pixel - followed.pixels[k]).norm() <= options.max_error_px) ++agree;
  }
  const bool confirmed =
      agree >= options_.min_points && static_cast<double>(agree) >= options.min_share * static_cast<double>(expected);
  return confirmed ? followed : Followed{};
}

Tracker::Followed Tracker::Relocalize(const TrackerFrame& frame, Rigid3* cam_from_world) {
  if (!Blankness(frame.gray).empty()) return {};
  for (const Rigid3& guess : GuessPoses(frame.frame_idx)) {
    *cam_from_world = guess;
    if (Followed followed = FollowFrom(frame, cam_from_world); followed.size() > 0) return followed;
  }
  if (options_.relocalization.relocalize == Switch::kOff) return {};
  if (described_ == nullptr)
    described_ =
        std::make_unique<DescribedImage>(Describe(frame.gray, frame.mask, options_.corners, options_.relocalization));
  const auto recognized = current_->places.Recognize(*described_, camera_, KnownLandmarks());
  if (!recognized.ok()) return {};
  *cam_from_world = recognized->cam_from_world;
  return FollowFrom(frame, cam_from_world);
}

// The next map has its own world, unit and points.
void Tracker::LeaveMap() {
  auto next = std::make_unique<Submap>(maps_made_, camera_, options_);
  inactive_submaps_.push_back(std::exchange(current_, std::move(next)));
  if (static_cast<int>(inactive_submaps_.size()) > options_.relocalization.max_left)
    inactive_submaps_.erase(inactive_submaps_.begin());
  lost_frames_ = 0;
  blurred_frames_ = 0;
  Apply(TrackingEvent::kMapLeft);
}

// The points of a map that was left in this image, and its camera's pose; the map stays as it was.
Tracker::Followed Tracker::LookFor(std::unique_ptr<Submap>* left, const TrackerFrame& frame, Rigid3* cam_from_world) {
  std::swap(current_, *left);
  Followed followed = Relocalize(frame, cam_from_world);
  losses_.clear();
  current_->point_tracker.Undo();
  std::swap(current_, *left);
  return followed;
}

// While the present map is lost, or another one awaited, those that were left are looked for, the last one first. What
// there is of one that is awaited is let go of.
void Tracker::FindMapAgain(const TrackerFrame& frame) {
  if (state_ == TrackingState::kTracking || frame.frame_idx % options_.relocalization.seek_every != 0) return;
  for (std::size_t k = inactive_submaps_.size(); k-- > 0;) {
    Rigid3 cam_from_world;
    if (LookFor(&inactive_submaps_[k], frame, &cam_from_world).size() == 0) continue;
    std::swap(current_, inactive_submaps_[k]);
    if (state_ != TrackingState::kLost)
      inactive_submaps_.erase(inactive_submaps_.begin() + static_cast<std::ptrdiff_t>(k));
    init_frames_.clear();
    lost_frames_ = 0;
    Apply(TrackingEvent::kMapFoundAgain);
    return;
  }
}

}  // namespace pliant
