// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/bootstrapping/rotation_check.h"

#include <string>

#include "pliant/base/text.h"

namespace pliant {
namespace {

// A rotation that explains this share of the points to this error leaves nothing to triangulate.
constexpr double kRotationErrorPx = 1.5;
constexpr double kMaxRotationShare = 0.8;

}  // namespace

Status CheckIsFollowed(const InitInput& input) {
  if (input.frames.back().observations.empty()) return {ErrorCode::kInsufficient, "all points were lost"};
  if (input.frames.size() == 1 && input.moment == InitMoment::kLastFrame)
    return {ErrorCode::kInsufficient, "no image follows the reference"};
  return Status::Ok();
}

Result<RotationFit> CheckNotARotation(const MatchedRays& matched, double focal_px, double max_error_px,
                                      double max_share, InitMeasurements* measured) {
  auto rotation = FitRotation(matched.rays0, matched.rays1, focal_px, max_error_px);
  if (!rotation.ok()) return rotation;
  measured->rotation_only_share = static_cast<double>(rotation->num_inliers) / static_cast<double>(matched.ids.size());
  if (measured->rotation_only_share <= max_share) return rotation;
  return {ErrorCode::kDegenerate, "the camera rotated or stood still: a rotation alone explains " +
                                      Percent(measured->rotation_only_share) + " of the points to " +
                                      Digits(max_error_px, 1) + " px; move it sideways or forwards"};
}

Status CheckWindowNotARotation(const InitInput& input, InitMeasurements* measured) {
  const MatchedRays matched = MatchRays(input.camera, input.frames.front(), input.frames.back());
  measured->correspondences = static_cast<int>(matched.ids.size());
  return CheckNotARotation(matched, input.camera.MeanFocalLengthPx(), kRotationErrorPx, kMaxRotationShare, measured)
      .status();
}

}  // namespace pliant
