// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/trajectory_error.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "pliant/base/statistics.h"
#include "pliant/geometry/decompositions.h"

namespace pliant {
namespace {

double AngleDeg(const Eigen::Quaterniond& rotation) { return kDegPerRad * RotationAngle(rotation); }

double PathLength(std::span<const Rigid3> poses) {
  double length = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) length += (poses[i].translation - poses[i - 1].translation).norm();
  return length;
}

// The estimate moved and scaled into the truth's frame.
Rigid3 Aligned(const Sim3& truth_from_run, const Rigid3& world_from_cam) {
  return {truth_from_run.rotation * world_from_cam.rotation, truth_from_run * world_from_cam.translation};
}

// What the submaps together give.
struct Pooled {
  std::vector<double> rotations_deg;
  std::vector<double> relative_mm;
  std::vector<double> relative_deg;
};

void AddRelativeErrors(std::span<const Rigid3> aligned, std::span<const Rigid3> truth,
                       const TrajectoryErrorOptions& options, Pooled* pooled) {
  const auto delta = static_cast<std::size_t>(options.rpe_delta);
  const std::size_t step = options.rpe_pairs == RelativePairs::kAll ? 1 : delta;
  for (std::size_t i = 0; i + delta < truth.size(); i += step) {
    const Rigid3 true_motion = truth[i].Inverse() * truth[i + delta];
    const Rigid3 motion = aligned[i].Inverse() * aligned[i + delta];
    const Rigid3 difference = true_motion.Inverse() * motion;
    pooled->relative_mm.push_back(difference.translation.norm());
    pooled->relative_deg.push_back(AngleDeg(difference.rotation));
  }
}

Result<Sim3> Align(std::span<const PosePair> pairs, TrajectoryAlignment alignment) {
  if (pairs.size() < 3)
    return Status(ErrorCode::kInsufficient, "a camera path is compared from three poses on; " +
                                                std::to_string(pairs.size()) + " tracked frames have a true pose");
  std::vector<Eigen::Vector3d> run_centers;
  std::vector<Eigen::Vector3d> true_centers;
  for (const PosePair& pair : pairs) {
    run_centers.push_back(pair.world_from_cam.translation);
    true_centers.push_back(pair.true_world_from_cam.translation);
  }
  Result<Sim3> truth_from_run =
      AlignPoints(run_centers, true_centers,
                  alignment == TrajectoryAlignment::kSim3 ? AlignmentScale::kEstimated : AlignmentScale::kFixedAtOne);
  if (truth_from_run.ok()) return truth_from_run;
  return Status(truth_from_run.status().code(),
                "the camera paths cannot be aligned, since one of the two cameras does not move (" +
                    truth_from_run.status().message() + "); read the surface error alone");
}

// Variances of the true positions along their principal axes, the smallest first.
Eigen::Vector3d Spread(std::span<const PosePair> pairs) {
  Eigen::Matrix3Xd centers(3, static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i)
    centers.col(static_cast<Eigen::Index>(i)) = pairs[i].true_world_from_cam.translation;
  centers.colwise() -= Eigen::Vector3d(centers.rowwise().mean());
  const Eigen::Matrix3d spread = centers * centers.transpose() / static_cast<double>(pairs.size());
  return EigenOfSymmetric(spread).values.cwiseMax(0.0);
}

void AddSubmap(std::span<const PosePair> pairs, const Sim3& truth_from_run, const TrajectoryErrorOptions& options,
               TrajectoryError* error, Pooled* pooled) {
  std::vector<Rigid3> aligned;
  std::vector<Rigid3> truth;
  for (const PosePair& pair : pairs) {
    truth.push_back(pair.true_world_from_cam);
    aligned.push_back(Aligned(truth_from_run, pair.world_from_cam));
    error->frame_idx.push_back(pair.frame_idx);
    error->ate_mm.push_back((aligned.back().translation - truth.back().translation).norm());
    pooled->rotations_deg.push_back(AngleDeg(truth.back().rotation.conjugate() * aligned.back().rotation));
  }
  error->true_path_length_mm += PathLength(truth);
  error->path_length_mm += PathLength(aligned);
  AddRelativeErrors(aligned, truth, options, pooled);
  ++error->submaps;
}

}  // namespace

bool TrajectoryError::TurnIsUnknown() const {
  constexpr double kStraight = 0.1;
  constexpr double kWithinError = 3.0;
  return true_path_width_mm <= kStraight * true_path_extent_mm && true_path_width_mm <= kWithinError * ate_rmse_mm;
}

void TrajectoryErrorOptions::List(OptionTable& table) {
  table.AddChoice("alignment", &alignment, "how the path is laid onto the true one: sim3 after a monocular start");
  table.Add("rpe_delta", &rpe_delta, "frames", "tracked frames between the two poses of a relative error", 1, 100000);
  table.AddChoice("rpe_pairs", &rpe_pairs, "which pairs: consecutive as evo_rpe does, all as its --all_pairs");
}

Result<TrajectoryError> ComputeTrajectoryError(std::span<const PosePair> pairs, const TrajectoryErrorOptions& options) {
  TrajectoryError error;
  error.alignment = options.alignment;
  error.rpe_delta = options.rpe_delta;
  Pooled pooled;
  Status failure(ErrorCode::kInsufficient, "a camera path is compared from three poses on; there is none");
  std::map<int, std::vector<PosePair>> submaps;
  for (const PosePair& pair : pairs) submaps[pair.submap].push_back(pair);
  std::size_t most = 0;
  for (const auto& [idx, submap] : submaps) {
    const Result<Sim3> truth_from_run = Align(submap, options.alignment);
    if (!truth_from_run.ok()) {
      failure = truth_from_run.status();
      continue;
    }
    AddSubmap(submap, *truth_from_run, options, &error, &pooled);
    if (submap.size() > most) {
      error.truth_from_run = *truth_from_run;
      const Eigen::Vector3d spread = Spread(submap);
      error.true_path_extent_mm = std::sqrt(spread[2]);
      error.true_path_width_mm = std::sqrt(spread[1]);
    }
    most = std::max(most, submap.size());
  }
  if (error.submaps == 0) return failure;
  error.poses = static_cast<int>(error.ate_mm.size());
  error.ate_rmse_mm = Rms(error.ate_mm);
  error.ate_mean_mm = Mean(error.ate_mm);
  error.ate_std_mm =
      std::sqrt(std::max(0.0, error.ate_rmse_mm * error.ate_rmse_mm - error.ate_mean_mm * error.ate_mean_mm));
  error.ate_min_mm = *std::min_element(error.ate_mm.begin(), error.ate_mm.end());
  error.ate_median_mm = Median(error.ate_mm);
  error.ate_max_mm = *std::max_element(error.ate_mm.begin(), error.ate_mm.end());
  error.rotation_rmse_deg = Rms(pooled.rotations_deg);
  error.rpe_pairs = static_cast<int>(pooled.relative_mm.size());
  error.rpe_translation_rmse_mm = Rms(pooled.relative_mm);
  error.rpe_translation_mean_mm = Mean(pooled.relative_mm);
  error.rpe_rotation_rmse_deg = Rms(pooled.relative_deg);
  error.rpe_rotation_mean_deg = Mean(pooled.relative_deg);
  return error;
}

}  // namespace pliant
