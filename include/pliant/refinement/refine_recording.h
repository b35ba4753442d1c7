// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Bundle adjustment of a whole recording of a scene that may deform: all poses, all points and the motion of the scene,
// together (docs/method.md, eq. F1 to F7). Tracking is causal; here a point's depth and motion follow from all frames
// that saw it, before and after.
//
// The scene moves as in the window of a first map (pliant/estimation/window/deforming_window.h): by temporal
// coefficients that all points share, and basis shapes that are alike at neighboring points. A motion common to all
// points is attributed to the camera. A rigid recording has neither, and the problem is plain bundle adjustment.
#pragma once

#include <array>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/scene/frame_report.h"

namespace pliant {

enum class RefinementModel {
  kAuto,       // rigid where the residuals of neighbors are not alike in the rigid solution (W11), else deforming
  kRigid,      // plain bundle adjustment
  kDeforming,  // with temporal coefficients and basis shapes
};
template <>
struct EnumNames<RefinementModel> {
  static constexpr std::array kNames = {std::pair{RefinementModel::kAuto, std::string_view("auto")},
                                        std::pair{RefinementModel::kRigid, std::string_view("rigid")},
                                        std::pair{RefinementModel::kDeforming, std::string_view("deforming")}};
};

// Whether the focal length is estimated, too (pliant/refinement/self_calibration.h).
enum class FocalLength {
  kAuto,  // of a camera that was assumed
  kHeld,
  kEstimated,
};
template <>
struct EnumNames<FocalLength> {
  static constexpr std::array kNames = {std::pair{FocalLength::kAuto, std::string_view("auto")},
                                        std::pair{FocalLength::kHeld, std::string_view("held")},
                                        std::pair{FocalLength::kEstimated, std::string_view("estimated")}};
};

struct RefineOptions {
  RefinementModel model = RefinementModel::kAuto;
  double max_correlation = 0.2;  // of neighbors' residuals in the rigid solution (W11), up to which the scene is rigid
  int max_iterations = 30;       // of one solution
  int rank = 3;                  // R, basis shapes, at first
  int max_rank = 5;              // two more are tried as long as neighbors' residuals are alike, up to this
  int nodes_in_view = 24;        // of the surface, in the mean over the views
  int views_per_track = 40;      // of the median track, that are solved for together; the others after them
  int neighbors = 6;             // nodes that a node's basis shapes are compared with
  FocalLength focal_length = FocalLength::kAuto;  // of a run's camera; RefineRecording holds it

  void List(OptionTable& table);  // group "Refine"
};

struct RecordedObservation {
  int view_idx = 0;
  int point_idx = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();     // where it was measured
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // the point in this view, world frame, map units
};

// One submap of a run: views are its tracked frames.
struct Recording {
  std::vector<double> times;                      // of the views, in frames, ascending
  std::vector<Rigid3> cams_from_world;            // a view each
  std::vector<Eigen::Vector3d> rest_positions;    // of the points, world frame, map units
  std::vector<RecordedObservation> observations;  // sorted by view
  double patch_px = 15;                           // side of a tracked patch, in the camera's pixels
  double log_depth_sigma = 0.3;                   // (F7) of the points' distances, by other than these pixels
  int measured_view_idx = -1;  // (F7) where distances were measured by other than these pixels; -1: nowhere
};

struct RefinedRecording {
  Recording recording;  // everything that is solved for; world and unit are those of the start
  // An observation each: whether it had a part in the solution, as those of wrong tracks, of points seen in fewer than
  // three views and of views that see fewer than four points had not.
  std::vector<bool> is_inlier;
  // An observation each: standard deviation of the point's distance from the camera, map units; 0: not known, or no
  // inlier.
  std::vector<double> sigmas;
  std::vector<PoseCovariance> pose_covariances;  // of the views, or none; the first is zero, for it is the world
  bool deforming = false;                        // the model that was chosen
  double residual_correlation = 0;  // of neighbors in the rigid solution (W11); 0 where the model was not asked for
  double noise_px = 0;              // standard deviation of a pixel coordinate, as found
  double initial_cost = 0;          // of the last solution, at its start and end
  double final_cost = 0;
  bool stopped = false;  // by the callback: the solution with fewer shapes
};

// What is known while it goes on; false ends it, with the solution of fewer shapes where there is one.
struct RefinementProgress {
  std::string_view stage;  // "rigid", "deforming", "uncertainty"
  double cost = 0;         // of the last iteration
  double share = 0;        // of the work known to be needed that is done, 0 to 1; falls when more shapes are needed
};
using RefinementCallback = std::function<bool(const RefinementProgress&)>;

// Refines a recording. Fails with kInvalidArgument for indices or numbers that are none, kInsufficient below two views
// or eight points, kDegenerate where there is no usable step, kInterrupted where it is stopped before it is known which
// model is the scene's.
Result<RefinedRecording> RefineRecording(const Camera& camera, const Recording& start, const RefineOptions& options,
                                         const RefinementCallback& callback = {});

}  // namespace pliant
