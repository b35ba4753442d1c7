// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Parameters of a camera and poses of a board, fitted to views of it.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <ceres/ceres.h>

#include "pliant/board/find_board.h"
#include "pliant/camera/camera.h"
#include "pliant/geometry/rigid3.h"

namespace pliant {

inline constexpr int kMaxIterations = 100;
// A view (or pair of views) is left out when its error is so many times the median one's; no pair of cameras fits when
// the median pair's error is so many times that of each camera alone.
inline constexpr double kOutlierFactor = 3;
inline constexpr int kMaxGroups = 8;  // of views or pairs that are held out, one group after the other

// Rotation vector and translation: cam_from_board, rad and mm.
using BoardPose = std::array<double, 6>;

// What is being estimated. A pose for every view of the problem.
struct BoardFit {
  CameraModelId model = CameraModelId::kPinhole;
  std::vector<double> params;
  int num_free = 0;  // so many of the first parameters are estimated; the others are held: of a distortion, at 0
  std::vector<BoardPose> poses;
};

Rigid3 ToRigid3(const BoardPose& pose);
BoardPose ToBoardPose(const Rigid3& cam_from_board);

// Root mean square of the residuals' lengths, px.
double RmsLength(std::span<const Eigen::Vector2d> residuals);
// The standard deviation of one coordinate, whatever outliers there are; infinite where there is no residual, or one of
// them is not finite: a point that cannot be projected.
double CoordinateSigma(std::span<const Eigen::Vector2d> residuals);

// The poses of the views by the homographies between their rays in `camera` and the board. False where one has too few
// rays, or lies on a line.
bool StartPoses(const Camera& camera, std::span<const Eigen::Vector3d> board_points, std::span<const BoardView> views,
                std::vector<BoardPose>* poses);

// Solves a problem several times, each time with a robust loss whose scale is that of the residuals before. `sigma` is
// the standard deviation of a coordinate as it is now; `build` makes the problem, and says how it is solved. False
// where `sigma` is not finite, or Ceres fails.
bool SolveRobustly(int max_iterations, const std::function<double()>& sigma,
                   const std::function<void(ceres::LossFunction*, ceres::Problem*, ceres::Solver::Options*)>& build);

// Whether the free parameters of the camera are moved, or the poses only.
enum class Intrinsics { kHeld, kFree };

// Moves `fit` to the least robust cost over the views; those of `without` (one flag a view; empty: none) count for
// nothing, and keep their poses. False where a point cannot be projected at the start, or nothing is left.
bool Solve(std::span<const Eigen::Vector3d> board_points, std::span<const BoardView> views,
           const std::vector<bool>& without, Intrinsics intrinsics, int max_iterations, BoardFit* fit);

// Measured minus projected, by point; points that cannot be projected have infinite ones.
std::vector<Eigen::Vector2d> Residuals(std::span<const Eigen::Vector3d> board_points, const BoardView& view,
                                       const BoardFit& fit, const BoardPose& pose);

// The covariance of the parameters by the inverse of the normal equations and the residuals' own size; empty where the
// views do not determine them. Of a parameter that is not free it is 0.
Eigen::MatrixXd Covariance(std::span<const Eigen::Vector3d> board_points, std::span<const BoardView> views,
                           const std::vector<bool>& without, const BoardFit& fit);

// By what standard deviations that so many groups give are multiplied: the fewer groups, the less is known of their
// spread (Student's t with one degree of freedom less than groups, by the normal distribution).
double StudentFactor(int groups);

// The error of a point of the board, of the parameters and the pose.
ceres::CostFunction* MakeBoardResidual(CameraModelId model, const Eigen::Vector3d& point, const Eigen::Vector2d& pixel);

int NumParams(CameraModelId model);
// The number of the model's parameters that are not of the distortion, which stand first.
int NumPinholeParams(CameraModelId model);

}  // namespace pliant
