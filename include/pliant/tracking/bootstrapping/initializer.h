// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What makes the first map. An initializer is asked once a frame with everything that was followed since the reference
// frame, and answers: wait, start again from a new reference, or here is the map. It keeps no state between calls.
// World frame: the reference frame's camera. Unit: mm in the sense of a configured nominal depth (monocular maps), or
// true mm (stereo, depth). Another one is a file that implements Initializer.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pliant/base/ids.h"
#include "pliant/camera/assumed_camera.h"
#include "pliant/camera/camera.h"
#include "pliant/camera/photometric_calibration.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/scene/frame_report.h"

namespace pliant {

struct InitObservation {
  PointId id;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double ssim = 1;        // similarity to its reference patch, at most 1
  double brightness = 0;  // of the surface around it, 0 to 255 (LocalBrightness); 0: unknown
  std::array<std::uint8_t, 3> rgb = {128, 128, 128};
  double log_prior = std::numeric_limits<double>::quiet_NaN();  // log distance by a depth prior, up to a constant of
                                                                // the frame; NaN: unknown
};

std::vector<Eigen::Vector2d> PixelsOf(const std::vector<InitObservation>& observations);

struct InitFrame {
  int frame_idx = 0;                          // the sequence's own number
  std::vector<InitObservation> observations;  // sorted by id
};

enum class InitMoment {
  kMoreFollow,  // to wait is a choice
  kLastFrame,   // the sequence ends here
};

struct InitInput {
  const Camera& camera;
  // The reference frame with all its points, then the frames since, in order of time; the last one is the current
  // frame. A point lost on the way is missing from its frame on; one that was added on the way (TakesLaterPoints) is
  // missing before.
  const std::vector<InitFrame>& frames;
  // CV_32FC1, z along the optical axis, 0 = none; empty where there is no depth, and after the reference.
  cv::Mat reference_depth_mm;
  InitMoment moment = InitMoment::kMoreFollow;
  int threads = 1;  // that an initializer may use; they never change its answer
  // z of the reference's points, in their order, in any unit; empty: not known.
  std::vector<double> reference_depths = {};
  std::optional<PhotometricCalibration> photometric = std::nullopt;  // where it is known
  bool camera_may_stand_still = false;  // as an answer since the reference said (InitOutcome)
  bool was_ambiguous = false;           // when another reference, since the last map, was given up (InitOutcome)
  CameraOrigin camera_origin = CameraOrigin::kGiven;
};

enum class InitDecision {
  kWait,          // not yet: `reason` says what is missing and by how much
  kNewReference,  // this reference will not do any more: take the current frame
  kProvisional,   // a provisional map is filled in; a certain one may still come: go back to it if none does
  kMap,           // poses and points are filled in
};

enum class InitRejection {
  kNoRay,           // its pixel has no ray
  kLostOnTheWay,    // not seen in the current frame
  kTooFewViews,     // seen too briefly, or left out where there were too many
  kEpipolar,        // contradicts the motion
  kCheirality,      // behind a camera, or its rays part
  kUncertainDepth,  // depth too uncertain: too little parallax, or another solution as plausible
  kReprojection,    // contradicts the refined map
};
std::string_view InitRejectionName(InitRejection reason);

struct InitPoint {
  PointId id;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // world, in the reference frame
  double depth_sigma = 0;   // predicted standard deviation along the reference ray, map units; 0: not predicted
  double parallax_rad = 0;  // between the reference and the current frame

  double LogDistanceSigma() const { return depth_sigma > 0.0 ? depth_sigma / position.norm() : 0.0; }
};

struct InitPosition {
  PointId id;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // world
};

// One frame of the input as the map explains it.
struct InitFrameState {
  int frame_idx = 0;
  Rigid3 cam_from_world;
  // The map's points that were seen in this frame, each where it was IN THIS FRAME; sorted by id.
  std::vector<InitPosition> positions;
};

struct InitRejectedPoint {
  PointId id;
  InitRejection reason = InitRejection::kNoRay;
};

// What was measured on the way; zero where a step was not reached.
struct InitMeasurements {
  int correspondences = 0;
  int inliers = 0;
  double rotation_only_share = 0;   // correspondences that a pure rotation explains, 0 to 1
  double median_parallax_deg = 0;   // rotation-compensated
  double median_depth_sigma = 0;    // sigma_z / z of the map, predicted or more
  double depth_spread = 0;          // median of |log(depth / median depth)| of the points, or of distances (W15)
  double competing_cost_ratio = 0;  // robust cost of the second best motion over the best one's; infinite: no second
  double median_error_px = 0;       // of the map in its frames
  double still_camera_error_ratio = 0;  // errors of a camera that stands still by those of one that moves; 0: unknown
  double focal_length_factor = 1;       // on the calibration's, with which a rigid scene fits clearly better; 1: none
  double sigma_factor = 1;              // by which a part of the window's frames says that its sigmas are too small

  // (W15), and as a part of the frames has it (W21).
  double LinearDepthSignal() const { return pliant::DepthSignal(depth_spread, median_depth_sigma); }
  double DepthSignal() const { return LinearDepthSignal() / sigma_factor; }
};

struct InitOutcome {
  InitDecision decision = InitDecision::kWait;
  std::string reason;  // one sentence with its numbers; of a map too
  InitMeasurements measured;
  bool ambiguous = false;               // no map, since a camera that stands still explains the images too
  bool camera_may_stand_still = false;  // it explains them as well but for chance, whatever there is no map for
  bool moves_by_depth = false;          // the depths alone show that the camera moves (W18)

  // Filled in for kMap and kProvisional; `deforming` also where a rigid scene was asked for and it is none.
  std::vector<InitFrameState> frames;       // one a frame of the input, in its order; the first pose is the identity
  std::vector<InitPoint> points;            // sorted by id; each is in some of the frames, not in all
  std::vector<InitRejectedPoint> rejected;  // the other points, sorted by id
  // The depths are known hardly better than one constant depth, or to less than was demanded.
  bool provisional = false;
  bool deforming = false;           // the scene deformed, by the model that was chosen
  bool allows_deformation = false;  // of a rigid scene: its sigmas do, though the model does not
  bool refinable = false;           // of a rigid scene: the frames that follow can make it better
  // (W15) Its sigmas are by the points' own distances, and look smaller than those of a map whose are by the median
  // one.
  bool far_by_own_distance = false;
  bool uses_prior = false;  // its depths are by a depth prior, too
};

inline constexpr int kFewestPoints = 12;  // that a map is made of, whoever follows them

class Initializer {
 public:
  virtual ~Initializer() = default;
  virtual std::string_view name() const = 0;
  virtual InitOutcome Try(const InitInput& input) const = 0;
  // Whether points that are first seen after the reference are of use.
  virtual bool TakesLaterPoints() const { return false; }
  // Whether the reference's points are those whose depths are known (InitInput::reference_depths), in place of corners.
  virtual bool TakesKnownPoints() const { return false; }
};

}  // namespace pliant
