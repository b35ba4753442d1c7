// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// One frame with a map: the way from predicted pixels to the committed solution.
#include <algorithm>
#include <cmath>

#include "pliant/base/statistics.h"
#include "pliant/tracking/tracker.h"
#include "tracking/blurred_tracks.h"
#include "tracking/followed.h"
#include "tracking/gauge.h"
#include "tracking/lost_points.h"
#include "tracking/oracle_answers.h"
#include "tracking/submap.h"
#include "tracking/tracker_support.h"

namespace pliant {

// One frame, as in the paper; the names in brackets are those of docs/method.md.
void Tracker::TrackFrame(const TrackerFrame& frame, FrameReport* report) {
  Rigid3 predicted = PredictCameraPose(current_->before_last_cam_from_world, current_->last_cam_from_world);  // (E6)
  const std::optional<Rigid3> known_pose = KnownPose(frame.frame_idx);
  if (known_pose) predicted = *known_pose;
  Followed followed;
  {
    const StageTimer timer(report, "photometric");
    if (state_ == TrackingState::kTracking || known_pose)
      followed = FollowPoints(frame, PredictPixels(predicted));  // (P1)
    else
      followed = Relocalize(frame, &predicted);  // (R3)
    report->tracked = static_cast<int>(followed.size());
  }
  if (report->tracked < options_.min_points) return ReportLost(frame, Found(report->tracked), report);

  Rigid3 pose = predicted;
  if (!known_pose) {
    const StageTimer timer(report, "pose");
    const auto estimate =
        EstimateCameraPose(camera_, followed.positions, followed.pixels, predicted, options_.pose);  // (E7)
    if (estimate.ok()) pose = estimate->cam_from_world;
  }
  if (options_.find_lost == Switch::kOn && !oracle_->gives_tracks() && !followed.in_blur &&
      state_ == TrackingState::kTracking) {
    const StageTimer timer(report, "photometric");
    FindLost(frame, pose, &followed);  // (R2)
    report->tracked = static_cast<int>(followed.size());
  }
  DeformationGraph graph = TieNeighbors(followed, report);  // (D1)
  if (options_.neighbor_agreement == Switch::kOn) {
    const std::size_t before = followed.size();
    {
      const StageTimer timer(report, "agreement");
      DropContradicted(pose, graph, &followed);  // (A3)
    }
    if (followed.size() < before) graph = TieNeighbors(followed, report);
  }
  Result<FrameSolution> solution = Status(ErrorCode::kInsufficient, "not solved");
  {
    const StageTimer timer(report, "joint");
    solution = SolveFrameProblem(
        camera_,
        {followed.positions, followed.pixels, graph.edges, pose, known_pose ? FramePose::kHeld : FramePose::kEstimated},
        options_.problem);  // (E5)
  }
  if (solution.ok()) {
    followed.solved = solution->points;
    DropUnexplained(&followed);
  }
  if (!solution.ok()) return ReportLost(frame, solution.status().message(), report);
  if (static_cast<int>(followed.size()) < options_.min_points)
    return ReportLost(frame, Found(static_cast<int>(followed.size())), report);
  Commit(*solution, followed, report);
  if (!known_pose && options_.gauge_share > 0) HoldGauge(report);
  Apply(TrackingEvent::kFrameTracked);
  if (followed.in_blur) {
    ++blurred_frames_;
    report->note = "the image is blurred";
    return;
  }
  blurred_frames_ = 0;
  Remember(frame, *report);
  RefineMap(report);
  GrowMap(frame, report);
  current_->point_tracker.Keep();
  report->note = WithFault(report->note, ImageFault(frame, current_->previous));
  current_->previous = frame;
}

// Of the truth, or of a camera that stands still.
std::optional<Rigid3> Tracker::KnownPose(int frame_idx) const {
  if (options_.camera_motion == CameraMotion::kNone) return current_->last_cam_from_world;
  return oracle_->Pose(frame_idx);
}

// Where each landmark is expected (P6): its last pixel, moved as the map says that camera and point move it.
std::vector<PointPrediction> Tracker::PredictPixels(const Rigid3& predicted_cam_from_world) const {
  std::vector<Eigen::Vector2d> from;
  std::vector<Eigen::Vector2d> to;
  for (const Landmark& landmark : current_->map.landmarks) {
    const auto now = camera_.Project(current_->last_cam_from_world * landmark.position);
    const auto next = camera_.Project(predicted_cam_from_world * (landmark.position + landmark.last_motion));
    from.push_back(landmark.pixel);
    to.push_back(now && next ? Eigen::Vector2d(landmark.pixel + *next - *now) : landmark.pixel);
  }
  const std::vector<Eigen::Matrix2d> affines = NeighborhoodAffines(from, to);
  std::vector<PointPrediction> predictions;
  for (std::size_t k = 0; k < to.size(); ++k) predictions.push_back({current_->map.landmarks[k].id, to[k], affines[k]});
  return predictions;
}

// The points in this image, one result a prediction.
std::vector<PointTrack> Tracker::TrackPixels(const TrackerFrame& frame,
                                             const std::vector<PointPrediction>& predictions) {
  if (oracle_->gives_tracks()) return oracle_->Tracks(frame.frame_idx, predictions);
  return current_->point_tracker.Track(current_->previous.pyramid, current_->previous.mask, frame.pyramid, frame.mask,
                                       predictions, threads_);
}

// Against the last sharp image. Of many such images in a row the later ones are taken as they are: the blur stays.
bool Tracker::IsBlurred(const TrackerFrame& frame) const {
  return blurred_frames_ < options_.max_blurred_frames &&
         frame.sharpness < options_.min_sharpness * current_->previous.sharpness;
}

std::vector<PointTrack> Tracker::TrackPixelsIntoBlur(const TrackerFrame& frame,
                                                     const std::vector<PointPrediction>& predictions) const {
  std::vector<Eigen::Vector2d> pixels;
  for (const PointPrediction& prediction : predictions)
    pixels.push_back(current_->point_tracker.PixelOf(prediction.id));
  return TrackIntoBlur(current_->previous, frame, pixels, predictions, options_.point_tracker, threads_);
}

Tracker::Followed Tracker::FollowPoints(const TrackerFrame& frame, const std::vector<PointPrediction>& predictions) {
  Followed followed;
  followed.in_blur = options_.track_blurred == Switch::kOn && !oracle_->gives_tracks() && IsBlurred(frame);
  const std::vector<PointTrack> tracks =
      followed.in_blur ? TrackPixelsIntoBlur(frame, predictions) : TrackPixels(frame, predictions);  // (P10)
  for (std::size_t k = 0; k < tracks.size(); ++k) {
    if (tracks[k].failure != PatchFailure::kNone) {
      Count(EnumName(tracks[k].failure), 1);
      followed.unseen.push_back(tracks[k].id);
    } else {
      followed.Add(current_->map.landmarks[k], tracks[k]);
    }
  }
  return followed;
}

// Lost points that are where they are expected (R2). They take part in the frame's problem like the others. Returns how
// many were looked for.
int Tracker::FindLost(const TrackerFrame& frame, const Rigid3& cam_from_world, Followed* followed) {
  const std::vector<PointPrediction> expected =
      current_->lost_points.Expected(camera_, cam_from_world, static_cast<std::size_t>(options_.max_searches));
  const std::vector<PointTrack> tracks = current_->point_tracker.Find(frame.pyramid, frame.mask, expected, threads_);
  for (std::size_t k = 0; k < tracks.size(); ++k) {
    if (tracks[k].failure != PatchFailure::kNone) continue;
    if ((tracks[k].pixel - expected[k].pixel).norm() > options_.max_search_px) {
      current_->point_tracker.Undo(tracks[k].id);
    } else {
      followed->Add(*current_->lost_points.Find(tracks[k].id), tracks[k]);
      followed->found.push_back(tracks[k].id);
    }
  }
  return static_cast<int>(expected.size());
}

// An empty graph where there is none: the points are then tied to nothing.
DeformationGraph Tracker::TieNeighbors(const Followed& followed, FrameReport* report) const {
  const StageTimer timer(report, "graph");
  auto graph = BuildDeformationGraph(followed.positions, followed.rest_positions, options_.graph);
  return graph.ok() ? *std::move(graph) : DeformationGraph{};
}

// Each point is put where its pixel says, at its last depth; how far that is from where its neighbors' motion since
// rest would put it, is what its neighbors do not share.
void Tracker::DropContradicted(const Rigid3& cam_from_world, const DeformationGraph& graph, Followed* followed) {
  const Rigid3 world_from_cam = cam_from_world.Inverse();
  std::vector<NeighborMotion> motions;
  std::vector<double> px_per_mm;
  for (std::size_t k = 0; k < followed->size(); ++k) {
    const Eigen::Vector3d last_in_cam = cam_from_world * followed->positions[k];
    const auto ray = camera_.Unproject(followed->pixels[k]);
    const Eigen::Vector3d now = ray ? Eigen::Vector3d(*ray * last_in_cam.norm()) : last_in_cam;
    motions.push_back({followed->rest_positions[k], world_from_cam * now});
    px_per_mm.push_back(camera_.MeanFocalLengthPx() / last_in_cam.norm());
  }
  std::vector<std::vector<int>> neighbors(followed->size());
  for (const GraphEdge& edge : graph.edges) {
    neighbors[edge.i].push_back(edge.j);
    neighbors[edge.j].push_back(edge.i);
  }
  const auto disagreements = MeasureDisagreement(motions, neighbors, world_from_cam.translation);
  std::vector<char> keep(followed->size(), 1);
  for (std::size_t k = 0; k < keep.size(); ++k)
    if (Contradicts(disagreements[k], px_per_mm[k], options_.agreement)) keep[k] = 0;
  Count("contradicts_neighbors", static_cast<int>(std::count(keep.begin(), keep.end(), 0)));
  followed->Keep(keep);
}

void Tracker::DropUnexplained(Followed* followed) {
  std::vector<char> keep(followed->size(), 1);
  for (std::size_t k = 0; k < keep.size(); ++k) {
    const FramePoint& point = followed->solved[k];
    if (!point.used) {
      Count("behind_camera", 1);
      keep[k] = 0;
    } else if (point.reprojection_error_px > options_.max_reprojection_px) {
      Count("reprojection_error", 1);
      keep[k] = 0;
    }
  }
  followed->Keep(keep);
}

// The only place where a frame's solution enters the map. What was not found in the image is lost, and may be found
// again; what was found and contradicts the rest is forgotten.
void Tracker::Commit(const FrameSolution& solution, const Followed& followed, FrameReport* report) {
  Map next;
  std::vector<double> errors;
  for (std::size_t k = 0; k < followed.size(); ++k) {
    const Landmark* before = current_->map.Find(followed.ids[k]);
    Landmark landmark = before != nullptr ? *before : *current_->lost_points.Find(followed.ids[k]);
    current_->lost_points.Remove(landmark.id);
    landmark.last_motion = followed.solved[k].position - landmark.position;
    landmark.position = followed.solved[k].position;
    landmark.pixel = followed.pixels[k];
    next.landmarks.push_back(landmark);
    report->observations.push_back({landmark.id, landmark.pixel, landmark.position, followed.ssim[k]});
    errors.push_back(followed.solved[k].reprojection_error_px);
  }
  for (const Landmark& landmark : current_->map.landmarks) {
    if (next.Find(landmark.id) != nullptr) continue;
    const bool unseen = std::binary_search(followed.unseen.begin(), followed.unseen.end(), landmark.id);
    if (unseen && options_.find_lost == Switch::kOn)
      current_->lost_points.Add(landmark, current_->last_cam_from_world);
    else
      current_->point_tracker.Remove(landmark.id);
  }
  for (; static_cast<int>(current_->lost_points.size()) > options_.max_lost_points;
       current_->lost_points.Remove(current_->lost_points.Oldest()))
    current_->point_tracker.Remove(current_->lost_points.Oldest());
  for (const PointId id : followed.found)
    if (next.Find(id) == nullptr) current_->point_tracker.Undo(id);  // it was another one; the point stays lost
  current_->map = std::move(next);
  current_->lost_points.Move(current_->map.landmarks);  // (R1)
  current_->before_last_cam_from_world = state_ == TrackingState::kTracking
                                             ? current_->last_cam_from_world
                                             : solution.cam_from_world;  // no velocity after a gap
  current_->last_cam_from_world = solution.cam_from_world;
  lost_frames_ = 0;

  report->cam_from_world = solution.cam_from_world;
  report->optimized = static_cast<int>(followed.size());
  report->median_reprojection_error_px = Median(std::move(errors));
  report->costs = solution.costs;
}

// What all points have done together since they were at rest goes to the camera, by and by (E12). Their pixels stay.
void Tracker::HoldGauge(FrameReport* report) {
  const Rigid3 moved = TowardsRest(current_->map, options_.gauge_share);
  current_->MoveAllButRest(moved);
  report->cam_from_world = current_->last_cam_from_world;
  for (PointObservation& seen : report->observations) seen.position = moved * seen.position;
}

// Too few points, as a sentence.
std::string Tracker::Found(int count) const {
  return std::to_string(count) + " of " + std::to_string(current_->map.landmarks.size()) +
         " points could be followed, of at least " + std::to_string(options_.min_points);
}

// Nothing is given up: the map and the patches stay as they were in the last good frame.
void Tracker::ReportLost(const TrackerFrame& frame, const std::string& reason, FrameReport* report) {
  if (state_ == TrackingState::kTracking) RememberLastView();
  Apply(TrackingEvent::kTooFewPoints);
  const std::string fault = ImageFault(frame, current_->previous);
  if (fault.empty()) ++lost_frames_;
  losses_.clear();
  current_->point_tracker.Undo();
  report->note = WithFault(reason, fault);
}

}  // namespace pliant
