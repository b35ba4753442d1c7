// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What is reported of one frame. Observers (recorder, progress, viewers) see this and nothing else; it is complete:
// the run folder is written from it alone. A frame before the first map gets its pose and points from that map, so its
// report becomes final only when the map is made, or given up.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/ids.h"
#include "pliant/base/options.h"
#include "pliant/camera/assumed_camera.h"
#include "pliant/camera/camera.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/geometry/sim3.h"
#include "pliant/scene/cost_term.h"

namespace pliant {

enum class TrackingState {
  kWaitingForReference,  // no reference frame yet: too few corners
  kAmbiguous,            // points were followed, but camera and scene cannot be told apart
  kInitializing,         // points are followed; the first map does not exist yet, or never came
  kTracking,             // pose and deformation of this frame are known, if only since a later frame made the map
  kProvisional,          // the same by a map that is less certain than demanded, or hardly better than one depth
  kLost,                 // too few points are left
};

template <>
struct EnumNames<TrackingState> {
  static constexpr std::array kNames = {
      std::pair{TrackingState::kWaitingForReference, std::string_view("waiting_for_reference")},
      std::pair{TrackingState::kInitializing, std::string_view("initializing")},
      std::pair{TrackingState::kAmbiguous, std::string_view("ambiguous")},
      std::pair{TrackingState::kTracking, std::string_view("tracking")},
      std::pair{TrackingState::kProvisional, std::string_view("provisional")},
      std::pair{TrackingState::kLost, std::string_view("lost")}};
};

// Whether a frame in this state has a pose and points.
constexpr bool HasPose(TrackingState state) {
  return state == TrackingState::kTracking || state == TrackingState::kProvisional;
}

// One point seen in one frame.
struct PointObservation {
  PointId id;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();     // where it was measured
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // where the point was IN THIS FRAME, world frame, map units
  double ssim = 0;                                     // similarity to its reference patch, at most 1
  double sigma = 0;  // standard deviation of its distance from the camera, map units; 0: not known
};

// How far it was measured from where a camera at this pose should see it; nothing where it does not project.
std::optional<double> ReprojectionErrorPx(const Camera& camera, const Rigid3& cam_from_world,
                                          const PointObservation& observation);
// Over the observations that project; 0 where there are none.
double MedianReprojectionErrorPx(const Camera& camera, const Rigid3& cam_from_world,
                                 const std::vector<PointObservation>& observations);

// A point that this frame added to the map.
struct NewPoint {
  PointId id;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // undeformed, world frame, map units
  std::array<std::uint8_t, 3> rgb = {128, 128, 128};
};

// A point of the map whose undeformed position has become better known.
struct RefinedPoint {
  PointId id;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // undeformed, world frame, map units
};

// (W15) How far depths stand out from their uncertainty: their spread by their standard deviation, both by the median
// depth; 0 where the latter was not measured.
inline double DepthSignal(double spread, double sigma) { return sigma > 0 ? spread / sigma : 0.0; }

// Below it depths are hardly better known than by one constant depth.
inline constexpr double kMinDepthSignal = 3.0;
// The same for a map that is provisional.
inline constexpr double kMinProvisionalSignal = 2.0;
// Median parallax from which depths that are not known do not lack motion of the camera.
inline constexpr double kEnoughParallaxDeg = 3.0;
// What to do about depths that are not certain with that parallax: the last clause of a sentence.
std::string AdviceOnUncertainDepth(double median_parallax_deg, CameraOrigin camera_origin = CameraOrigin::kGiven);

// What a first map rests on, as it was measured when it was made; 0 where its method does not measure it.
struct FirstMapEvidence {
  bool provisional = false;  // less certain than demanded, or hardly better than one constant depth
  bool deforming = false;    // the scene deformed, by the model that was chosen
  int points = 0;
  double median_parallax_deg = 0;       // between the reference and the last frame of the window
  double median_error_px = 0;           // reprojection error of a point, root mean square over its frames
  double depth_sigma = 0;               // standard deviation of a depth by the median depth; median over points
  double depth_spread = 0;              // the error of one constant depth: median of |log(depth / median depth)| (W15)
  double still_camera_error_ratio = 0;  // errors of a camera that stands still by those of one that moves (W14)
  double focal_length_factor = 1;  // on the calibration's, with which a rigid scene fits clearly better (W16); 1: none
  bool moves_by_depth = false;     // that ratio does not show that the camera moves, but the depths do (W18)
  bool uses_prior = false;         // its depths are by a depth prior, too
};

// From which frame to which a first map was made; these and all between have their poses and points from it.
struct FirstMapFrames {
  int reference_frame_idx = 0;  // whose camera is the world
  int declared_frame_idx = 0;   // in which the map was made; tracking goes on from here
  FirstMapEvidence evidence = {};
};

// Two submaps have become one: everything reported of `submap` up to this frame goes into the world of `into`; the
// frames that follow are reported in `into`.
struct SubmapMerge {
  int submap = 0;
  int into = 0;  // the older one
  Sim3 into_from_submap;
};

// Whether a depth prior says the same of points' depths as what else says them (N4).
enum class PriorAgreement {
  kUnclear,
  kAgrees,
  kFalls,  // where they grow, as a prior of the other kind (DepthPrior.kind) does
};

// The depth prior of a frame.
struct FramePrior {
  std::optional<PriorAgreement> agreement = std::nullopt;  // nothing: there is none, or too little to compare it with
  bool by_brightness = false;                              // with depths by brightness; else by the map
  bool is_used = false;  // its depths, and those of frames before, by the map that was re-estimated in this frame
};

// Of a camera's center (world frame, map units) and its rotation (rad, camera frame).
using PoseCovariance = Eigen::Matrix<double, 6, 6>;

struct FrameReport {
  int frame_idx = 0;  // the sequence's own number
  std::string name;   // image name
  double timestamp_s = 0;
  TrackingState state = TrackingState::kWaitingForReference;
  std::string note;  // why the state is what it is, where there is something to say; one sentence, else empty
  // Which map the frame belongs to, counted from 0: each has its own world and unit. Of a frame that has no pose, the
  // map that is there, or awaited.
  int submap = 0;
  std::optional<SubmapMerge> merge;  // where there is a pose; the frame itself is still reported as before it

  std::optional<Rigid3> cam_from_world;           // exactly in states tracking and provisional
  std::optional<PoseCovariance> pose_covariance;  // where there is a pose and it is known how certain it is
  std::vector<PointObservation> observations;     // where there is a pose; sorted by id
  std::vector<NewPoint> new_points;               // sorted by id
  std::vector<RefinedPoint> refined_points;       // sorted by id
  std::optional<FirstMapFrames> first_map;        // where pose and points came with the first map

  int tracked = 0;    // points followed into this frame; before the first map those found in it too
  int optimized = 0;  // points in the joint problem's solution, or in the first map
  int lost = 0;       // points given up in this frame
  int added = 0;      // points new in this frame
  std::vector<std::pair<std::string, int>> losses;  // points given up by reason, in the order of the first of each

  std::vector<CostTerm> costs;  // at the solution; all 0 where there is none
  double median_reprojection_error_px = 0;
  std::optional<double> coverage;  // share of what the image shows of the scene that is near a point (CoverageOf)
  // The same, counting points too that are followed and have no certain depth yet; in a blurred frame these are where
  // the last sharp one had them.
  std::optional<double> followed_coverage;
  FramePrior prior;
  std::vector<std::pair<std::string, double>> stage_ms;  // wall time by stage; fixed order and names
  double latency_ms = 0;  // from the frame's arrival until everything was done that it asked for; 0: not measured
};

}  // namespace pliant
