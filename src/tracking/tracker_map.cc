// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How the map changes between frames: refined while the scene is rigid, grown where the image shows more, and made anew
// from time to time.
#include <algorithm>
#include <utility>

#include "pliant/image/brightness.h"
#include "pliant/tracking/tracker.h"
#include "tracking/candidates.h"
#include "tracking/lost_points.h"
#include "tracking/map_remaker.h"
#include "tracking/oracle_answers.h"
#include "tracking/replace_map.h"
#include "tracking/rigid_history.h"
#include "tracking/slid_points.h"
#include "tracking/submap.h"
#include "tracking/tracker_support.h"

namespace pliant {
namespace {

constexpr int kSettled = 3;  // maps made anew that had a landmark: another one says little that is new

}  // namespace

void Tracker::DropFromMap(PointId id, FrameReport* report) {
  current_->point_tracker.Remove(id);
  std::erase_if(current_->map.landmarks, [&](const Landmark& landmark) { return landmark.id == id; });
  std::erase_if(report->observations, [&](const PointObservation& seen) { return seen.id == id; });
  report->optimized = static_cast<int>(report->observations.size());
}

// Points that contradict the others over the frames of which the map was made again.
void Tracker::DropContradicting(const InitOutcome& outcome, FrameReport* report) {
  for (const InitRejectedPoint& rejected : outcome.rejected)
    if (rejected.reason == InitRejection::kReprojection && current_->map.Find(rejected.id) != nullptr) {
      Count(InitRejectionName(rejected.reason), 1);
      DropFromMap(rejected.id, report);
    }
}

// Points of the map that slid, by its points made anew; these become those that are left (G6).
void Tracker::DropSlid(std::vector<InitPosition>* remade, FrameReport* report) {
  const auto slid = SlidPoints(*remade, current_->last_cam_from_world, current_->map, options_.growth.max_depth_change);
  for (const PointId id : slid) {
    DropFromMap(id, report);
    std::erase_if(*remade, [&](const InitPosition& point) { return point.id == id; });
  }
  Count("slid", static_cast<int>(slid.size()));
}

// While the scene is rigid (W13).
void Tracker::RefineMap(FrameReport* report) {
  if (current_->rigid_history.empty()) return;
  const StageTimer timer(report, "initialize");
  InitFrame frame{report->frame_idx, {}};
  for (const PointObservation& seen : report->observations)
    frame.observations.push_back({.id = seen.id, .pixel = seen.pixel, .ssim = seen.ssim});
  if (!current_->rigid_history.Add(std::move(frame))) return;
  const InitOutcome outcome = remaker_->Remake(
      {camera_, current_->rigid_history.frames(), {}, InitMoment::kMoreFollow, threads_, {}, photometric_},
      WindowScene::kRigid);
  if (outcome.decision == InitDecision::kNewReference) {
    current_->rigid_history.Stop();
    report->note = "the map is not refined any more: " + outcome.reason;
  }
  if (outcome.decision != InitDecision::kMap) return;
  DropContradicting(outcome, report);
  const Map before = current_->map;
  const auto cam_from_world =
      ReplaceMap(outcome, current_->last_cam_from_world, &current_->map, &report->refined_points);
  if (!cam_from_world) return;
  current_->candidates.TakeCorrection(before, current_->map);
  current_->before_last_cam_from_world =
      current_->before_last_cam_from_world * current_->last_cam_from_world.Inverse() * *cam_from_world;
  current_->last_cam_from_world = *cam_from_world;
  report->cam_from_world = cam_from_world;
  for (PointObservation& seen : report->observations) seen.position = current_->map.Find(seen.id)->position;
  report->median_reprojection_error_px = MedianReprojectionErrorPx(camera_, *cam_from_world, report->observations);
  report->note = "the map was refined: " + outcome.reason;
}

// Tracks from the truth are those of the map's points; a camera that stands still tells nothing of a new one's depth.
bool Tracker::GrowsMap() const {
  return options_.growth.grow == Switch::kOn && options_.camera_motion == CameraMotion::kFree &&
         !oracle_->gives_tracks();
}

// Candidates are followed with the pose and the deformation that the map has given; those that are certain enter it.
void Tracker::GrowMap(const TrackerFrame& frame, FrameReport* report) {
  if (!GrowsMap()) return;
  {
    const StageTimer timer(report, "photometric");
    FollowCandidates(frame);
  }
  const StageTimer timer(report, "initialize");
  for (const auto& [id, position] : current_->candidates.Certain(current_->last_cam_from_world, current_->map))
    Promote(id, position, report);
  RemakeMap(frame, report);
  const bool half_full = 2 * current_->map.landmarks.size() >= static_cast<std::size_t>(options_.corners.max_corners);
  if (frame.frame_idx % (half_full ? 2 * options_.growth.every : options_.growth.every) == 0) LookForCandidates(frame);
}

void Tracker::FollowCandidates(const TrackerFrame& frame) {
  const std::vector<PointPrediction> predictions = current_->candidates.Predict(current_->last_cam_from_world);
  for (const PointTrack& track : current_->point_tracker.Track(current_->previous.pyramid, current_->previous.mask,
                                                               frame.pyramid, frame.mask, predictions, threads_)) {
    if (track.failure == PatchFailure::kNone &&
        current_->candidates.See(track, current_->last_cam_from_world, current_->map))
      continue;
    current_->candidates.Remove(track.id);
    current_->point_tracker.Remove(track.id);
  }
}

// A candidate becomes a point of the map.
void Tracker::Promote(PointId id, const Eigen::Vector3d& position, FrameReport* report) {
  const auto landmark = current_->candidates.AsLandmark(id, position, current_->map);
  if (!landmark) return;
  const CandidateTrack& track = current_->candidates.track(id);
  const auto insert = [](auto& sorted, auto element) {
    const auto place = std::upper_bound(sorted.begin(), sorted.end(), element,
                                        [](const auto& a, const auto& b) { return a.id < b.id; });
    sorted.insert(place, element);
  };
  insert(report->new_points, NewPoint{id, landmark->rest_position, track.rgb});
  insert(report->observations, PointObservation{id, track.pixel, landmark->position, track.ssim});
  insert(current_->map.landmarks, *landmark);
  ++report->tracked;
  ++report->optimized;
  ++report->added;
  current_->candidates.Remove(id);
}

// Corners where there is neither a point of the map, nor a candidate, nor a lost point.
void Tracker::LookForCandidates(const TrackerFrame& frame) {
  const auto room =
      options_.corners.max_corners - static_cast<int>(current_->map.landmarks.size() + current_->candidates.size());
  if (room <= 0) return;
  std::vector<Eigen::Vector2d> taken = current_->lost_points.Pixels(camera_, current_->last_cam_from_world);
  for (const Landmark& landmark : current_->map.landmarks) taken.push_back(landmark.pixel);
  for (const CandidateTrack& track : current_->candidates.tracks()) taken.push_back(track.pixel);
  CornerOptions corners = options_.corners;
  corners.max_corners = room;
  for (const Corner& corner : DetectCorners(frame.gray, frame.mask.valid(), taken, corners)) {
    const PointId id{next_id_};
    if (current_->point_tracker.Add(id, corner.pixel, frame.pyramid, frame.mask) != PatchFailure::kNone) continue;
    ++next_id_;
    if (!current_->candidates.Add({id, corner.pixel, 1.0, ColorAt(frame.image, corner.pixel)},
                                  current_->last_cam_from_world, current_->map))
      current_->point_tracker.Remove(id);
  }
}

// From the pixels of the last frames alone, so that no error of the map outlives them (G5).
void Tracker::RemakeMap(const TrackerFrame& frame, FrameReport* report) {
  const auto length = static_cast<std::size_t>(options_.growth.window);
  if (length == 0) return;
  const LocalBrightness brightness(frame.image, frame.mask.valid());
  InitFrame seen{frame.frame_idx, {}};
  for (const PointObservation& point : report->observations)
    seen.observations.push_back({point.id, point.pixel, point.ssim, brightness.At(point.pixel)});
  for (const CandidateTrack& track : current_->candidates.tracks())
    seen.observations.push_back({track.id, track.pixel, track.ssim, brightness.At(track.pixel)});
  std::sort(seen.observations.begin(), seen.observations.end(),
            [](const InitObservation& a, const InitObservation& b) { return a.id < b.id; });
  current_->window_frames.push_back(std::move(seen));
  if (current_->window_frames.size() > length + 1)
    current_->window_frames.erase(current_->window_frames.begin(),
                                  current_->window_frames.end() - static_cast<std::ptrdiff_t>(length + 1));
  const int every = options_.growth.remake_every;
  if (current_->window_frames.size() <= length || !current_->rigid_history.empty() || frame.frame_idx % every != 0)
    return;
  const auto in_view = static_cast<double>(report->observations.size());
  const auto count = [&](const auto& is_so) {
    return static_cast<double>(
        std::count_if(report->observations.begin(), report->observations.end(),
                      [&](const PointObservation& point) { return is_so(*current_->map.Find(point.id)); }));
  };
  if (count([](const Landmark& landmark) { return landmark.measured; }) >= options_.growth.max_measured_share * in_view)
    return;
  const double settled = count([](const Landmark& landmark) { return landmark.times_remade >= kSettled; });
  if (settled > 0.5 * in_view && frame.frame_idx % (2 * every) != 0) return;
  const InitOutcome outcome = remaker_->Remake(
      {camera_, current_->window_frames, {}, InitMoment::kMoreFollow, threads_, {}, photometric_}, WindowScene::kAny);
  if (outcome.decision != InitDecision::kMap) return;
  std::vector<InitPosition> positions = RemadePositions(outcome, current_->last_cam_from_world, current_->map);
  if (positions.empty()) return;
  DropContradicting(outcome, report);
  DropSlid(&positions, report);
  WeighWithBefore(current_->last_cam_from_world, current_->map, options_.growth.remade_weight, &positions);
  const Map before = current_->map;
  for (const InitPosition& point : positions)
    if (Landmark* landmark = current_->map.Find(point.id); landmark != nullptr) {
      landmark->rest_position += point.position - landmark->position;
      landmark->position = point.position;
      ++landmark->times_remade;
      report->refined_points.push_back({landmark->id, landmark->rest_position});
    }
  current_->candidates.TakeCorrection(before, current_->map);
  for (const InitPosition& point : positions)
    if (current_->map.Find(point.id) == nullptr) Promote(point.id, point.position, report);
  for (PointObservation& point : report->observations) point.position = current_->map.Find(point.id)->position;
  report->note = "the map was made anew: " + outcome.reason;
}

}  // namespace pliant
