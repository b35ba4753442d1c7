// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/first_map_error.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

// Shorter ways have no direction: the digits of a trajectory file end here.
constexpr double kStillLength = 1e-5;

RelativeDepthFigures Figures(const std::vector<double>& ratios) {
  const double median = Median(ratios);
  RelativeDepthFigures figures;
  if (median > 0) figures.scale = 1 / median;
  std::vector<double> errors;
  errors.reserve(ratios.size());
  for (const double ratio : ratios) errors.push_back(std::abs(figures.scale * ratio - 1));
  figures.rmse = Rms(errors);
  figures.p90 = Quantile(errors, 0.9);
  figures.median = Median(std::move(errors));
  return figures;
}

// Nothing where the frame has no pair.
std::optional<FirstMapDepth> DepthOf(const std::optional<PairedFrame>& frame) {
  if (!frame || frame->pairs.empty()) return std::nullopt;
  std::vector<double> estimates;
  std::vector<double> nulls;
  for (const PointPair& pair : frame->pairs) {
    estimates.push_back(pair.estimate.z() / pair.truth.z());
    nulls.push_back(1 / pair.truth.z());
  }
  return FirstMapDepth{frame->frame_idx, static_cast<int>(estimates.size()), frame->left_out, Figures(estimates),
                       Figures(nulls)};
}

FirstMapMotion CompareMotion(const PosePair& reference, const PosePair& declared) {
  const Rigid3 motion = reference.world_from_cam.Inverse() * declared.world_from_cam;
  const Rigid3 true_motion = reference.true_world_from_cam.Inverse() * declared.true_world_from_cam;
  FirstMapMotion error;
  error.rotation_error_deg = kDegPerRad * RotationAngle(true_motion.rotation.conjugate() * motion.rotation);
  error.true_rotation_deg = kDegPerRad * RotationAngle(true_motion.rotation);
  error.true_translation_mm = true_motion.translation.norm();
  if (motion.translation.norm() > kStillLength && error.true_translation_mm > kStillLength)
    error.direction_error_deg = kDegPerRad * std::atan2(motion.translation.cross(true_motion.translation).norm(),
                                                        motion.translation.dot(true_motion.translation));
  return error;
}

void CountFrames(std::span<const EvaluationFrame> frames, FirstMapError* error) {
  for (const EvaluationFrame& frame : frames) {
    if (frame.frame_idx > error->frames.declared_frame_idx) break;
    error->initialize_total_ms += frame.initialize_ms;
    error->initialize_largest_ms = std::max(error->initialize_largest_ms, frame.initialize_ms);
    if (frame.frame_idx > error->frames.reference_frame_idx) ++error->frames_waited;
    if (frame.frame_idx < error->frames.declared_frame_idx) ++error->frames_before;
  }
}

}  // namespace

std::optional<FirstMapFrames> FindFirstMap(std::span<const EvaluationFrame> frames) {
  for (const EvaluationFrame& frame : frames)
    if (frame.first_map) return frame.first_map;
  return std::nullopt;
}

Result<FirstMapError> ComputeFirstMapError(std::span<const EvaluationFrame> frames, const FirstMapTruth& reference,
                                           const FirstMapTruth& declared) {
  const std::optional<FirstMapFrames> first_map = FindFirstMap(frames);
  if (!first_map)
    return Status(ErrorCode::kNotFound,
                  "the run does not say in which frame its first map was made (first_map in run.json)");
  const std::string frame_text = "frame " + std::to_string(first_map->declared_frame_idx) + ", in which it was made";
  if (!declared.surface) return Status(ErrorCode::kNotFound, "the sequence has no depth for " + frame_text);
  const std::optional<FirstMapDepth> depth = DepthOf(declared.surface);
  if (!depth)
    return Status(ErrorCode::kInsufficient, "no point of it has a true depth in " + frame_text + ": of " +
                                                std::to_string(declared.surface->left_out.Total()) + " observations " +
                                                Describe(declared.surface->left_out));
  FirstMapError error;
  error.frames = *first_map;
  error.declared = *depth;
  error.reference = DepthOf(reference.surface);
  if (reference.poses && declared.poses && first_map->reference_frame_idx != first_map->declared_frame_idx)
    error.motion = CompareMotion(*reference.poses, *declared.poses);
  CountFrames(frames, &error);
  return error;
}

}  // namespace pliant
