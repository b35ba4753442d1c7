// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/calibration/calibrate_stereo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "calibration/board_problem.h"
#include "calibration/board_residual.h"
#include "pliant/base/parallel.h"
#include "pliant/base/statistics.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

constexpr double kShortestBaseline = 1e-3;  // by the distance of the board

constexpr std::size_t kMostParams = OpenCv::kNumParams;
using CameraParams = std::array<double, kMostParams>;  // fewer of a smaller model

// What all pairs share is in one piece of memory: Ceres orders it by address, on which the last digits depend.
struct StereoFit {
  CameraModelId left_model = CameraModelId::kPinhole;
  CameraModelId right_model = CameraModelId::kPinhole;
  CameraParams left_params = {};
  CameraParams right_params = {};
  BoardPose right_from_left = {};
  std::vector<BoardPose> left_from_board;  // a pair each
};

CameraParams ToArray(const std::vector<double>& params) {
  CameraParams array = {};
  std::copy(params.begin(), params.end(), array.begin());
  return array;
}

std::vector<double> ToVector(CameraModelId model, const CameraParams& params) {
  return {params.begin(), params.begin() + NumParams(model)};
}

struct StereoInput {
  std::vector<Eigen::Vector3d> points;
  std::vector<BoardView> left;
  std::vector<BoardView> right;
};

// The poses of the board before one camera alone.
std::optional<BoardFit> FitAlone(const Camera& camera, const std::vector<Eigen::Vector3d>& points,
                                 std::span<const BoardView> views) {
  const std::span<const double> params = camera.params();
  BoardFit fit{camera.model_id(), {params.begin(), params.end()}, static_cast<int>(params.size()), {}};
  if (!StartPoses(camera, points, views, &fit.poses)) return std::nullopt;
  if (!Solve(points, views, {}, Intrinsics::kHeld, kMaxIterations, &fit)) return std::nullopt;
  return fit;
}

// The same points, the last one first.
BoardView Turned(const BoardView& view, int num_points) {
  BoardView turned;
  for (std::size_t i = view.pixels.size(); i-- > 0;) {
    turned.point_ids.push_back(num_points - 1 - view.point_ids[i]);
    turned.pixels.push_back(view.pixels[i]);
  }
  return turned;
}

// The board's pose when its points are counted from the other end.
Rigid3 Turned(const Rigid3& cam_from_board, const std::vector<Eigen::Vector3d>& points) {
  const Eigen::Vector3d center = 0.5 * (points.front() + points.back());
  const Eigen::Quaterniond half_turn(0, 0, 0, 1);
  return cam_from_board * Rigid3(half_turn, center - half_turn * center);
}

bool LooksTheSameTurned(const CalibrationBoard& board) {
  return board.kind == BoardKind::kChessboard || board.kind == BoardKind::kCircles;
}

// What the right camera's pose in the left one is by each pair alone, with the right view as it is, or turned.
struct PairPoses {
  std::vector<Rigid3> as_given;
  std::vector<Rigid3> turned;  // empty: the board cannot be
};

// How far two of these poses move the board apart, mm.
double Distance(const Rigid3& a, const Rigid3& b, double depth_mm) {
  return (a.translation - b.translation).norm() + depth_mm * RotationAngle(a.rotation * b.rotation.conjugate());
}

// The pose that most pairs agree on.
Rigid3 Consensus(const PairPoses& poses, double depth_mm) {
  std::vector<Rigid3> candidates = poses.as_given;
  candidates.insert(candidates.end(), poses.turned.begin(), poses.turned.end());
  double best = std::numeric_limits<double>::infinity();
  Rigid3 consensus;
  for (const Rigid3& candidate : candidates) {
    std::vector<double> distances;
    for (std::size_t i = 0; i < poses.as_given.size(); ++i) {
      double distance = Distance(candidate, poses.as_given[i], depth_mm);
      if (!poses.turned.empty()) distance = std::min(distance, Distance(candidate, poses.turned[i], depth_mm));
      distances.push_back(distance);
    }
    if (const double median = Median(distances); median < best) {
      best = median;
      consensus = candidate;
    }
  }
  return consensus;
}

// The right camera's residual at a point of a pair; infinite where it cannot be projected.
Eigen::Vector2d RightResidual(const StereoFit& fit, const Eigen::Vector3d& point, const Eigen::Vector2d& pixel,
                              const BoardPose& left_from_board) {
  Eigen::Vector2d residual;
  const bool is_seen = WithModel(fit.right_model, [&]<class Model>() {
    return RightBoardResidual<Model>{point, pixel}(fit.right_params.data(), left_from_board.data(),
                                                   fit.right_from_left.data(), residual.data());
  });
  if (!is_seen) residual.setConstant(std::numeric_limits<double>::infinity());
  return residual;
}

std::vector<Eigen::Vector2d> PairResiduals(const StereoInput& input, const StereoFit& fit, std::size_t pair) {
  const BoardFit left{fit.left_model, ToVector(fit.left_model, fit.left_params), 0, {}};
  const BoardPose& pose = fit.left_from_board[pair];
  std::vector<Eigen::Vector2d> residuals = Residuals(input.points, input.left[pair], left, pose);
  const BoardView& right = input.right[pair];
  for (std::size_t i = 0; i < right.pixels.size(); ++i)
    residuals.push_back(
        RightResidual(fit, input.points[static_cast<std::size_t>(right.point_ids[i])], right.pixels[i], pose));
  return residuals;
}

double PairRms(const StereoInput& input, const StereoFit& fit, std::size_t pair) {
  return RmsLength(PairResiduals(input, fit, pair));
}

// Of all pairs that count.
std::vector<Eigen::Vector2d> AllResiduals(const StereoInput& input, const std::vector<bool>& without,
                                          const StereoFit& fit) {
  std::vector<Eigen::Vector2d> all;
  for (std::size_t pair = 0; pair < input.left.size(); ++pair) {
    if (without[pair]) continue;
    const std::vector<Eigen::Vector2d> residuals = PairResiduals(input, fit, pair);
    all.insert(all.end(), residuals.begin(), residuals.end());
  }
  return all;
}

void AddPair(const StereoInput& input, std::size_t pair, ceres::LossFunction* loss, StereoFit* fit,
             ceres::Problem* problem) {
  double* const pose = fit->left_from_board[pair].data();
  const BoardView& left = input.left[pair];
  for (std::size_t i = 0; i < left.pixels.size(); ++i)
    problem->AddResidualBlock(
        MakeBoardResidual(fit->left_model, input.points[static_cast<std::size_t>(left.point_ids[i])], left.pixels[i]),
        loss, fit->left_params.data(), pose);
  const BoardView& right = input.right[pair];
  for (std::size_t i = 0; i < right.pixels.size(); ++i) {
    const Eigen::Vector3d& point = input.points[static_cast<std::size_t>(right.point_ids[i])];
    ceres::CostFunction* const residual = WithModel(fit->right_model, [&]<class Model>() -> ceres::CostFunction* {
      return new ceres::AutoDiffCostFunction<RightBoardResidual<Model>, 2, Model::kNumParams, 6, 6>(
          new RightBoardResidual<Model>{point, right.pixels[i]});
    });
    problem->AddResidualBlock(residual, loss, fit->right_params.data(), pose, fit->right_from_left.data());
  }
}

bool SolvePairs(const StereoInput& input, const std::vector<bool>& without, StereoFit* fit) {
  const auto build = [&](ceres::LossFunction* loss, ceres::Problem* problem, ceres::Solver::Options* options) {
    options->linear_solver_type = ceres::DENSE_SCHUR;
    options->linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (std::size_t pair = 0; pair < input.left.size(); ++pair) {
      if (without[pair]) continue;
      AddPair(input, pair, loss, fit, problem);
      options->linear_solver_ordering->AddElementToGroup(fit->left_from_board[pair].data(), 0);
    }
    for (double* block : {fit->left_params.data(), fit->right_params.data(), fit->right_from_left.data()})
      options->linear_solver_ordering->AddElementToGroup(block, 1);
  };
  return SolveRobustly(
      kMaxIterations, [&] { return CoordinateSigma(AllResiduals(input, without, *fit)); }, build);
}

struct MountSigmas {
  double baseline_mm = 0;
  double rotation_deg = 0;
};

// By fits without one group of pairs after the other.
std::optional<MountSigmas> JackknifeSigmas(const StereoInput& input, const std::vector<bool>& outliers,
                                           const StereoFit& fit, int threads) {
  std::vector<std::size_t> used;
  for (std::size_t pair = 0; pair < outliers.size(); ++pair)
    if (!outliers[pair]) used.push_back(pair);
  const auto groups = std::min<std::size_t>(kMaxGroups, used.size());
  std::vector<std::optional<Rigid3>> mounts(groups);
  ParallelFor(
      static_cast<int>(groups), threads,
      [&](int group) {
        std::vector<bool> without = outliers;
        for (std::size_t i = static_cast<std::size_t>(group); i < used.size(); i += groups) without[used[i]] = true;
        StereoFit others = fit;
        if (SolvePairs(input, without, &others))
          mounts[static_cast<std::size_t>(group)] = ToRigid3(others.right_from_left);
      },
      1);
  const Rigid3 mount = ToRigid3(fit.right_from_left);
  double baseline = 0;
  double rotation = 0;
  for (const auto& other : mounts) {
    if (!other) return std::nullopt;
    const double difference = other->translation.norm() - mount.translation.norm();
    const double angle = kDegPerRad * RotationAngle(other->rotation * mount.rotation.conjugate());
    baseline += difference * difference;
    rotation += angle * angle;
  }
  const double share = (static_cast<double>(groups) - 1.0) / static_cast<double>(groups);
  const double student = StudentFactor(static_cast<int>(groups));
  return MountSigmas{student * std::sqrt(share * baseline), student * std::sqrt(share * rotation)};
}

Status CheckMount(const Rigid3& right_from_left, double depth_mm) {
  const Eigen::Vector3d center = right_from_left.OriginInSource();
  if (center.norm() < kShortestBaseline * depth_mm)
    return {ErrorCode::kInsufficient,
            "the two cameras are at the same place; are both series of images of the same camera?"};
  if (std::abs(center.x()) < std::abs(center.y()))
    return {ErrorCode::kInsufficient,
            "the second camera is above or below the first one; pairs are of cameras side by side"};
  if (center.x() < 0)
    return {ErrorCode::kInsufficient,
            "the right camera is to the left of the left one by " + Digits(-center.x(), 1) + " mm; exchange the two"};
  return Status::Ok();
}

Status TooFewPairs(std::size_t pairs) {
  return {ErrorCode::kInsufficient, "the board is seen by both cameras in " + std::to_string(pairs) +
                                        " pairs that differ, and " + std::to_string(kFewestCalibrationPairs) +
                                        " are the least; add pairs of images in which both see all of it"};
}

Status NoRig(double pair_px, double alone_px) {
  return {ErrorCode::kInsufficient, "no fixed mount of the two cameras explains the pairs: the error is " +
                                        Digits(pair_px, 2) + " px, and " + Digits(alone_px, 2) +
                                        " px for each camera alone; are both images of a pair of the same moment?"};
}

// Where the cameras and the pairs are to begin with, each camera alone.
struct StereoStart {
  StereoFit fit;
  double depth_mm = 0;  // of the board, median
  double alone_px = 0;  // error of a view, median
};

// Turns right views that begin at the board's other end.
std::optional<StereoStart> StartPairs(const CalibrationBoard& board, const Camera& left, const Camera& right,
                                      StereoInput* input) {
  const auto alone_left = FitAlone(left, input->points, input->left);
  const auto alone_right = FitAlone(right, input->points, input->right);
  if (!alone_left || !alone_right) return std::nullopt;
  std::vector<double> alone_px;
  std::vector<double> depths_mm;
  PairPoses poses;
  for (std::size_t i = 0; i < input->left.size(); ++i) {
    alone_px.push_back(RmsLength(Residuals(input->points, input->left[i], *alone_left, alone_left->poses[i])));
    alone_px.push_back(RmsLength(Residuals(input->points, input->right[i], *alone_right, alone_right->poses[i])));
    const Rigid3 left_from_board = ToRigid3(alone_left->poses[i]);
    const Rigid3 right_from_board = ToRigid3(alone_right->poses[i]);
    depths_mm.push_back(left_from_board.translation.norm());
    poses.as_given.push_back(right_from_board * left_from_board.Inverse());
    if (LooksTheSameTurned(board))
      poses.turned.push_back(Turned(right_from_board, input->points) * left_from_board.Inverse());
  }
  const double depth_mm = Median(depths_mm);
  const Rigid3 consensus = Consensus(poses, depth_mm);
  for (std::size_t i = 0; i < poses.turned.size(); ++i)
    if (Distance(consensus, poses.turned[i], depth_mm) < Distance(consensus, poses.as_given[i], depth_mm))
      input->right[i] = Turned(input->right[i], board.NumPoints());
  return StereoStart{{left.model_id(), right.model_id(), ToArray(alone_left->params), ToArray(alone_right->params),
                      ToBoardPose(consensus), alone_left->poses},
                     depth_mm,
                     Median(alone_px)};
}

// Solves for all pairs, then without those that fit badly.
Result<std::vector<bool>> FitPairs(const StereoInput& input, double alone_px, StereoFit* fit) {
  std::vector<bool> outliers(input.left.size(), false);
  if (!SolvePairs(input, outliers, fit)) return NoRig(std::numeric_limits<double>::infinity(), alone_px);
  std::vector<double> pair_px;
  for (std::size_t pair = 0; pair < outliers.size(); ++pair) pair_px.push_back(PairRms(input, *fit, pair));
  const double median_px = Median(pair_px);
  if (!(median_px < kOutlierFactor * alone_px)) return NoRig(median_px, alone_px);
  std::size_t used = 0;
  for (std::size_t pair = 0; pair < outliers.size(); ++pair) {
    outliers[pair] = pair_px[pair] > kOutlierFactor * median_px;
    used += outliers[pair] ? 0 : 1;
  }
  if (used < kFewestCalibrationPairs) return TooFewPairs(used);
  if (!SolvePairs(input, outliers, fit)) return NoRig(median_px, alone_px);
  return outliers;
}

}  // namespace

Result<StereoCameras> CalibrateStereo(const CalibrationBoard& board, const Camera& left, const Camera& right,
                                      std::span<const BoardView> left_views, std::span<const BoardView> right_views,
                                      int threads, const JobProgress& progress) {
  constexpr int kSteps = 3;
  for (const Camera* camera : {&left, &right})
    if (camera->model_id() == CameraModelId::kOpenCvFisheye)
      return Status(ErrorCode::kInvalidArgument,
                    "pairs of fisheye cameras cannot be rectified; choose a perspective Calibrate.model");
  if (left_views.size() < kFewestCalibrationPairs) return TooFewPairs(left_views.size());
  StereoInput input{board.Points(), {left_views.begin(), left_views.end()}, {right_views.begin(), right_views.end()}};
  if (Status status = Tell(progress, "pairs", 0, kSteps); !status.ok()) return status;
  auto start = StartPairs(board, left, right, &input);
  if (!start)
    return Status(ErrorCode::kInsufficient, "the board's pose is not found in every pair; leave out blurred images");
  StereoFit& fit = start->fit;
  if (Status status = Tell(progress, "pairs", 1, kSteps); !status.ok()) return status;
  auto outliers = FitPairs(input, start->alone_px, &fit);
  if (!outliers.ok()) return outliers.status();

  const Rigid3 right_from_left = ToRigid3(fit.right_from_left);
  if (Status status = CheckMount(right_from_left, start->depth_mm); !status.ok()) return status;
  if (Status status = Tell(progress, "pairs", 2, kSteps); !status.ok()) return status;
  const auto sigmas = JackknifeSigmas(input, *outliers, fit, threads);
  auto refined_left =
      Camera::Create(fit.left_model, left.width(), left.height(), ToVector(fit.left_model, fit.left_params));
  auto refined_right =
      Camera::Create(fit.right_model, right.width(), right.height(), ToVector(fit.right_model, fit.right_params));
  if (!sigmas || !refined_left.ok() || !refined_right.ok())
    return Status(ErrorCode::kInsufficient,
                  "the pairs do not determine how the cameras are mounted; add pairs in which the board is tilted");
  StereoCameras stereo{*std::move(refined_left), *std::move(refined_right), right_from_left, sigmas->baseline_mm,
                       sigmas->rotation_deg};
  stereo.is_outlier = *std::move(outliers);
  for (std::size_t pair = 0; pair < input.left.size(); ++pair) stereo.pair_rms_px.push_back(PairRms(input, fit, pair));
  stereo.rms_px = RmsLength(AllResiduals(input, stereo.is_outlier, fit));
  return stereo;
}

}  // namespace pliant
