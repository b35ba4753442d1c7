// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The joint problem by Ceres' L-BFGS in the preconditioned variables: a handful of steps, each an evaluation of the
// energy and two sparse triangular solves.
#include <memory>

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include "estimation/frame/frame_energy.h"
#include "estimation/frame/frame_preconditioner.h"
#include "estimation/frame/frame_solvers.h"

namespace pliant {
namespace {

using Points = std::vector<Eigen::Vector3d>;

// Ceres' bounds are absolute; the objective is scaled so that the largest entry of the first gradient is one.
constexpr double kGradientTolerance = 1e-10;
// A step this short, relative to the way gone, changes nothing but the rounding.
constexpr double kParameterTolerance = 1e-12;

// E(z) scaled: with a Hessian that is nearly the identity the first step should have length one, and Ceres takes a
// first step of length min(1, 1 / |gradient|_max). So z = scale * z', E' = E / scale^2: the same Hessian, a gradient of
// one.
class PreconditionedEnergy final : public ceres::FirstOrderFunction {
 public:
  PreconditionedEnergy(const FrameData& data, const FrameTerms& terms, const FramePreconditioner& preconditioner)
      : energy_(data, terms),
        preconditioner_(preconditioner),
        pose_is_(data.pose_is),
        points_(data.positions.size()),
        by_points_(points_.size()) {}

  // Sets the scale from the gradient at zero. False where the start cannot be evaluated.
  bool SetScale() {
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(NumParameters());
    Eigen::VectorXd gradient(NumParameters());
    double cost = 0;
    if (!Evaluate(zero.data(), &cost, gradient.data()) || !gradient.allFinite()) return false;
    const double largest = gradient.cwiseAbs().maxCoeff();
    if (largest > 0.0) scale_ = largest;
    return true;
  }
  double scale() const { return scale_; }

  int NumParameters() const override { return preconditioner_.num_variables(); }

  bool Evaluate(const double* z, double* cost, double* gradient) const override {
    const Eigen::Map<const Eigen::VectorXd> scaled(z, NumParameters());
    Vector6d increment;
    Vector6d by_increment;
    preconditioner_.ToPoints(scale_ * scaled, &points_, &increment);
    if (!energy_.Evaluate(points_, increment, cost, &by_points_, &by_increment)) return false;
    *cost /= scale_ * scale_;
    if (gradient == nullptr) return true;
    Eigen::Map<Eigen::VectorXd> by_z(gradient, NumParameters());
    preconditioner_.ToGradient(by_points_, by_increment, by_z);
    // The increment depends on the last six variables alone: without a gradient they, and it, stay zero.
    if (pose_is_ == FramePose::kHeld) by_z.tail<6>().setZero();
    by_z /= scale_;
    return true;
  }

 private:
  // Ceres' interface is const; these are working memory, and the solver is single-threaded.
  mutable FrameEnergy energy_;
  const FramePreconditioner& preconditioner_;
  FramePose pose_is_;
  mutable Points points_;
  mutable Points by_points_;
  double scale_ = 1;
};

// Every point where its predicted position is nearest to the measured ray: the reprojection term is then zero, and what
// is left is close to quadratic. Where the pixel has no ray, or the ray points away, the predicted position itself.
Points StartOnRays(const FrameData& data) {
  const auto rays = data.camera->Unproject(data.pixels);
  Points start;
  start.reserve(data.positions.size());
  for (int i = 0; i < data.num_points(); ++i) {
    const Eigen::Vector3d predicted = data.pose.Transform<double>(Vector6d::Zero(), data.positions[i]);
    const double depth = rays[i] ? rays[i]->dot(predicted) : 0.0;
    start.push_back(depth > 0.0 ? Eigen::Vector3d(*rays[i] * depth) : predicted);
  }
  return start;
}

ceres::GradientProblemSolver::Options SolverOptions(const FrameProblemOptions& options) {
  ceres::GradientProblemSolver::Options solver_options;
  solver_options.line_search_direction_type = ceres::LBFGS;
  solver_options.line_search_type = ceres::WOLFE;
  solver_options.max_num_iterations = options.max_iterations;
  solver_options.function_tolerance = options.function_tolerance;
  solver_options.gradient_tolerance = kGradientTolerance;
  solver_options.parameter_tolerance = kParameterTolerance;
  solver_options.logging_type = ceres::SILENT;
  return solver_options;
}

}  // namespace

Result<FrameEstimate> SolveFrameByLbfgs(const FrameData& data, const FrameTerms& terms) {
  const Points start = StartOnRays(data);
  const FramePreconditioner preconditioner(data, terms, start);
  auto energy = std::make_unique<PreconditionedEnergy>(data, terms, preconditioner);
  if (!preconditioner.ok() || !energy->SetScale())
    return {ErrorCode::kDegenerate, "the joint problem of pose and deformation is singular at its start"};
  const double scale = energy->scale();
  ceres::GradientProblem problem(energy.release());  // takes ownership
  Eigen::VectorXd z = Eigen::VectorXd::Zero(problem.NumParameters());
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(SolverOptions(data.options), problem, z.data(), &summary);
  if (!summary.IsSolutionUsable() || !z.allFinite())
    return {ErrorCode::kDegenerate, "the joint problem of pose and deformation has no solution"};

  FrameEstimate estimate;
  Vector6d increment;
  estimate.positions.resize(data.positions.size());
  preconditioner.ToPoints(scale * z, &estimate.positions, &increment);
  estimate.cam_from_world = data.pose.Pose(increment);
  const Rigid3 world_from_cam = estimate.cam_from_world.Inverse();
  for (Eigen::Vector3d& position : estimate.positions) position = world_from_cam * position;
  estimate.iterations = static_cast<int>(summary.iterations.size()) - 1;
  estimate.converged = summary.termination_type == ceres::CONVERGENCE;
  estimate.message = summary.message;
  return estimate;
}

}  // namespace pliant
