// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Camera pose and deformation from one image after another (Gomez Rodriguez, Montiel, Tardos, IROS 2022). The tracker
// is given images and answers with reports; it owns the map and is the only one to change it. It neither reads nor
// writes files. From the reference frame on reports are held back until the first map is made, which gives those frames
// their poses and points, or the reference is given up. One frame's way: docs/concepts.md; equations: docs/method.md.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pliant/base/options.h"
#include "pliant/camera/camera.h"
#include "pliant/deformation/graph.h"
#include "pliant/estimation/camera_pose.h"
#include "pliant/estimation/frame_problem.h"
#include "pliant/geometry/sim3.h"
#include "pliant/image/corners.h"
#include "pliant/image/masks.h"
#include "pliant/image/pyramid.h"
#include "pliant/scene/frame_report.h"
#include "pliant/scene/map.h"
#include "pliant/tracking/growth_options.h"
#include "pliant/tracking/initializer.h"
#include "pliant/tracking/make_initializer.h"
#include "pliant/tracking/neighbor_agreement.h"
#include "pliant/tracking/oracle.h"
#include "pliant/tracking/point_tracker.h"
#include "pliant/tracking/relocalization_options.h"
#include "pliant/tracking/state.h"

namespace pliant {

class LocalBrightness;
class MapRemaker;
class OracleAnswers;
struct DescribedImage;

// What is known of the camera's way after the first map.
enum class CameraMotion {
  kFree,  // nothing: its pose is estimated in every frame
  kNone,  // it stands still
};
template <>
struct EnumNames<CameraMotion> {
  static constexpr std::array kNames = {std::pair{CameraMotion::kFree, std::string_view("free")},
                                        std::pair{CameraMotion::kNone, std::string_view("none")}};
};

struct TrackerOptions {
  CornerOptions corners;
  MaskOptions masks;
  PointTrackerOptions point_tracker;
  InitOptions init;
  CameraPoseOptions pose;
  GraphOptions graph;
  FrameProblemOptions problem;
  AgreementOptions agreement;
  GrowthOptions growth;
  RelocalizationOptions relocalization;
  OracleOptions oracle;

  double sigma_metric_mm = 55.0;  // instead of graph.sigma_mm after a start from metric depth, as published
  CameraMotion camera_motion = CameraMotion::kFree;
  Switch neighbor_agreement = Switch::kOn;
  double gauge_share = 0.2;             // a frame, of the scene's common motion since rest, that goes to the camera
  Switch find_lost = Switch::kOn;       // points that were lost are looked for where their neighbors took them
  int max_searches = 200;               // a frame, for lost points
  int max_lost_points = 500;            // that are remembered: the oldest is forgotten first
  double max_search_px = 8;             // a lost point found farther from where it is expected is another one
  double max_reprojection_px = 2.4477;  // square root of the 95 % quantile of chi-square at 2 degrees of freedom
  int min_points = 12;                  // fewer: lost
  int min_corners = 40;                 // fewer in an image: it is no reference
  int top_up_frames = 10;               // while the first map is awaited, corners are added so often
  Switch track_blurred = Switch::kOn;   // into blurred images too; before the first map these are passed over
  double min_sharpness = 0.6;           // by that of the last sharp image: less is blurred, or dark
  int max_blurred_frames = 30;          // in a row: then the blur is taken to stay
  int max_lost_frames = 10;             // after so many lost frames in a row that show something the map is left
  Switch submaps = Switch::kOn;         // another one is begun then; off: the tracker gives up

  // Groups Corners, Masks, LucasKanade, PointTracker, Init, CameraPose, Deformation, Optimization, Tracking, Growth,
  // Relocalization, AbsolutePose, Oracle, and those of the initializers.
  void List(OptionTable& table);
};

// A point whose depth is known before it is tracked.
struct PixelDepth {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double depth = 0;  // z along the optical axis, in its source's unit, > 0
};

// An image made ready: everything that depends on the image alone, so that it can be done ahead on another thread.
struct TrackerFrame {
  int frame_idx = 0;
  std::string name;
  double timestamp_s = 0;
  cv::Mat image;  // 8-bit, 1 or 3 (BGR) channels
  cv::Mat gray;   // CV_8UC1
  ImagePyramid pyramid;
  SupportMask mask;
  cv::Mat depth_mm;  // CV_32FC1 or empty; only a start from depth uses it
  // Instead of corners, the best first; only a start from a model or a pair uses them, when it takes a reference.
  std::function<std::vector<PixelDepth>()> known_points;
  double sharpness = 0;   // of the image, gray levels
  double prepare_ms = 0;  // wall time of PrepareFrame
};

// `image` has the camera's size; `mask` is empty or CV_8UC1 of that size, 0 = ignore.
TrackerFrame PrepareFrame(int frame_idx, std::string name, double timestamp_s, const cv::Mat& image,
                          const cv::Mat& mask, const TrackerOptions& options);

class Tracker {
 public:
  // The stages whose wall times are in every report, in this order.
  static constexpr std::array<std::string_view, 7> kStages = {"prepare", "photometric", "pose",      "agreement",
                                                              "graph",   "joint",       "initialize"};
  // `threads` >= 1 work on one frame; the result does not depend on it. `seed` decides RANSAC's samples.
  // `truth` is what the oracle switches ask; it must be there when one is on, and outlive this.
  // `photometric`: of the camera, where it is known; first maps that listen to the light then trust it.
  Tracker(const Camera& camera, const TrackerOptions& options, std::uint64_t seed, int threads,
          TrackingTruth* truth = nullptr, const std::optional<PhotometricCalibration>& photometric = std::nullopt);
  ~Tracker();

  // Begins with the map that was reported in this frame, in place of a first map of its own: the points that are
  // observed there, at rest where they are new. To be called before any Process; the frames that follow may come in any
  // order of time.
  void TakeMap(const TrackerFrame& frame, const FrameReport& report);

  // The reports that became final with this frame, in order of time; each frame is reported once.
  std::vector<FrameReport> Process(const TrackerFrame& frame);
  // The reports that are held back, in order of time, the last processed frame's last: those since the reference while
  // there is no map, else none. So far they are in state initializing.
  const std::vector<FrameReport>& held() const { return held_; }
  // No frame will follow: while the first map is awaited, a last attempt at one. Its frames come from Finish.
  void EndSequence();
  // To be called when no more frames come, whatever the reason: the reports held back become final as they are.
  std::vector<FrameReport> Finish() { return std::exchange(held_, {}); }

  // Whether the next frames' depth images or known points can be of use: before the first map, when that is to come
  // from them, and while another one may be begun.
  bool WantsDepth() const;
  // Whether the next one's is.
  bool NeedsDepth() const;

  TrackingState state() const { return state_; }
  // Whether there are maps that were left, and neither found again nor joined.
  bool LeftAMap() const { return !inactive_submaps_.empty(); }
  const Map& map() const;
  // Lost for max_lost_frames frames that are neither dark nor frozen, and no new map is to be begun.
  bool GaveUp() const { return LeavesMap() && options_.submaps == Switch::kOff; }

 private:
  struct Followed;  // the landmarks that were followed into a frame, side by side
  struct Submap;    // a map with all that belongs to it

  void Apply(TrackingEvent event) { state_ = NextState(state_, event); }
  void Count(std::string_view reason, int count);
  void ReportLosses(FrameReport* report) const;  // those counted so far

  // Reference and first map.
  void AddCorners(const TrackerFrame& frame, const LocalBrightness& brightness, int max_corners, InitFrame* points);
  void AddKnownPoints(const TrackerFrame& frame, const LocalBrightness& brightness, InitFrame* points);
  void TakeReference(const TrackerFrame& frame, FrameReport* report);
  std::vector<PointPrediction> PredictWithoutMap(int frame_idx) const;
  bool PassOver(const TrackerFrame& frame, FrameReport* report);
  void FollowReference(const TrackerFrame& frame, FrameReport* report);
  InitOutcome AskInitializer(const cv::Mat& depth_mm, InitMoment moment, FrameReport* report);
  InitDecision TryInitialize(const TrackerFrame& frame, FrameReport* report);
  void CreateMap(const InitOutcome& outcome);
  void KeepCandidates(const InitOutcome& outcome);

  // One frame.
  void TrackFrame(const TrackerFrame& frame, FrameReport* report);
  std::vector<PointTrack> TrackPixels(const TrackerFrame& frame, const std::vector<PointPrediction>& predictions);
  bool IsBlurred(const TrackerFrame& frame) const;
  std::vector<PointTrack> TrackPixelsIntoBlur(const TrackerFrame& frame,
                                              const std::vector<PointPrediction>& predictions) const;
  std::optional<Rigid3> KnownPose(int frame_idx) const;
  std::vector<PointPrediction> PredictPixels(const Rigid3& predicted_cam_from_world) const;
  Followed FollowPoints(const TrackerFrame& frame, const std::vector<PointPrediction>& predictions);
  int FindLost(const TrackerFrame& frame, const Rigid3& cam_from_world, Followed* followed);
  DeformationGraph TieNeighbors(const Followed& followed, FrameReport* report) const;
  void DropContradicted(const Rigid3& cam_from_world, const DeformationGraph& graph, Followed* followed);
  void DropUnexplained(Followed* followed);
  void Commit(const FrameSolution& solution, const Followed& followed, FrameReport* report);
  void HoldGauge(FrameReport* report);
  std::string Found(int count) const;
  void ReportLost(const TrackerFrame& frame, const std::string& reason, FrameReport* report);

  // The way back after a loss.
  bool LeavesMap() const { return lost_frames_ >= options_.max_lost_frames; }
  void LeaveMap();
  void FindMapAgain(const TrackerFrame& frame);
  Followed LookFor(std::unique_ptr<Submap>* left, const TrackerFrame& frame, Rigid3* cam_from_world);
  bool JoinsMaps() const;
  void JoinMaps(const TrackerFrame& frame, FrameReport* report);
  std::optional<Sim3> SeenWithPresent(const TrackerFrame& frame, std::unique_ptr<Submap>* left);
  void Remember(const TrackerFrame& frame, const FrameReport& report);
  void RememberLastView();
  std::vector<Landmark> KnownLandmarks() const;
  std::vector<Rigid3> GuessPoses(int frame_idx) const;
  Followed FollowFrom(const TrackerFrame& frame, Rigid3* cam_from_world);
  Followed Relocalize(const TrackerFrame& frame, Rigid3* cam_from_world);

  // The map between frames.
  void DropFromMap(PointId id, FrameReport* report);
  void RefineMap(FrameReport* report);
  bool GrowsMap() const;
  void GrowMap(const TrackerFrame& frame, FrameReport* report);
  void FollowCandidates(const TrackerFrame& frame);
  void Promote(PointId id, const Eigen::Vector3d& position, FrameReport* report);
  void LookForCandidates(const TrackerFrame& frame);
  void RemakeMap(const TrackerFrame& frame, FrameReport* report);
  void DropContradicting(const InitOutcome& outcome, FrameReport* report);
  void DropSlid(std::vector<InitPosition>* remade, FrameReport* report);

  Camera camera_;
  std::optional<PhotometricCalibration> photometric_;
  TrackerOptions options_;
  int threads_;
  std::unique_ptr<Initializer> initializer_;
  std::unique_ptr<OracleAnswers> oracle_;
  std::unique_ptr<MapRemaker> remaker_;

  TrackingState state_ = TrackingState::kWaitingForReference;
  std::vector<InitFrame> init_frames_;  // since the reference
  std::vector<double> known_depths_;    // of the reference's points, where they are known
  std::string image_fault_;             // of the last of them
  std::vector<FrameReport> held_;  // of init_frames_ while initializing; within Process the present frame's is the last
  std::int64_t next_id_ = 0;
  std::unique_ptr<Submap> current_;                        // the present map, or the one that is awaited
  std::vector<std::unique_ptr<Submap>> inactive_submaps_;  // maps that were left, the last one last
  int maps_made_ = 0;                                      // up to now
  int lost_frames_ = 0;
  int blurred_frames_ = 0;                           // in a row, up to now
  std::vector<std::pair<std::string, int>> losses_;  // of the present frame, by reason
  std::unique_ptr<DescribedImage> described_;        // the present frame, once a map was looked for by descriptors
};

}  // namespace pliant
