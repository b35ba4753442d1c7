// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How far the estimated camera path lies from the true one, with the definitions of the evo tools (Grupp, evo, 2017;
// github.com/MichaelGrupp/evo, notebooks/metrics.py_API_Documentation.ipynb), P the aligned estimate, Q the truth:
//   ATE  E_i = Q_i^-1 P_i, its translation and its angle, after the least-squares alignment of the camera centers
//        (Umeyama, PAMI 1991). As evo_ape -as (sim3) or -a (se3), with -r trans_part and -r angle_deg.
//   RPE  E_ij = (Q_i^-1 Q_j)^-1 (P_i^-1 P_j), j = i + delta frames. Aligning changes nothing but its scale. As evo_rpe
//        -as or -a, --delta_unit f; pairs that do not overlap are its default, all pairs are its --all_pairs.
// Part of a scene's deformation is a gauge: what it does as a whole is absorbed by the camera, so read this beside the
// surface error. Millimeters and degrees.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/geometry/alignment.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

enum class TrajectoryAlignment {
  kSim3,  // rotation, translation and scale: maps of a monocular start
  kSe3,   // no scale: maps that claim millimeters
};

template <>
struct EnumNames<TrajectoryAlignment> {
  static constexpr std::array kNames = {std::pair{TrajectoryAlignment::kSim3, std::string_view("sim3")},
                                        std::pair{TrajectoryAlignment::kSe3, std::string_view("se3")}};
};

enum class RelativePairs {
  kConsecutive,  // 0 to d, d to 2 d, ...
  kAll,          // 0 to d, 1 to 1 + d, ...
};

template <>
struct EnumNames<RelativePairs> {
  static constexpr std::array kNames = {std::pair{RelativePairs::kConsecutive, std::string_view("consecutive")},
                                        std::pair{RelativePairs::kAll, std::string_view("all")}};
};

struct TrajectoryErrorOptions {
  TrajectoryAlignment alignment = TrajectoryAlignment::kSim3;
  int rpe_delta = 1;  // tracked frames between the two poses of a relative error
  RelativePairs rpe_pairs = RelativePairs::kConsecutive;

  void List(OptionTable& table);
};

// One frame's pose, estimated and true.
struct PosePair {
  int frame_idx = 0;
  Rigid3 world_from_cam;       // the run's, in map units
  Rigid3 true_world_from_cam;  // the truth, mm
  int submap = 0;              // whose world the run's pose is in
};

struct TrajectoryError {
  TrajectoryAlignment alignment = TrajectoryAlignment::kSim3;
  int poses = 0;    // that are compared
  int submaps = 0;  // that they are in: each is aligned by itself, and has an RPE and a length of its own
  double ate_rmse_mm = 0;
  double ate_mean_mm = 0;
  double ate_median_mm = 0;
  double ate_std_mm = 0;
  double ate_min_mm = 0;
  double ate_max_mm = 0;
  double rotation_rmse_deg = 0;  // of the aligned estimate's rotations
  int rpe_delta = 1;
  int rpe_pairs = 0;  // 0: too short a path for an RPE
  double rpe_translation_rmse_mm = 0;
  double rpe_translation_mean_mm = 0;
  double rpe_rotation_rmse_deg = 0;
  double rpe_rotation_mean_deg = 0;
  double true_path_length_mm = 0;  // over the frames compared
  double path_length_mm = 0;       // of the aligned estimate
  // Standard deviation of the true positions along and across the main direction of their path (first and second
  // principal axis), of the submap with the most poses.
  double true_path_extent_mm = 0;
  double true_path_width_mm = 0;
  // The path is nearly a line, and no wider than a few times the ATE: the turn about it, and so the rotation error, is
  // hardly known.
  bool TurnIsUnknown() const;
  // Without a unit: the ATE by the length of the true path, and the RPE's translation by the mean true step; 0: the
  // path has no length.
  double AteShare() const { return true_path_length_mm > 0 ? ate_rmse_mm / true_path_length_mm : 0; }
  double RpeShare() const {
    return true_path_length_mm > 0 ? rpe_translation_rmse_mm * rpe_pairs / true_path_length_mm : 0;
  }
  Sim3 truth_from_run;         // the alignment of the submap with the most poses
  std::vector<int> frame_idx;  // the frames compared
  std::vector<double> ate_mm;  // of each of them
};

// A submap that cannot be aligned is left out where another can. Fails with kInsufficient below three poses, with
// kDegenerate where either camera never moves.
Result<TrajectoryError> ComputeTrajectoryError(std::span<const PosePair> pairs, const TrajectoryErrorOptions& options);

}  // namespace pliant
