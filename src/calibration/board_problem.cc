// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "calibration/board_problem.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include <Eigen/Dense>
#include <ceres/ceres.h>
#include <ceres/crs_matrix.h>
#include <ceres/rotation.h>

#include "calibration/board_residual.h"
#include "pliant/base/statistics.h"

namespace pliant {
namespace {

// The loss turns at so many standard deviations of a residual, which are estimated so many times.
constexpr double kLossSigmas = 3;
constexpr int kLossRounds = 3;
// Of the normal equations with unit diagonal, below which rounding decides.
constexpr double kSmallestEigenvalue = 1e-13;

bool IsLeftOut(const std::vector<bool>& without, std::size_t view) { return !without.empty() && without[view]; }

void AddResiduals(std::span<const Eigen::Vector3d> board_points, std::span<const BoardView> views,
                  const std::vector<bool>& without, ceres::LossFunction* loss, BoardFit* fit, ceres::Problem* problem) {
  for (std::size_t view = 0; view < views.size(); ++view) {
    if (IsLeftOut(without, view)) continue;
    for (std::size_t i = 0; i < views[view].pixels.size(); ++i) {
      const Eigen::Vector3d& point = board_points[static_cast<std::size_t>(views[view].point_ids[i])];
      problem->AddResidualBlock(MakeBoardResidual(fit->model, point, views[view].pixels[i]), loss, fit->params.data(),
                                fit->poses[view].data());
    }
  }
}

void HoldParamsFrom(int first, BoardFit* fit, ceres::Problem* problem) {
  const int num_params = static_cast<int>(fit->params.size());
  if (first >= num_params) return;
  std::vector<int> held(static_cast<std::size_t>(num_params - first));
  std::iota(held.begin(), held.end(), first);
  problem->SetManifold(fit->params.data(), new ceres::SubsetManifold(num_params, held));
}

// Of all views that count.
double ResidualSigma(std::span<const Eigen::Vector3d> board_points, std::span<const BoardView> views,
                     const std::vector<bool>& without, const BoardFit& fit) {
  std::vector<Eigen::Vector2d> all;
  for (std::size_t view = 0; view < views.size(); ++view) {
    if (IsLeftOut(without, view)) continue;
    const std::vector<Eigen::Vector2d> residuals = Residuals(board_points, views[view], fit, fit.poses[view]);
    all.insert(all.end(), residuals.begin(), residuals.end());
  }
  return CoordinateSigma(all);
}

// The homography from the board (x, y, 1) to rays, up to scale (direct linear transform).
Eigen::Matrix3d RayHomography(const std::vector<Eigen::Vector3d>& rays, const std::vector<Eigen::Vector3d>& points) {
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Eigen::Matrix<double, 3, 9> equations;
    const Eigen::Matrix3d cross = Skew(rays[i]);
    for (int column = 0; column < 3; ++column) equations.middleCols<3>(3 * column) = cross * points[i][column];
    normal += equations.transpose() * equations;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(normal);
  const Eigen::Matrix<double, 9, 1> solution = solver.eigenvectors().col(0);
  return Eigen::Map<const Eigen::Matrix3d>(solution.data());
}

BoardPose ToBoardPose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation) {
  BoardPose pose;
  ceres::RotationMatrixToAngleAxis(rotation.data(), pose.data());
  for (int i = 0; i < 3; ++i) pose[static_cast<std::size_t>(3 + i)] = translation[i];
  return pose;
}

Eigen::MatrixXd NormalMatrix(const ceres::CRSMatrix& jacobian) {
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(jacobian.num_cols, jacobian.num_cols);
  for (std::size_t row = 0; row + 1 < jacobian.rows.size(); ++row) {
    for (int i = jacobian.rows[row]; i < jacobian.rows[row + 1]; ++i) {
      for (int j = jacobian.rows[row]; j < jacobian.rows[row + 1]; ++j)
        normal(jacobian.cols[static_cast<std::size_t>(i)], jacobian.cols[static_cast<std::size_t>(j)]) +=
            jacobian.values[static_cast<std::size_t>(i)] * jacobian.values[static_cast<std::size_t>(j)];
    }
  }
  return normal;
}

bool StartPose(const Camera& camera, std::span<const Eigen::Vector3d> board_points, const BoardView& view,
               BoardPose* pose) {
  constexpr std::size_t kFewestRays = 6;
  std::vector<Eigen::Vector3d> rays;
  std::vector<Eigen::Vector3d> points;  // (x, y, 1), centered and scaled
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const int id : view.point_ids) center += board_points[static_cast<std::size_t>(id)];
  center /= static_cast<double>(view.point_ids.size());
  double scale = 0;
  for (const int id : view.point_ids)
    scale = std::max(scale, (board_points[static_cast<std::size_t>(id)] - center).norm());
  if (!(scale > 0)) return false;
  for (std::size_t i = 0; i < view.pixels.size(); ++i) {
    const auto ray = camera.Unproject(view.pixels[i]);
    if (!ray) continue;
    rays.push_back(*ray);
    const Eigen::Vector3d point = (board_points[static_cast<std::size_t>(view.point_ids[i])] - center) / scale;
    points.emplace_back(point.x(), point.y(), 1.0);
  }
  if (rays.size() < kFewestRays) return false;

  Eigen::Matrix3d h = RayHomography(rays, points);
  h *= 2.0 / (h.col(0).norm() + h.col(1).norm());
  double side = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) side += rays[i].dot(h * points[i]);
  if (side < 0) h = -h;
  Eigen::Matrix3d axes;
  axes << h.col(0), h.col(1), h.col(0).cross(h.col(1));
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(axes, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d rotation = svd.matrixU() * svd.matrixV().transpose();
  if (!h.allFinite() || !(rotation.determinant() > 0)) return false;
  *pose = ToBoardPose(rotation, scale * h.col(2) - rotation * center);
  return true;
}

}  // namespace

ceres::CostFunction* MakeBoardResidual(CameraModelId model, const Eigen::Vector3d& point,
                                       const Eigen::Vector2d& pixel) {
  return WithModel(model, [&]<class Model>() -> ceres::CostFunction* {
    return new ceres::AutoDiffCostFunction<BoardResidual<Model>, 2, Model::kNumParams, 6>(
        new BoardResidual<Model>{point, pixel});
  });
}

int NumParams(CameraModelId model) {
  return WithModel(model, []<class Model>() { return Model::kNumParams; });
}

int NumPinholeParams(CameraModelId model) {
  return model == CameraModelId::kSimplePinhole || model == CameraModelId::kSimpleRadial ||
                 model == CameraModelId::kRadial
             ? 3
             : 4;
}

BoardPose ToBoardPose(const Rigid3& cam_from_board) {
  return ToBoardPose(cam_from_board.RotationMatrix(), cam_from_board.translation);
}

double RmsLength(std::span<const Eigen::Vector2d> residuals) {
  std::vector<double> lengths;
  for (const Eigen::Vector2d& residual : residuals) lengths.push_back(residual.norm());
  return Rms(lengths);
}

double CoordinateSigma(std::span<const Eigen::Vector2d> residuals) {
  std::vector<double> sizes;
  for (const Eigen::Vector2d& residual : residuals) {
    if (!residual.allFinite()) return std::numeric_limits<double>::infinity();
    sizes.insert(sizes.end(), {std::abs(residual.x()), std::abs(residual.y())});
  }
  return sizes.empty() ? std::numeric_limits<double>::infinity() : kMedianToSigma * Median(sizes);
}

Rigid3 ToRigid3(const BoardPose& pose) {
  return {RotationExp({pose[0], pose[1], pose[2]}), Eigen::Vector3d(pose[3], pose[4], pose[5])};
}

bool StartPoses(const Camera& camera, std::span<const Eigen::Vector3d> board_points, std::span<const BoardView> views,
                std::vector<BoardPose>* poses) {
  poses->resize(views.size());
  for (std::size_t view = 0; view < views.size(); ++view)
    if (!StartPose(camera, board_points, views[view], &(*poses)[view])) return false;
  return true;
}

std::vector<Eigen::Vector2d> Residuals(std::span<const Eigen::Vector3d> board_points, const BoardView& view,
                                       const BoardFit& fit, const BoardPose& pose) {
  std::vector<Eigen::Vector2d> residuals(view.pixels.size());
  WithModel(fit.model, [&]<class Model>() {
    for (std::size_t i = 0; i < view.pixels.size(); ++i) {
      const BoardResidual<Model> residual{board_points[static_cast<std::size_t>(view.point_ids[i])], view.pixels[i]};
      Eigen::Vector2d difference;
      if (residual(fit.params.data(), pose.data(), difference.data())) {
        residuals[i] = -difference;
      } else {
        residuals[i].setConstant(std::numeric_limits<double>::infinity());
      }
    }
  });
  return residuals;
}

bool SolveRobustly(int max_iterations, const std::function<double()>& sigma,
                   const std::function<void(ceres::LossFunction*, ceres::Problem*, ceres::Solver::Options*)>& build) {
  for (int round = 0; round < kLossRounds; ++round) {
    const double scale = sigma();
    if (!std::isfinite(scale)) return false;
    ceres::Problem::Options problem_options;
    problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::CauchyLoss loss(std::max(kLossSigmas * scale, 1e-9));
    ceres::Problem problem(problem_options);
    ceres::Solver::Options options;
    options.max_num_iterations = max_iterations;
    options.function_tolerance = 1e-10;
    options.logging_type = ceres::SILENT;
    options.num_threads = 1;
    build(&loss, &problem, &options);
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    if (!summary.IsSolutionUsable()) return false;
  }
  return true;
}

bool Solve(std::span<const Eigen::Vector3d> board_points, std::span<const BoardView> views,
           const std::vector<bool>& without, Intrinsics intrinsics, int max_iterations, BoardFit* fit) {
  const auto build = [&](ceres::LossFunction* loss, ceres::Problem* problem, ceres::Solver::Options* options) {
    AddResiduals(board_points, views, without, loss, fit, problem);
    if (intrinsics == Intrinsics::kHeld) {
      problem->SetParameterBlockConstant(fit->params.data());
      options->linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
      return;
    }
    HoldParamsFrom(fit->num_free, fit, problem);
    options->linear_solver_type = ceres::DENSE_SCHUR;
    options->linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (std::size_t view = 0; view < views.size(); ++view)
      if (!IsLeftOut(without, view)) options->linear_solver_ordering->AddElementToGroup(fit->poses[view].data(), 0);
    options->linear_solver_ordering->AddElementToGroup(fit->params.data(), 1);
  };
  return SolveRobustly(
      max_iterations, [&] { return ResidualSigma(board_points, views, without, *fit); }, build);
}

double StudentFactor(int groups) {
  // By degrees of freedom: the quantile of Student's t that holds 68.27 %.
  constexpr std::array kFactors = {1.837, 1.321, 1.197, 1.142, 1.111, 1.091, 1.077};
  static_assert(kFactors.size() == kMaxGroups - 1);
  return kFactors[static_cast<std::size_t>(std::clamp(groups, 2, kMaxGroups)) - 2];
}

Eigen::MatrixXd Covariance(std::span<const Eigen::Vector3d> board_points, std::span<const BoardView> views,
                           const std::vector<bool>& without, const BoardFit& fit) {
  BoardFit copy = fit;
  const double sigma = ResidualSigma(board_points, views, without, fit);
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::CauchyLoss loss(std::max(kLossSigmas * sigma, 1e-9));
  ceres::Problem problem(problem_options);
  AddResiduals(board_points, views, without, &loss, &copy, &problem);
  HoldParamsFrom(copy.num_free, &copy, &problem);
  // The columns of the parameters stand before those of the poses.
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = {copy.params.data()};
  for (std::size_t view = 0; view < views.size(); ++view)
    if (!IsLeftOut(without, view)) options.parameter_blocks.push_back(copy.poses[view].data());
  ceres::CRSMatrix jacobian;
  if (!problem.Evaluate(options, nullptr, nullptr, nullptr, &jacobian)) return {};
  const Eigen::MatrixXd normal = NormalMatrix(jacobian);
  const Eigen::VectorXd scale = normal.diagonal().cwiseSqrt();
  if (!(scale.minCoeff() > 0)) return {};
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scale.cwiseInverse().asDiagonal() * normal *
                                                              scale.cwiseInverse().asDiagonal());
  if (!(solver.eigenvalues().minCoeff() > kSmallestEigenvalue)) return {};
  const Eigen::Index free = fit.num_free;
  const Eigen::VectorXd root_weights = solver.eigenvalues().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd roots = sigma * scale.head(free).cwiseInverse().asDiagonal() *
                                solver.eigenvectors().topRows(free) * root_weights.asDiagonal();
  const auto num_params = static_cast<Eigen::Index>(fit.params.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(num_params, num_params);
  covariance.topLeftCorner(free, free) = roots * roots.transpose();
  return covariance;
}

}  // namespace pliant
