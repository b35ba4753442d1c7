// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/map_upkeep/map_updater.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "pliant/image/brightness.h"
#include "tracking/depth_prior/prior_distances.h"
#include "tracking/map_upkeep/common_motion.h"
#include "tracking/map_upkeep/drifted_points.h"
#include "tracking/map_upkeep/reestimate_map.h"
#include "tracking/map_upkeep/replace_map.h"

namespace pliant {
namespace {

constexpr int kWellKnown = 3;  // re-estimated maps that had a landmark: another one adds little

template <class Element>
void InsertById(std::vector<Element>* sorted, Element element) {
  const auto position = std::ranges::upper_bound(*sorted, element.id, {}, &Element::id);
  sorted->insert(position, std::move(element));
}

}  // namespace

MapUpdater::MapUpdater(const Camera& camera, const TrackerOptions& options, int threads,
                       const std::optional<PhotometricCalibration>& photometric, TrackSource* tracks)
    : camera_(camera), options_(options), threads_(threads), photometric_(photometric), tracks_(tracks) {}

// A camera that stands still tells nothing of a new point's depth.
bool MapUpdater::GrowsMap() const {
  return options_.growth.grow == Switch::kOn && options_.camera_motion == CameraMotion::kFree &&
         tracks_->abilities().adds_points;
}

bool MapUpdater::EstimatesPoses() const {
  return options_.camera_motion == CameraMotion::kFree && options_.oracle.poses == Switch::kOff;
}

InitOutcome MapUpdater::Reestimate(const std::vector<InitFrame>& frames, WindowScene scene) const {
  return ReestimateMap({camera_, frames, {}, InitMoment::kMoreFollow, threads_, {}, photometric_}, scene,
                       options_.init.window, options_.init.monocular.nominal_depth_mm);
}

void MapUpdater::Start(FirstMap first, Submap* submap) const {
  const InitOutcome& outcome = first.outcome;
  submap->map = MakeFirstMap(first);
  submap->provisional = outcome.provisional;
  submap->depth_sigma = outcome.measured.median_depth_sigma;
  for (Landmark& landmark : submap->map.landmarks)
    landmark.measured = options_.init.IsMetric() || options_.oracle.first_map == Switch::kOn;
  submap->last_cam_from_world = outcome.frames.back().cam_from_world;
  submap->before_last_cam_from_world = outcome.frames.size() >= 2
                                           ? outcome.frames[outcome.frames.size() - 2].cam_from_world
                                           : submap->last_cam_from_world;
  for (const InitPoint& point : outcome.points)
    if (submap->map.Find(point.id) == nullptr) tracks_->Remove(point.id);
  for (const InitRejectedPoint& rejected : outcome.rejected) {
    const InitObservation* seen = FindById(first.frames.back().observations, rejected.id);
    const bool uncertain =
        rejected.reason == InitRejection::kUncertainDepth || rejected.reason == InitRejection::kTooFewViews;
    if (!GrowsMap() || !uncertain || seen == nullptr ||
        !submap->candidates.Add({seen->id, seen->pixel, seen->ssim, seen->rgb}, submap->last_cam_from_world,
                                submap->map))
      tracks_->Remove(rejected.id);
  }
  submap->window_frames = first.frames;
  if (outcome.refinable && EstimatesPoses()) submap->rigid_history.Start(std::move(first.frames));
}

void MapUpdater::RemoveCommonMotion(Submap* submap) const {
  if (EstimatesPoses() && options_.common_motion_share > 0)
    submap->MoveAllButRest(CommonMotionToRest(submap->map, options_.common_motion_share));
}

MapUpdate MapUpdater::Update(const PreparedFrame& frame, Submap* submap, StageTimes* times) const {
  MapUpdate update;
  if (!submap->rigid_history.empty()) {
    const StageTimer timer(times, Stage::kInitialize);
    RefineRigid(frame.frame_idx, submap, &update);
  }
  if (GrowsMap()) Grow(frame, submap, times, &update);
  return update;
}

// While the scene is rigid (W13).
void MapUpdater::RefineRigid(int frame_idx, Submap* submap, MapUpdate* update) const {
  InitFrame frame{frame_idx, {}};
  for (const Landmark& seen : submap->map.landmarks)
    frame.observations.push_back({.id = seen.id, .pixel = seen.pixel, .ssim = seen.ssim});
  if (!submap->rigid_history.Add(std::move(frame))) return;
  const InitOutcome outcome = Reestimate(submap->rigid_history.frames(), WindowScene::kRigid);
  if (outcome.decision == InitDecision::kNewReference) {
    submap->rigid_history.Stop();
    update->note = "the map is not refined any more: " + outcome.reason;
  }
  if (outcome.decision != InitDecision::kMap) return;
  RejectReprojectionOutliers(outcome, submap, &update->losses);
  const Map before = submap->map;
  const auto cam_from_world = ReplaceMap(outcome, submap->last_cam_from_world, &submap->map, &update->refined_points);
  if (!cam_from_world) return;
  submap->candidates.TakeCorrection(before, submap->map);
  submap->before_last_cam_from_world =
      submap->before_last_cam_from_world * submap->last_cam_from_world.Inverse() * *cam_from_world;
  submap->last_cam_from_world = *cam_from_world;
  update->median_reprojection_error_px = MedianReprojectionErrorPx(camera_, *cam_from_world, submap->Observations());
  if (!outcome.provisional) submap->provisional = false;
  update->note = "the map was refined: " + outcome.reason;
}

// Candidates are followed with the pose and the deformation that the map has given; those that are certain enter it.
void MapUpdater::Grow(const PreparedFrame& frame, Submap* submap, StageTimes* times, MapUpdate* update) const {
  {
    const StageTimer timer(times, Stage::kPhotometric);
    FollowCandidates(frame, submap);
  }
  const StageTimer timer(times, Stage::kInitialize);
  for (const Candidates::CertainPoint& point :
       submap->candidates.Certain(submap->last_cam_from_world, submap->map, submap->depth_sigma))
    Promote(point, submap, update);
  if (options_.growth.window > 0) {
    RememberWindow(frame, submap);
    if (IsReestimationDue(frame.frame_idx, *submap)) ReestimateAny(submap, update);
  }
  const bool half_full = 2 * submap->map.landmarks.size() >= static_cast<std::size_t>(options_.corners.max_corners);
  const int every = half_full ? 2 * options_.growth.every : options_.growth.every;
  if (tracks_->abilities().adds_always || frame.frame_idx % every == 0) AddCandidates(frame, submap);
}

void MapUpdater::FollowCandidates(const PreparedFrame& frame, Submap* submap) const {
  const std::vector<PointPrediction> predictions = submap->candidates.Predict(submap->last_cam_from_world);
  std::vector<PointId> seen;
  for (const PointTrack& track : tracks_->Track(submap->previous, frame, predictions)) {
    if (track.failure == PatchFailure::kNone &&
        submap->candidates.AddView(track, submap->last_cam_from_world, submap->map)) {
      seen.push_back(track.id);
    } else {
      submap->candidates.Remove(track.id);
      tracks_->Remove(track.id);
    }
  }
  tracks_->Keep(seen);
}

// New points where there is neither a point of the map, nor a candidate, nor a lost point.
void MapUpdater::AddCandidates(const PreparedFrame& frame, Submap* submap) const {
  const auto wanted =
      options_.corners.max_corners - static_cast<int>(submap->map.landmarks.size() + submap->candidates.size());
  if (wanted <= 0) return;
  std::vector<Eigen::Vector2d> occupied = submap->lost_points.Pixels(camera_, submap->last_cam_from_world);
  for (const Landmark& landmark : submap->map.landmarks) occupied.push_back(landmark.pixel);
  for (const CandidateTrack& track : submap->candidates.tracks()) occupied.push_back(track.pixel);
  CornerOptions corners = options_.corners;
  corners.max_corners = wanted;
  for (const NewTrack& track : tracks_->AddNew(frame, occupied, corners))
    if (!submap->candidates.Add({track.id, track.pixel, 1.0, ColorAt(frame.image, track.pixel)},
                                submap->last_cam_from_world, submap->map))
      tracks_->Remove(track.id);
}

// A candidate becomes a landmark.
void MapUpdater::Promote(const Candidates::CertainPoint& point, Submap* submap, MapUpdate* update) const {
  const auto landmark = submap->candidates.AsLandmark(point, submap->last_cam_from_world, submap->map);
  if (!landmark) return;
  InsertById(&update->new_points, {point.id, landmark->rest_position, submap->candidates.track(point.id).rgb});
  InsertById(&submap->map.landmarks, *landmark);
  submap->candidates.Remove(point.id);
}

// The pixels of this frame, for the next re-estimation.
void MapUpdater::RememberWindow(const PreparedFrame& frame, Submap* submap) const {
  const LocalBrightness brightness(frame.image, frame.mask.valid());
  PriorDistances prior(frame, camera_, options_.depth_prior);
  const bool aligned = prior.AlignTo(submap->map, submap->last_cam_from_world);
  InitFrame seen{frame.frame_idx, {}};
  const auto see = [&](PointId id, const Eigen::Vector2d& pixel, double ssim) {
    seen.observations.push_back({.id = id,
                                 .pixel = pixel,
                                 .ssim = ssim,
                                 .brightness = brightness.At(pixel),
                                 .log_prior = aligned ? prior.LogAt(pixel) : std::numeric_limits<double>::quiet_NaN()});
  };
  for (const Landmark& landmark : submap->map.landmarks) see(landmark.id, landmark.pixel, landmark.ssim);
  for (const CandidateTrack& track : submap->candidates.tracks()) see(track.id, track.pixel, track.ssim);
  std::ranges::sort(seen.observations, {}, &InitObservation::id);
  std::vector<InitFrame>& frames = submap->window_frames;
  frames.push_back(std::move(seen));
  const auto length = static_cast<std::size_t>(options_.growth.window) + 1;
  if (frames.size() > length) frames.erase(frames.begin(), frames.end() - static_cast<std::ptrdiff_t>(length));
}

bool MapUpdater::IsReestimationDue(int frame_idx, const Submap& submap) const {
  const int every = options_.growth.reestimate_every;
  if (submap.window_frames.size() <= static_cast<std::size_t>(options_.growth.window) ||
      !submap.rigid_history.empty() || frame_idx % every != 0)
    return false;
  const std::vector<Landmark>& landmarks = submap.map.landmarks;
  const auto in_view = static_cast<double>(landmarks.size());
  const auto measured = static_cast<double>(std::ranges::count(landmarks, true, &Landmark::measured));
  if (measured >= options_.growth.max_measured_share * in_view) return false;
  const auto well_known = static_cast<double>(std::ranges::count_if(
      landmarks, [](const Landmark& landmark) { return landmark.times_reestimated >= kWellKnown; }));
  return !(well_known > 0.5 * in_view) || frame_idx % (2 * every) == 0;
}

// From the pixels of the last frames alone, so that no error of the map outlives them (G5).
void MapUpdater::ReestimateAny(Submap* submap, MapUpdate* update) const {
  const InitOutcome outcome = Reestimate(submap->window_frames, WindowScene::kAny);
  if (outcome.decision != InitDecision::kMap) return;
  std::vector<InitPosition> positions = ReestimatedPositions(outcome, submap->last_cam_from_world, submap->map);
  if (positions.empty()) return;
  RejectReprojectionOutliers(outcome, submap, &update->losses);
  RejectDrifted(&positions, submap, &update->losses);
  AverageWithBefore(submap->last_cam_from_world, submap->map, options_.growth.min_reestimation_weight, &positions);
  const Map before = submap->map;
  for (const InitPosition& point : positions)
    if (Landmark* landmark = submap->map.Find(point.id); landmark != nullptr) {
      landmark->rest_position += point.position - landmark->position;
      landmark->position = point.position;
      ++landmark->times_reestimated;
      landmark->from_surface = false;
      update->refined_points.push_back({landmark->id, landmark->rest_position});
    }
  submap->candidates.TakeCorrection(before, submap->map);
  for (const InitPosition& point : positions)
    if (submap->map.Find(point.id) == nullptr) Promote({point.id, point.position}, submap, update);
  if (!outcome.provisional && 2 * positions.size() >= submap->map.landmarks.size()) submap->provisional = false;
  update->note = "the map was re-estimated: " + outcome.reason;
}

void MapUpdater::Remove(PointId id, Submap* submap) const {
  tracks_->Remove(id);
  std::erase_if(submap->map.landmarks, [&](const Landmark& landmark) { return landmark.id == id; });
}

// Points that contradict the others over the frames from which the map was re-estimated.
void MapUpdater::RejectReprojectionOutliers(const InitOutcome& outcome, Submap* submap, LossCounts* losses) const {
  for (const InitRejectedPoint& rejected : outcome.rejected)
    if (rejected.reason == InitRejection::kReprojection && submap->map.Find(rejected.id) != nullptr) {
      losses->Add(InitRejectionName(rejected.reason), 1);
      Remove(rejected.id, submap);
    }
}

// Points of the map that drifted along a contour (G6); the re-estimated points become those that are left.
void MapUpdater::RejectDrifted(std::vector<InitPosition>* reestimated, Submap* submap, LossCounts* losses) const {
  const auto drifted =
      DriftedPoints(*reestimated, submap->last_cam_from_world, submap->map, options_.growth.max_depth_change);
  for (const PointId id : drifted) {
    Remove(id, submap);
    std::erase_if(*reestimated, [&](const InitPosition& point) { return point.id == id; });
  }
  losses->Add("drifted", static_cast<int>(drifted.size()));
}

}  // namespace pliant
