// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/map_upkeep/map_updater.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "pliant/estimation/pose/camera_pose.h"
#include "pliant/image/brightness.h"
#include "tracking/depth_prior/prior_agreement.h"
#include "tracking/depth_prior/prior_distances.h"
#include "tracking/map_upkeep/common_motion.h"
#include "tracking/map_upkeep/drifted_points.h"
#include "tracking/map_upkeep/reestimate_map.h"
#include "tracking/serialize.h"

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

// From frames of which the last is the present one.
void MapUpdater::Reestimate(const std::vector<InitFrame>& frames, WindowScene scene, const Submap& submap) {
  // What is under way corrects the same map: another one would correct it once more.
  if (!reestimations_.IsEmpty()) return;
  Reestimation reestimation{scene, {submap.map, submap.last_cam_from_world}};
  const bool beside = threads_ > 1 && options_.handover_frames > 0;
  // Only what was compared with one constant depth can be compared with another map.
  const bool of_provisional = submap.provisional && submap.depths.signal > 0.0;
  // To refine a rigid map takes much less time, and every frame without it is tracked with a worse one.
  const int delay = scene == WindowScene::kRigid ? (options_.handover_frames + 2) / 3 : options_.handover_frames;
  reestimations_.Ask(updates_ + delay, beside ? WorkPlace::kBeside : WorkPlace::kHere,
                     [this, frames, of_provisional, made = std::move(reestimation)]() mutable {
                       made.outcome = ReestimateMap(
                           {camera_, frames, {}, InitMoment::kMoreFollow, threads_, {}, photometric_}, made.scene,
                           of_provisional, options_.init.window, options_.init.monocular.nominal_depth_mm);
                       return std::move(made);
                     });
}

void MapUpdater::TakeReestimations(Submap* submap, MapUpdate* update) {
  const bool waits = options_.handover_waits == Switch::kOn;
  while (const auto made = waits ? reestimations_.Take(updates_) : reestimations_.TakeIfThere(updates_)) {
    if (made->scene == WindowScene::kRigid)
      TakeRigid(*made, submap, update);
    else
      TakeAny(*made, submap, update);
  }
}

void MapUpdater::Start(FirstMap first, Submap* submap) {
  Forget();
  const InitOutcome& outcome = first.outcome;
  submap->map = MakeFirstMap(first);
  submap->provisional = outcome.provisional;
  submap->depths = {.sigma = outcome.measured.median_depth_sigma, .signal = outcome.measured.DepthSignal()};
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
        !submap->candidates.Add({seen->id, seen->pixel, seen->ssim, seen->rgb, true}, submap->last_cam_from_world,
                                submap->map))
      tracks_->Remove(rejected.id);
  }
  submap->window_frames = first.frames;
  // What (W19) takes for rigid is known to deform.
  const bool may_be_rigid = outcome.refinable && !outcome.allows_deformation;
  if (may_be_rigid && EstimatesPoses()) submap->rigid_history.Start(std::move(first.frames));
}

void MapUpdater::RemoveCommonMotion(Submap* submap) const {
  if (EstimatesPoses() && options_.common_motion_share > 0)
    submap->MoveAllButRest(CommonMotionToRest(submap->map, options_.common_motion_share));
}

void MapUpdater::KeepFollowed(const InitFrame& present, Submap* submap) const {
  const auto is_lost = [&](PointId id) { return FindById(present.observations, id) == nullptr; };
  std::erase_if(submap->map.landmarks, [&](const Landmark& landmark) { return is_lost(landmark.id); });
  for (const CandidateTrack& track : submap->candidates.tracks())
    if (is_lost(track.id)) submap->candidates.Remove(track.id);
}

void MapUpdater::AddFollowed(const InitFrame& frame, Submap* submap) const {
  for (const CandidateTrack& track : submap->candidates.tracks()) {
    const InitObservation* seen = FindById(frame.observations, track.id);
    const bool is_kept =
        seen != nullptr && submap->candidates.AddView({.id = seen->id, .pixel = seen->pixel, .ssim = seen->ssim},
                                                      submap->last_cam_from_world, submap->map);
    if (!is_kept) submap->candidates.Remove(track.id);
  }
  // A refinement that is due here comes later: the next frames of the map have to be reached first.
  if (!submap->rigid_history.empty()) AddToRigidHistory(frame.frame_idx, submap);
  if (options_.growth.window > 0) AddToWindow(frame, submap);
}

void MapUpdater::AdoptFollowed(const InitFrame& known, const InitFrame& present, Submap* submap) const {
  for (const InitObservation& seen : present.observations) {
    if (submap->map.Find(seen.id) != nullptr || submap->candidates.Pixel(seen.id) != nullptr) continue;
    const bool is_rejected = FindById(known.observations, seen.id) != nullptr;
    if (is_rejected || !GrowsMap() ||
        !submap->candidates.Add({seen.id, seen.pixel, seen.ssim, seen.rgb, true}, submap->last_cam_from_world,
                                submap->map))
      tracks_->Remove(seen.id);
  }
}

MapUpdate MapUpdater::Update(const PreparedFrame& frame, Submap* submap, StageTimes* times) {
  MapUpdate update;
  ++updates_;
  if (!submap->rigid_history.empty()) {
    const StageTimer timer(times, Stage::kInitialize);
    if (AddToRigidHistory(frame.frame_idx, submap))
      Reestimate(submap->rigid_history.frames(), WindowScene::kRigid, *submap);
    TakeReestimations(submap, &update);
  }
  if (GrowsMap()) Grow(frame, submap, times, &update);
  if (!frame.depth_prior.empty()) {
    const StageTimer timer(times, Stage::kInitialize);
    ComparePrior(frame, *submap, &update.prior);
  }
  return update;
}

// (N4) A map that was started from the prior agrees with it, right or wrong: what else there is says brightness, or
// points that were re-estimated since.
void MapUpdater::ComparePrior(const PreparedFrame& frame, const Submap& submap, FramePrior* prior) const {
  const PriorDistances distances(frame, camera_, options_.depth_prior);
  const bool is_of_prior = options_.init.method == InitMethod::kDepthPrior;
  std::vector<Landmark> landmarks = submap.map.landmarks;
  if (is_of_prior && options_.init.window.light == Switch::kOn) {
    prior->by_brightness = true;
    prior->agreement =
        AgreementWithBrightness(distances, camera_, landmarks, LocalBrightness(frame.image, frame.mask.valid()),
                                photometric_.value_or(PhotometricCalibration{.gamma = options_.init.window.gamma}));
    return;
  }
  if (is_of_prior) std::erase_if(landmarks, [](const Landmark& landmark) { return landmark.times_reestimated == 0; });
  prior->agreement = AgreementWithMap(distances, camera_, landmarks, submap.last_cam_from_world);
}

// Whether the map of a rigid scene is to be refined now; the history takes this frame.
bool MapUpdater::AddToRigidHistory(int frame_idx, Submap* submap) const {
  InitFrame frame{frame_idx, {}};
  for (const Landmark& seen : submap->map.landmarks)
    frame.observations.push_back({.id = seen.id, .pixel = seen.pixel, .ssim = seen.ssim});
  return submap->rigid_history.Add(std::move(frame));
}

// Of a rigid scene (W13).
void MapUpdater::TakeRigid(const Reestimation& reestimation, Submap* submap, MapUpdate* update) const {
  const auto& [scene, then, outcome] = reestimation;
  if (submap->rigid_history.empty()) return;
  if (outcome.decision == InitDecision::kNewReference) {
    submap->rigid_history.Stop();
    if (outcome.deforming) submap->BecomeProvisional();
    update->note = "the map is not refined any more: " + outcome.reason;
  }
  if (outcome.decision != InitDecision::kMap) return;
  RejectReprojectionOutliers(outcome, submap, &update->losses);
  if (!ReplaceMap(outcome, then, submap, &update->refined_points)) return;
  submap->depths.signal = outcome.measured.DepthSignal();
  const Rigid3 cam_from_world = PoseInReplaced(*submap);
  submap->before_last_cam_from_world =
      submap->before_last_cam_from_world * submap->last_cam_from_world.Inverse() * cam_from_world;
  submap->last_cam_from_world = cam_from_world;
  update->median_reprojection_error_px = MedianReprojectionErrorPx(camera_, cam_from_world, submap->Observations());
  if (!outcome.provisional) submap->provisional = false;
  update->prior.is_used |= outcome.uses_prior;
  update->note = "the map was refined: " + outcome.reason;
}

// The camera of the present frame in a map that was replaced: where it was moved with the map of an earlier frame, it
// is estimated again.
Rigid3 MapUpdater::PoseInReplaced(const Submap& submap) const {
  if (options_.handover_frames == 0) return submap.last_cam_from_world;
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector2d> pixels;
  for (const Landmark& landmark : submap.map.landmarks) {
    positions.push_back(landmark.position);
    pixels.push_back(landmark.pixel);
  }
  const auto estimate = EstimateCameraPose(camera_, positions, pixels, submap.last_cam_from_world, options_.pose);
  return estimate.ok() ? estimate->cam_from_world : submap.last_cam_from_world;
}

// Candidates are followed with the pose and the deformation that the map has given; those that are certain enter it.
void MapUpdater::Grow(const PreparedFrame& frame, Submap* submap, StageTimes* times, MapUpdate* update) {
  {
    const StageTimer timer(times, Stage::kPhotometric);
    FollowCandidates(frame, submap);
  }
  const StageTimer timer(times, Stage::kInitialize);
  for (const Candidates::CertainPoint& point :
       submap->candidates.Certain(submap->last_cam_from_world, submap->map, submap->depths.sigma))
    Promote(point, submap, update);
  if (options_.growth.window > 0) {
    RememberWindow(frame, submap);
    if (IsReestimationDue(frame.step, *submap)) Reestimate(submap->window_frames, WindowScene::kAny, *submap);
    TakeReestimations(submap, update);  // the candidates were followed into this frame
  }
  const bool half_full = 2 * submap->map.landmarks.size() >= static_cast<std::size_t>(options_.corners.max_corners);
  const int every = half_full ? 2 * options_.growth.every : options_.growth.every;
  if (tracks_->abilities().adds_always || frame.step % every == 0) AddCandidates(frame, submap);
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
  AddToWindow(std::move(seen), submap);
}

void MapUpdater::AddToWindow(InitFrame frame, Submap* submap) const {
  std::vector<InitFrame>& frames = submap->window_frames;
  frames.push_back(std::move(frame));
  const auto length = static_cast<std::size_t>(options_.growth.window) + 1;
  if (frames.size() > length) frames.erase(frames.begin(), frames.end() - static_cast<std::ptrdiff_t>(length));
}

bool MapUpdater::IsReestimationDue(int step, const Submap& submap) const {
  const int every = options_.growth.reestimate_every;
  if (submap.window_frames.size() <= static_cast<std::size_t>(options_.growth.window) ||
      !submap.rigid_history.empty() || step % every != 0)
    return false;
  const std::vector<Landmark>& landmarks = submap.map.landmarks;
  const auto in_view = static_cast<double>(landmarks.size());
  const auto measured = static_cast<double>(std::ranges::count(landmarks, true, &Landmark::measured));
  if (measured >= options_.growth.max_measured_share * in_view) return false;
  const auto well_known = static_cast<double>(std::ranges::count_if(
      landmarks, [](const Landmark& landmark) { return landmark.times_reestimated >= kWellKnown; }));
  return !(well_known > 0.5 * in_view) || step % (2 * every) == 0;
}

// From the pixels of the last frames alone, so that no error of the map outlives them (G5).
void MapUpdater::TakeAny(const Reestimation& reestimation, Submap* submap, MapUpdate* update) const {
  const auto& [scene, then, outcome] = reestimation;
  if (outcome.decision != InitDecision::kMap) return;
  const double signal = outcome.measured.DepthSignal();
  if (outcome.provisional && (!submap->provisional || signal < submap->depths.signal)) return;
  std::vector<InitPosition> positions = ReestimatedPositions(outcome, then.cam_from_world, then.map);
  if (positions.empty()) return;
  RejectReprojectionOutliers(outcome, submap, &update->losses);
  if (options_.handover_frames > 0)
    positions = BringForward(positions, then, camera_, {submap->map, submap->last_cam_from_world},
                             [&](PointId id) { return submap->candidates.Pixel(id); });
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
  if (submap->provisional) submap->depths.signal = std::max(submap->depths.signal, signal);
  if (!outcome.provisional && 2 * positions.size() >= submap->map.landmarks.size()) submap->provisional = false;
  update->prior.is_used |= outcome.uses_prior;
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

void MapUpdater::Serialize(StateArchive& archive) { archive(updates_, reestimations_); }
void MapUpdater::Reestimation::Serialize(StateArchive& archive) { archive.Members<3>(*this); }

}  // namespace pliant
