// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/frame/frame_tracker.h"

#include <algorithm>
#include <utility>

namespace pliant {

// The names in brackets are those of docs/method.md.
SolvedFrame FrameTracker::Solve(const PreparedFrame& frame, TrackingState state, FollowedPoints followed,
                                Submap* submap, StageTimes* times) const {
  SolvedFrame solved{.tracked = static_cast<int>(followed.size())};
  if (solved.tracked < options_.min_points) {
    solved.failure = followed.unconfirmed > 0 ? Unconfirmed(followed) : TooFewPoints(solved.tracked, *submap);
    return solved;
  }
  const FramePose held = KnownPose(frame.frame_idx, *submap) ? FramePose::kHeld : FramePose::kEstimated;
  const Rigid3 pose = held == FramePose::kHeld ? followed.cam_from_world : EstimatePose(followed, times);  // (E7)
  if (options_.find_lost == Switch::kOn && state == TrackingState::kTracking && !followed.in_blur) {
    const StageTimer timer(times, Stage::kPhotometric);
    FindLost(frame, pose, submap, &followed);  // (R2)
    solved.tracked = static_cast<int>(followed.size());
  }
  DeformationGraph graph = BuildGraph(followed, times);  // (D1)
  if (options_.neighbor_agreement == Switch::kOn) {
    {
      const StageTimer timer(times, Stage::kAgreement);
      RejectNeighborOutliers(pose, graph, &followed);  // (A3)
    }
    if (static_cast<int>(followed.size()) < solved.tracked) graph = BuildGraph(followed, times);
  }
  const auto solution = [&] {
    const StageTimer timer(times, Stage::kJoint);
    return SolveFrameProblem(
        camera_,
        {followed.positions, followed.pixels, graph.edges, pose, held, cost_.get(), frame.frame_idx, followed.ids},
        options_.problem);  // (E5)
  }();
  if (!solution.ok()) {
    solved.failure = solution.status().message();
    return solved;
  }
  solved.solution = *solution;
  followed.solved = solution->points;
  RejectReprojectionOutliers(&followed);
  if (static_cast<int>(followed.size()) < options_.min_points)
    solved.failure = TooFewPoints(static_cast<int>(followed.size()), *submap);
  solved.points = std::move(followed);
  return solved;
}

std::optional<Rigid3> FrameTracker::KnownPose(int frame_idx, const Submap& submap) const {
  if (options_.camera_motion == CameraMotion::kNone) return submap.last_cam_from_world;
  return oracle_poses_->Pose(frame_idx);
}

// Where each landmark is expected by a camera at this pose (P6): its last pixel, moved as the map says that camera and
// point move it.
std::vector<PointPrediction> FrameTracker::PredictPixels(const Submap& submap, const Rigid3& cam_from_world) const {
  std::vector<Eigen::Vector2d> from;
  std::vector<Eigen::Vector2d> to;
  for (const Landmark& landmark : submap.map.landmarks) {
    const auto last = camera_.Project(submap.last_cam_from_world * landmark.position);
    const auto next = camera_.Project(cam_from_world * (landmark.position + landmark.last_motion));
    from.push_back(landmark.sharp_pixel.value_or(landmark.pixel));  // its patch is of the last sharp image
    to.push_back(last && next ? Eigen::Vector2d(landmark.pixel + *next - *last) : landmark.pixel);
  }
  const std::vector<Eigen::Matrix2d> affines = NeighborhoodAffines(from, to);
  std::vector<PointPrediction> predictions;
  for (std::size_t k = 0; k < to.size(); ++k) predictions.push_back({submap.map.landmarks[k].id, to[k], affines[k]});
  return predictions;
}

FollowedPoints FrameTracker::Follow(const PreparedFrame& frame, const Submap& submap,
                                    const Rigid3& cam_from_world) const {
  FollowedPoints followed;
  followed.cam_from_world = cam_from_world;
  followed.in_blur = submap.IsBlurred(frame, options_, tracks_->abilities());
  const std::vector<PointPrediction> predictions = PredictPixels(submap, cam_from_world);
  followed.expected = std::ranges::count_if(
      predictions, [&](const PointPrediction& prediction) { return camera_.Contains(prediction.pixel); });
  const std::vector<PointTrack> tracks = followed.in_blur
                                             ? tracks_->TrackIntoBlur(submap.previous, frame, predictions)  // (P10)
                                             : tracks_->Track(submap.previous, frame, predictions);
  for (std::size_t k = 0; k < tracks.size(); ++k) {
    if (tracks[k].failure != PatchFailure::kNone) {
      followed.losses.Add(EnumName(tracks[k].failure), 1);
      followed.unseen.push_back(tracks[k].id);
    } else {
      followed.Add(submap.map.landmarks[k], tracks[k]);
    }
  }
  return followed;
}

FollowedPoints FrameTracker::Follow(const PreparedFrame& frame, const Submap& submap) const {
  return Follow(frame, submap, PredictPose(frame.frame_idx, submap));
}

FollowedPoints FrameTracker::Followed(const InitFrame& frame, const Submap& submap) const {
  FollowedPoints followed;
  followed.cam_from_world = PredictPose(frame.frame_idx, submap);
  followed.expected = std::ssize(submap.map.landmarks);
  for (const Landmark& landmark : submap.map.landmarks) {
    if (const InitObservation* seen = FindById(frame.observations, landmark.id); seen != nullptr)
      followed.Add(landmark, {.id = seen->id, .pixel = seen->pixel, .ssim = seen->ssim});
    else
      followed.unseen.push_back(landmark.id);
  }
  return followed;
}

Rigid3 FrameTracker::PredictPose(int frame_idx, const Submap& submap) const {
  const auto known = KnownPose(frame_idx, submap);
  return known ? *known : PredictCameraPose(submap.before_last_cam_from_world, submap.last_cam_from_world);  // (E6)
}

void FrameTracker::FindLost(const PreparedFrame& frame, const Rigid3& cam_from_world, Submap* submap,
                            FollowedPoints* followed) const {
  if (!tracks_->abilities().finds_points) return;
  const std::vector<PointPrediction> expected =
      submap->lost_points.Expected(camera_, cam_from_world, static_cast<std::size_t>(options_.max_searches));
  const std::vector<PointTrack> tracks = tracks_->Find(frame, expected);
  for (std::size_t k = 0; k < tracks.size(); ++k) {
    if (tracks[k].failure != PatchFailure::kNone) continue;
    if ((tracks[k].pixel - expected[k].pixel).norm() > options_.max_search_px) continue;
    followed->Add(*submap->lost_points.Find(tracks[k].id), tracks[k]);
  }
  for (const PointPrediction& prediction : expected) followed->searched.push_back(prediction.id);
  followed->expected += static_cast<std::ptrdiff_t>(expected.size());
}

Rigid3 FrameTracker::EstimatePose(const FollowedPoints& followed, StageTimes* times) const {
  const StageTimer timer(times, Stage::kPose);
  const auto estimate =
      EstimateCameraPose(camera_, followed.positions, followed.pixels, followed.cam_from_world, options_.pose);
  return estimate.ok() ? estimate->cam_from_world : followed.cam_from_world;
}

// An empty graph where there is none: the points are then tied to nothing.
DeformationGraph FrameTracker::BuildGraph(const FollowedPoints& followed, StageTimes* times) const {
  const StageTimer timer(times, Stage::kGraph);
  auto graph = BuildDeformationGraph(followed.positions, followed.rest_positions, options_.graph, threads_);
  return graph.ok() ? *std::move(graph) : DeformationGraph{};
}

// Each point is put where its pixel says, at its last depth; how far that is from where its neighbors' motion since
// rest would put it, is what its neighbors do not share.
void FrameTracker::RejectNeighborOutliers(const Rigid3& cam_from_world, const DeformationGraph& graph,
                                          FollowedPoints* followed) const {
  const Rigid3 world_from_cam = cam_from_world.Inverse();
  std::vector<NeighborMotion> motions;
  std::vector<double> px_per_mm;
  for (std::size_t k = 0; k < followed->size(); ++k) {
    const Eigen::Vector3d last_in_cam = cam_from_world * followed->positions[k];
    const auto ray = camera_.Unproject(followed->pixels[k]);
    const Eigen::Vector3d in_cam = ray ? Eigen::Vector3d(*ray * last_in_cam.norm()) : last_in_cam;
    motions.push_back({followed->rest_positions[k], world_from_cam * in_cam});
    px_per_mm.push_back(camera_.MeanFocalLengthPx() / last_in_cam.norm());
  }
  std::vector<std::vector<int>> neighbors(followed->size());
  for (const GraphEdge& edge : graph.edges) {
    neighbors[edge.i].push_back(edge.j);
    neighbors[edge.j].push_back(edge.i);
  }
  const auto disagreements = MeasureDisagreement(motions, neighbors, world_from_cam.translation, threads_);
  std::vector<char> keep(followed->size(), 1);
  for (std::size_t k = 0; k < keep.size(); ++k)
    if (Contradicts(disagreements[k], px_per_mm[k], options_.agreement)) keep[k] = 0;
  followed->losses.Add("contradicts_neighbors", static_cast<int>(std::count(keep.begin(), keep.end(), 0)));
  followed->Keep(keep);
}

void FrameTracker::RejectReprojectionOutliers(FollowedPoints* followed) const {
  std::vector<char> keep(followed->size(), 1);
  for (std::size_t k = 0; k < keep.size(); ++k) {
    const FramePoint& point = followed->solved[k];
    if (!point.used) {
      followed->losses.Add("behind_camera", 1);
      keep[k] = 0;
    } else if (point.reprojection_error_px > options_.max_reprojection_px) {
      followed->losses.Add("reprojection_error", 1);
      keep[k] = 0;
    }
  }
  followed->Keep(keep);
}

std::string FrameTracker::TooFewPoints(int count, const Submap& submap) const {
  return std::to_string(count) + " of " + std::to_string(submap.map.landmarks.size()) +
         " points could be followed, of at least " + std::to_string(options_.min_points);
}

std::string FrameTracker::Unconfirmed(const FollowedPoints& followed) const {
  return std::to_string(followed.unconfirmed) + " of " + std::to_string(followed.expected) +
         " points were found again, but too few of them agree on where the camera is";
}

}  // namespace pliant
