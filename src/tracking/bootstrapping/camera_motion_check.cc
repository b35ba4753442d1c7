// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/bootstrapping/camera_motion_check.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "pliant/base/text.h"
#include "pliant/estimation/window/still_camera.h"
#include "pliant/scene/frame_report.h"
#include "tracking/bootstrapping/initial_map.h"

namespace pliant {
namespace {

constexpr double kMinSignificance = 3.0;      // standard errors
constexpr double kMinParallaxByError = 10.0;  // of a rigid scene: two views alone then know depths to 14 %

// The frames that no model was fitted to, of which there may be none in a short window: then all but the reference.
std::vector<int> ComparedFrames(std::size_t frames, const std::vector<std::size_t>& views) {
  std::vector<int> between;
  std::vector<int> all;
  for (std::size_t k = 1; k < frames; ++k) {
    all.push_back(static_cast<int>(k));
    if (!std::binary_search(views.begin(), views.end(), k)) between.push_back(static_cast<int>(k));
  }
  return between.empty() ? all : between;
}

// Of the points' directions from the reference and from the view where they differ most, in the median: pixels.
double LargestParallaxPx(const DeformingWindow& window, double focal_px) {
  double largest = 0;
  for (const Rigid3& cam_from_world : window.cams_from_world)
    largest = std::max(largest, focal_px * MedianParallaxRad(window, cam_from_world));
  return largest;
}

Status CheckRigidMotion(const DeformingWindow& window, double focal_px, double median_error_px) {
  const double parallax_px = LargestParallaxPx(window, focal_px);
  if (parallax_px >= kMinParallaxByError * median_error_px) return Status::Ok();
  return {ErrorCode::kDegenerate, "a median parallax of " + Digits(parallax_px, 1) +
                                      " px does not stand out from errors of " + Digits(median_error_px, 2) +
                                      " px: the camera hardly moves, or only turns; move it sideways or forwards"};
}

// (W18) Where noise is most of both errors their ratio is near 1, whatever the camera does. Depths then show its
// motion: before a camera that stands still they are as uncertain as they differ.
bool MovesByDepth(const CameraMotionEvidence& evidence, const InitMeasurements& measured) {
  return evidence.moving_leaves_noise && evidence.significance >= kMinSignificance &&
         measured.DepthSignal() >= kMinDepthSignal;
}

}  // namespace

Status CheckCameraMotion(const InitInput& input, const SolvedWindow& chosen, const WindowInitOptions& options,
                         InitOutcome* outcome) {
  const double focal_px = input.camera.MeanFocalLengthPx();
  if (chosen.IsRigid()) {
    Status status = CheckRigidMotion(chosen.solution.window, focal_px, outcome->measured.median_error_px);
    if (!status.ok() || chosen.deforming == nullptr) return status;
  }
  if (options.min_still_camera_ratio <= 0.0) return Status::Ok();
  const SolvedWindow& window = chosen.IsRigid() ? *chosen.deforming : chosen;
  auto models = SolveCameraMotionModels(window.solution, focal_px, options.window, input.threads);
  if (!models.ok()) return models.status();
  std::vector<PointId> ids;
  for (const int i : models->point_idxs) ids.push_back(window.ids[static_cast<std::size_t>(i)]);
  for (DeformingWindow* model : {&models->moving, &models->still}) {
    auto all = OptimizeDeformingViews(InAllFrames(input, window.views, *model, ids, options), focal_px, options.window,
                                      input.threads);
    if (!all.ok()) return all.status();
    *model = std::move(*all);
  }
  const CameraMotionEvidence evidence = EvidenceOfCameraMotion(
      *models, ComparedFrames(input.frames.size(), window.views), options.window.patch_px / focal_px);
  const double ratio = evidence.error_ratio;
  outcome->measured.still_camera_error_ratio = ratio;
  const bool is_clear = ratio >= options.min_still_camera_ratio;
  outcome->camera_may_stand_still = !is_clear && evidence.significance < kMinSignificance;
  outcome->moves_by_depth =
      !is_clear && !chosen.IsRigid() && !input.camera_may_stand_still && MovesByDepth(evidence, outcome->measured);
  outcome->ambiguous = !is_clear && !outcome->moves_by_depth;
  if (!outcome->ambiguous) return Status::Ok();
  return {ErrorCode::kDegenerate,
          "camera and scene cannot be told apart: with a camera that stands still the errors are " + Digits(ratio, 2) +
              " times as large, and they must be " + Digits(options.min_still_camera_ratio, 2) +
              " times as large to show that it moves; move it further and not evenly, or, if it does stand still, "
              "start from depth (--Init.method depth or depth_prior, with --Tracking.camera_motion none)"};
}

}  // namespace pliant
