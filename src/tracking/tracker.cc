// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/tracker.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <span>

#include "pliant/image/brightness.h"
#include "pliant/image/sharpness.h"
#include "tracking/candidates.h"
#include "tracking/first_map.h"
#include "tracking/lost_points.h"
#include "tracking/map_remaker.h"
#include "tracking/oracle_answers.h"
#include "tracking/places.h"
#include "tracking/rigid_history.h"
#include "tracking/submap.h"
#include "tracking/tracker_support.h"

namespace pliant {

void TrackerOptions::List(OptionTable& table) {
  corners.List(table);
  masks.List(table);
  point_tracker.List(table);
  init.List(table);
  pose.List(table);
  graph.List(table);
  problem.List(table);
  table.BeginGroup("Tracking", "the tracker: which points stay, when it is lost");
  table.Add("sigma_metric_mm", &sigma_metric_mm, "mm",
            "instead of Deformation.sigma_mm after a start from metric depth, as published", 0.1, 1e6);
  table.AddChoice("neighbor_agreement", &neighbor_agreement, "drop points that move as none of their neighbors does");
  agreement.List(table);
  table.AddChoice(
      "camera_motion", &camera_motion,
      "free: estimated in every frame; none: the camera is known to stand still, all motion is the scene's");
  table.Add(
      "gauge_share", &gauge_share, "-",
      "of what all points have done together since they were at rest, this goes to the camera in each frame; 0: none",
      0, 1);
  table.AddChoice("find_lost", &find_lost,
                  "look for points that were lost where the points around them took them; needs adaptive patches");
  table.Add("max_lost_points", &max_lost_points, "-", "lost points that are remembered; memory grows with them", 0,
            1000000);
  table.Add("max_searches", &max_searches, "-", "lost points that are looked for in a frame", 0, 1000000);
  table.Add("max_search_px", &max_search_px, "px",
            "a lost point that is found further from where it is expected is another one", 0, 1000);
  table.Add("max_reprojection_px", &max_reprojection_px, "px",
            "a point further than this from its measurement after the joint problem is dropped", 0.1, 1e6);
  table.Add("min_points", &min_points, "-", "fewer points in a frame: lost", 4, 100000);
  table.Add("min_corners", &min_corners, "-", "fewer corners in an image: it is no reference", 8, 100000);
  table.Add("top_up_frames", &top_up_frames, "frames",
            "while the first map is awaited, corners are added where there are none so often (Init.method = window)", 1,
            1000000);
  table.AddChoice("track_blurred", &track_blurred,
                  "follow the points into blurred images; before the first map pass over these");
  table.Add("min_sharpness", &min_sharpness, "-", "less than this of the last sharp image's: blurred, or dark", 0, 1);
  table.Add("max_blurred_frames", &max_blurred_frames, "frames", "after so many in a row the blur is taken to stay", 0,
            1000000);
  table.Add("max_lost_frames", &max_lost_frames, "frames",
            "lost for so many frames in a row that are not dark, the map is left", 1, 1000000);
  table.AddChoice("submaps", &submaps, "when the map is left begin another one; off: the run ends");
  growth.List(table);
  relocalization.List(table);
  oracle.List(table);
}

TrackerFrame PrepareFrame(int frame_idx, std::string name, double timestamp_s, const cv::Mat& image,
                          const cv::Mat& mask, const TrackerOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  TrackerFrame frame;
  frame.frame_idx = frame_idx;
  frame.name = std::move(name);
  frame.timestamp_s = timestamp_s;
  frame.image = image;
  frame.gray = ToGray(image);
  frame.pyramid = ImagePyramid(frame.gray, options.point_tracker.lucas_kanade.levels);
  frame.mask = SupportMask(ValidMask(image, mask, options.masks));
  frame.sharpness = Sharpness(frame.gray, frame.mask.valid());
  frame.prepare_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return frame;
}

Tracker::Tracker(const Camera& camera, const TrackerOptions& options, std::uint64_t seed, int threads,
                 TrackingTruth* truth, const std::optional<PhotometricCalibration>& photometric)
    : camera_(camera),
      photometric_(photometric),
      options_(options),
      threads_(threads),
      initializer_(MakeInitializer(options.init, Random(seed).Child("initializer"))),
      oracle_(std::make_unique<OracleAnswers>(
          options.oracle, truth,
          options.init.IsMetric() ? std::nullopt : std::optional(options.init.monocular.nominal_depth_mm))),
      remaker_(std::make_unique<MapRemaker>(options.init.window, options.init.monocular.nominal_depth_mm)),
      current_(std::make_unique<Submap>(0, camera_, options)) {
  if (options_.init.IsMetric()) options_.graph.sigma_mm = options_.sigma_metric_mm;
}

Tracker::~Tracker() = default;

const Map& Tracker::map() const { return current_->map; }

bool Tracker::NeedsDepth() const { return options_.init.TakesKnownDepth() && map().landmarks.empty(); }

bool Tracker::WantsDepth() const {
  return NeedsDepth() || (options_.init.TakesKnownDepth() && options_.submaps == Switch::kOn);
}

void Tracker::TakeMap(const TrackerFrame& frame, const FrameReport& report) {
  for (const PointObservation& seen : report.observations) {
    const auto point = std::ranges::find(report.new_points, seen.id, &NewPoint::id);
    if (current_->point_tracker.Add(seen.id, seen.pixel, frame.pyramid, frame.mask) != PatchFailure::kNone) continue;
    Landmark landmark{.id = seen.id, .rest_position = seen.position, .position = seen.position, .pixel = seen.pixel};
    if (point != report.new_points.end()) landmark.rest_position = point->position;
    current_->map.landmarks.push_back(landmark);
  }
  current_->idx = report.submap;
  current_->last_cam_from_world = *report.cam_from_world;
  current_->before_last_cam_from_world = *report.cam_from_world;
  current_->previous = frame;
  ++maps_made_;
  Apply(TrackingEvent::kMapCreated);
}

std::vector<FrameReport> Tracker::Process(const TrackerFrame& frame) {
  FrameReport& report = held_.emplace_back();
  report.frame_idx = frame.frame_idx;
  report.name = frame.name;
  report.timestamp_s = frame.timestamp_s;
  for (const std::string_view stage : kStages) report.stage_ms.emplace_back(stage, 0.0);
  report.stage_ms.front().second = frame.prepare_ms;
  losses_.clear();
  described_.reset();
  if (LeavesMap() && options_.submaps == Switch::kOn) LeaveMap();
  FindMapAgain(frame);

  switch (state_) {
    case TrackingState::kWaitingForReference:
      TakeReference(frame, &report);
      break;
    case TrackingState::kInitializing:
      FollowReference(frame, &report);
      break;
    case TrackingState::kTracking:
    case TrackingState::kLost:
      TrackFrame(frame, &report);
      break;
  }
  report.state = state_;
  report.submap = current_->idx;
  ReportLosses(&report);
  JoinMaps(frame, &report);

  const auto first_held = state_ == TrackingState::kInitializing
                              ? std::ranges::find(held_, init_frames_.front().frame_idx, &FrameReport::frame_idx)
                              : held_.end();
  std::vector<FrameReport> done(std::make_move_iterator(held_.begin()), std::make_move_iterator(first_held));
  held_.erase(held_.begin(), first_held);
  return done;
}

void Tracker::Count(std::string_view reason, int count) {
  if (count == 0) return;
  for (auto& [name, total] : losses_)
    if (name == reason) {
      total += count;
      return;
    }
  losses_.emplace_back(reason, count);
}

void Tracker::ReportLosses(FrameReport* report) const {
  report->losses = losses_;
  report->lost = 0;
  for (const auto& [reason, count] : losses_) report->lost += count;
}

// Adds corners away from the points that are there.
void Tracker::AddCorners(const TrackerFrame& frame, const LocalBrightness& brightness, int max_corners,
                         InitFrame* points) {
  if (max_corners <= 0) return;
  std::vector<Eigen::Vector2d> existing;
  for (const InitObservation& observation : points->observations) existing.push_back(observation.pixel);
  CornerOptions corners = options_.corners;
  corners.max_corners = max_corners;
  InitFrame added{frame.frame_idx, {}};
  for (const Corner& corner : DetectCorners(frame.gray, frame.mask.valid(), existing, corners)) {
    const PointId id{next_id_};
    if (current_->point_tracker.Add(id, corner.pixel, frame.pyramid, frame.mask) != PatchFailure::kNone) continue;
    added.observations.push_back(
        {id, corner.pixel, 1.0, brightness.At(corner.pixel), ColorAt(frame.image, corner.pixel)});
    ++next_id_;
  }
  oracle_->StartTracks(&added);
  points->observations.insert(points->observations.end(), added.observations.begin(), added.observations.end());
}

void Tracker::AddKnownPoints(const TrackerFrame& frame, const LocalBrightness& brightness, InitFrame* points) {
  if (!frame.known_points) return;
  for (const PixelDepth& known : frame.known_points()) {
    if (static_cast<int>(points->observations.size()) == options_.corners.max_corners) break;
    const PointId id{next_id_};
    if (current_->point_tracker.Add(id, known.pixel, frame.pyramid, frame.mask) != PatchFailure::kNone) continue;
    points->observations.push_back(
        {id, known.pixel, 1.0, brightness.At(known.pixel), ColorAt(frame.image, known.pixel)});
    known_depths_.push_back(known.depth);
    ++next_id_;
  }
}

void Tracker::TakeReference(const TrackerFrame& frame, FrameReport* report) {
  {
    const StageTimer timer(report, "initialize");
    current_->map.landmarks.clear();
    init_frames_.clear();
    current_->point_tracker.Clear();
    current_->lost_points.Clear();
    current_->rigid_history.Stop();
    current_->candidates.Clear();
    current_->places.Clear();
    current_->recent_poses.clear();
    current_->window_frames.clear();
    InitFrame reference{frame.frame_idx, {}};
    const LocalBrightness brightness(frame.image, frame.mask.valid());
    known_depths_.clear();
    if (initializer_->TakesKnownPoints())
      AddKnownPoints(frame, brightness, &reference);
    else
      AddCorners(frame, brightness, options_.corners.max_corners, &reference);
    report->tracked = static_cast<int>(reference.observations.size());
    init_frames_.push_back(std::move(reference));
  }
  if (report->tracked < options_.min_corners) {
    Apply(TrackingEvent::kTooFewCorners);
    report->note = WithFault("no reference yet: " + std::to_string(report->tracked) +
                                 (initializer_->TakesKnownPoints() ? " points of the model" : " corners") +
                                 ", of at least " + std::to_string(options_.min_corners),
                             ImageFault(frame, current_->previous));
  } else if (TryInitialize(frame, report) == InitDecision::kWait) {
    Apply(TrackingEvent::kReferenceFound);
    report->note = "reference with " + std::to_string(report->tracked) + " corners";
  }
  current_->previous = frame;
}

// Constant velocity in the image: there is no map yet.
std::vector<PointPrediction> Tracker::PredictWithoutMap(int frame_idx) const {
  const std::vector<InitObservation>& last = init_frames_.back().observations;
  std::vector<Eigen::Vector2d> from;
  std::vector<Eigen::Vector2d> to;
  for (const InitObservation& observation : last) {
    from.push_back(observation.pixel);
    to.push_back(observation.pixel);
  }
  if (init_frames_.size() >= 2) {
    const InitFrame& earlier = init_frames_[init_frames_.size() - 2];
    const double steps = static_cast<double>(frame_idx - init_frames_.back().frame_idx) /
                         (init_frames_.back().frame_idx - earlier.frame_idx);
    for (std::size_t k = 0; k < last.size(); ++k)
      if (const InitObservation* before = FindById(earlier.observations, last[k].id); before != nullptr)
        to[k] = (1 + steps) * last[k].pixel - steps * before->pixel;
  }
  const std::vector<Eigen::Matrix2d> affines = NeighborhoodAffines(from, to);
  std::vector<PointPrediction> predictions;
  for (std::size_t k = 0; k < last.size(); ++k) predictions.push_back({last[k].id, to[k], affines[k]});
  return predictions;
}

// A dark or blurred frame is passed over: the points are sought again in the next one.
bool Tracker::PassOver(const TrackerFrame& frame, FrameReport* report) {
  if (options_.track_blurred == Switch::kOff || !IsBlurred(frame)) return false;
  ++blurred_frames_;
  report->tracked = static_cast<int>(init_frames_.back().observations.size());
  report->note = WithFault("passed over: the image is blurred or dark", ImageFault(frame, current_->previous));
  return true;
}

void Tracker::FollowReference(const TrackerFrame& frame, FrameReport* report) {
  {
    const StageTimer timer(report, "photometric");
    if (PassOver(frame, report)) return;
    blurred_frames_ = 0;
    const std::vector<PointTrack> tracks = TrackPixels(frame, PredictWithoutMap(frame.frame_idx));
    InitFrame followed{frame.frame_idx, {}};
    const LocalBrightness brightness(frame.image, frame.mask.valid());
    for (const PointTrack& track : tracks) {
      if (track.failure == PatchFailure::kNone) {
        followed.observations.push_back(
            {track.id, track.pixel, track.ssim, brightness.At(track.pixel), ColorAt(frame.image, track.pixel)});
      } else {
        current_->point_tracker.Remove(track.id);
        Count(EnumName(track.failure), 1);
      }
    }
    const auto kept = static_cast<int>(followed.observations.size());
    if (initializer_->TakesLaterPoints() && init_frames_.size() % static_cast<std::size_t>(options_.top_up_frames) == 0)
      AddCorners(frame, brightness, options_.corners.max_corners - kept, &followed);
    report->tracked = static_cast<int>(followed.observations.size());
    init_frames_.push_back(std::move(followed));
    current_->point_tracker.Keep();
  }
  image_fault_ = ImageFault(frame, current_->previous);
  TryInitialize(frame, report);
  report->note = WithFault(report->note, image_fault_);
  current_->previous = frame;
}

InitOutcome Tracker::AskInitializer(const cv::Mat& depth_mm, InitMoment moment, FrameReport* report) {
  const StageTimer timer(report, "initialize");
  const InitInput input{camera_, init_frames_, depth_mm, moment, threads_, known_depths_, photometric_};
  InitOutcome outcome =
      oracle_->gives_first_map() ? oracle_->FirstMap(input, options_.min_points) : initializer_->Try(input);
  if (outcome.decision == InitDecision::kMap) oracle_->TakeWorld(input, &outcome);
  return outcome;
}

void Tracker::EndSequence() {
  if (state_ != TrackingState::kInitializing || held_.empty()) return;
  const InitOutcome outcome = AskInitializer({}, InitMoment::kLastFrame, &held_.back());
  if (outcome.decision == InitDecision::kMap) {
    CreateMap(outcome);
    ReportLosses(&held_.back());
  }
  held_.back().note = WithFault(outcome.reason, image_fault_);
}

InitDecision Tracker::TryInitialize(const TrackerFrame& frame, FrameReport* report) {
  const InitOutcome outcome = AskInitializer(frame.depth_mm, InitMoment::kMoreFollow, report);
  switch (outcome.decision) {
    case InitDecision::kMap:
      CreateMap(outcome);
      report->note = outcome.reason;
      return outcome.decision;
    case InitDecision::kWait:
      Apply(TrackingEvent::kMapAwaited);
      report->note = outcome.reason;
      return outcome.decision;
    case InitDecision::kNewReference:
      break;
  }
  if (init_frames_.size() == 1) {  // not this image either
    report->note = outcome.reason;
    return outcome.decision;
  }
  Apply(TrackingEvent::kReferenceSpent);
  TakeReference(frame, report);
  report->note = outcome.reason + "; " + report->note;
  return outcome.decision;
}

// Of the points that the map does not have, those may still enter it whose depth is uncertain so far.
void Tracker::KeepCandidates(const InitOutcome& outcome) {
  for (const InitPoint& point : outcome.points)
    if (current_->map.Find(point.id) == nullptr) current_->point_tracker.Remove(point.id);
  for (const InitRejectedPoint& rejected : outcome.rejected) {
    const InitObservation* seen = FindById(init_frames_.back().observations, rejected.id);
    const bool uncertain =
        rejected.reason == InitRejection::kUncertainDepth || rejected.reason == InitRejection::kTooFewViews;
    if (!GrowsMap() || !uncertain || seen == nullptr ||
        !current_->candidates.Add({seen->id, seen->pixel, seen->ssim, seen->rgb}, current_->last_cam_from_world,
                                  current_->map))
      current_->point_tracker.Remove(rejected.id);
  }
  current_->window_frames = init_frames_;
}

// Every frame since the reference gets its pose and points; tracking goes on from the last one.
void Tracker::CreateMap(const InitOutcome& outcome) {
  for (const InitRejectedPoint& rejected : outcome.rejected)
    if (rejected.reason != InitRejection::kLostOnTheWay) Count(InitRejectionName(rejected.reason), 1);
  ReportFirstMap(camera_, init_frames_, outcome, held_);
  current_->map = MakeFirstMap(init_frames_, outcome);
  for (Landmark& landmark : current_->map.landmarks)
    landmark.measured = options_.init.IsMetric() || oracle_->gives_first_map();
  current_->last_cam_from_world = outcome.frames.back().cam_from_world;
  current_->before_last_cam_from_world = outcome.frames.size() >= 2
                                             ? outcome.frames[outcome.frames.size() - 2].cam_from_world
                                             : current_->last_cam_from_world;
  KeepCandidates(outcome);
  if (outcome.refinable && !oracle_->gives_poses() && options_.camera_motion == CameraMotion::kFree)
    current_->rigid_history.Start(std::move(init_frames_));
  init_frames_.clear();
  ++maps_made_;
  Apply(TrackingEvent::kMapCreated);
}

}  // namespace pliant
