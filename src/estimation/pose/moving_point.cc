// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/pose/moving_point.h"

#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Cholesky>
#include <ceres/tiny_solver.h>

#include "estimation/ray_residuals.h"

namespace pliant {
namespace {

// By the log of its distance from the first camera, and two tangents across its first ray.
class TriangulationProblem {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = 3 };
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, 3>;

  TriangulationProblem(std::span<const MovingPointView> views, double noise_rad, double distance,
                       const std::optional<DistancePrior>& prior)
      : views_(views), prior_(prior), origin_(views.front().cam_from_world.OriginInSource()) {
    const Eigen::Matrix3d world_from_cam = views.front().cam_from_world.RotationMatrix().transpose();
    axes_.col(0) = world_from_cam * views.front().ray;
    axes_.rightCols<2>() = world_from_cam * BasisAcross(views.front().ray).transpose();
    for (const MovingPointView& view : views) {
      bases_.push_back(BasisAcross(view.ray));
      const double moved_rad = view.displacement_sigma / distance;
      weights_.push_back(1.0 / std::sqrt(noise_rad * noise_rad + moved_rad * moved_rad));
    }
    if (prior_) prior_weight_ = 1.0 / prior_->sigma;
  }

  int NumViewResiduals() const { return 2 * static_cast<int>(views_.size()); }
  int NumResiduals() const { return NumViewResiduals() + (prior_ ? 1 : 0); }

  Eigen::Vector3d Position(const double* x) const {
    return origin_ + std::exp(x[0]) * (axes_ * Eigen::Vector3d(1.0, x[1], x[2]));
  }

  // Each view's weight, once its residual is known: Cauchy's loss by reweighting.
  void Reweight(const Eigen::Vector3d& x) {
    Eigen::VectorXd residuals(NumResiduals());
    if (!(*this)(x.data(), residuals.data(), nullptr)) return;
    for (std::size_t k = 0; k < weights_.size(); ++k)
      weights_[k] /= std::sqrt(1.0 + residuals.segment<2>(2 * static_cast<Eigen::Index>(k)).squaredNorm() / kLossScale);
    if (prior_) prior_weight_ /= std::sqrt(1.0 + std::pow(residuals[NumViewResiduals()], 2) / kLossScale);
  }

  bool operator()(const double* x, double* residuals, double* jacobian) const {
    const Eigen::Vector3d position = Position(x);
    Eigen::Matrix3d by_parameters;
    by_parameters.col(0) = position - origin_;
    by_parameters.rightCols<2>() = std::exp(x[0]) * axes_.rightCols<2>();
    for (std::size_t k = 0; k < views_.size(); ++k) {
      const MovingPointView& view = views_[k];
      DirectionResidual direction;
      if (!EvaluateDirection(view.cam_from_world.rotation, view.cam_from_world.translation,
                             position + view.displacement, view.ray, bases_[k], &direction)) {
        // The solver looks at the residuals of a step that failed: they must refuse it.
        Eigen::Map<Eigen::VectorXd>(residuals, NumResiduals()).setConstant(std::numeric_limits<double>::infinity());
        return false;
      }
      const auto row = 2 * static_cast<Eigen::Index>(k);
      Eigen::Map<Eigen::VectorXd>(residuals, NumResiduals()).segment<2>(row) = weights_[k] * direction.value;
      if (jacobian != nullptr)
        Eigen::Map<Jacobian>(jacobian, NumResiduals(), 3).middleRows<2>(row) =
            weights_[k] * direction.by_point * by_parameters;
    }
    if (!prior_) return true;
    const Rigid3& last = views_.back().cam_from_world;
    const Eigen::Vector3d in_last = last * (position + views_.back().displacement);
    const Eigen::Index row = NumViewResiduals();
    residuals[row] = prior_weight_ * (std::log(in_last.norm()) - prior_->log_distance);
    if (jacobian != nullptr)
      Eigen::Map<Jacobian>(jacobian, NumResiduals(), 3).row(row) =
          prior_weight_ / in_last.squaredNorm() * in_last.transpose() * last.RotationMatrix() * by_parameters;
    return true;
  }

 private:
  static constexpr double kLossScale = 9.0;  // squared standard deviations

  std::span<const MovingPointView> views_;
  std::optional<DistancePrior> prior_;
  double prior_weight_ = 0;
  Eigen::Vector3d origin_;
  Eigen::Matrix3d axes_;  // the first ray, and two directions across it, in the world
  std::vector<RayBasis> bases_;
  std::vector<double> weights_;
};

}  // namespace

Result<MovingPoint> TriangulateMovingPoint(std::span<const MovingPointView> views, double start_distance,
                                           double noise_rad, const std::optional<DistancePrior>& prior) {
  if (views.size() < 2) return {ErrorCode::kInsufficient, "triangulating a moving point takes at least two views"};
  if (!(start_distance > 0.0) || !(noise_rad > 0.0))
    return {ErrorCode::kInvalidArgument, "triangulating a moving point takes a distance and a noise above 0"};
  if (prior && !(prior->sigma > 0.0 && std::isfinite(prior->log_distance)))
    return {ErrorCode::kInvalidArgument, "a prior of the distance takes a finite one, and a deviation above 0"};
  Eigen::Vector3d x(std::log(start_distance), 0.0, 0.0);
  const auto outside = [&] { return !x.allFinite() || std::abs(x[0] - std::log(start_distance)) > 5.0; };
  Eigen::Matrix3d information;
  double squares = 0;
  for (int round = 0; round < 2; ++round) {
    TriangulationProblem problem(views, noise_rad, std::exp(x[0]), prior);
    if (round > 0) problem.Reweight(x);
    ceres::TinySolver<TriangulationProblem> solver;
    solver.options.max_num_iterations = 20;
    solver.Solve(problem, &x);
    if (outside()) return {ErrorCode::kDegenerate, "the views do not bound the point's distance"};
    Eigen::VectorXd residuals(problem.NumResiduals());
    TriangulationProblem::Jacobian jacobian(problem.NumResiduals(), 3);
    if (!problem(x.data(), residuals.data(), jacobian.data()))
      return {ErrorCode::kDegenerate, "the point is not in front of all its views"};
    information = jacobian.transpose() * jacobian;
    squares = residuals.head(problem.NumViewResiduals()).squaredNorm();
  }
  const Eigen::LDLT<Eigen::Matrix3d> factor(information);
  const double variance = factor.solve(Eigen::Vector3d::UnitX())[0];
  if (factor.info() != Eigen::Success || !factor.isPositive() || !(variance > 0.0) || !std::isfinite(variance))
    return {ErrorCode::kDegenerate, "the views do not bound the point's distance"};
  MovingPoint point;
  point.position = TriangulationProblem(views, noise_rad, start_distance, prior).Position(x.data());
  point.log_distance_sigma = std::sqrt(variance);
  point.rms = std::sqrt(squares / static_cast<double>(2 * views.size()));
  return point;
}

}  // namespace pliant
