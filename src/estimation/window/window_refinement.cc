// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/window/window_refinement.h"

#include <algorithm>
#include <cassert>
#include <string>

#include <ceres/ceres.h>

#include "estimation/ceres_support.h"
#include "estimation/ray_residuals.h"
#include "pliant/base/statistics.h"
#include "pliant/geometry/triangulation.h"

namespace pliant {
namespace {

using RowMajor24 = Eigen::Matrix<double, 2, 4, Eigen::RowMajor>;
using RowMajor23 = Eigen::Matrix<double, 2, 3, Eigen::RowMajor>;

// Blocks: rotation (x, y, z, w), translation, point. Unit: px.
class DirectionCost final : public ceres::SizedCostFunction<2, 4, 3, 3> {
 public:
  DirectionCost(const Eigen::Vector3d& ray, double focal_px)
      : ray_(ray), basis_(BasisAcross(ray)), focal_px_(focal_px) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    DirectionResidual residual;
    if (!EvaluateDirection(ReadQuaternion(parameters[0]), Eigen::Map<const Eigen::Vector3d>(parameters[1]),
                           Eigen::Map<const Eigen::Vector3d>(parameters[2]), ray_, basis_, &residual))
      return false;
    Eigen::Map<Eigen::Vector2d>{residuals} = focal_px_ * residual.value;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) Eigen::Map<RowMajor24>{jacobians[0]} = focal_px_ * residual.by_rotation;
    if (jacobians[1] != nullptr) Eigen::Map<RowMajor23>{jacobians[1]} = focal_px_ * residual.by_translation;
    if (jacobians[2] != nullptr) Eigen::Map<RowMajor23>{jacobians[2]} = focal_px_ * residual.by_point;
    return true;
  }

 private:
  Eigen::Vector3d ray_;
  RayBasis basis_;
  double focal_px_;
};

Status CheckWindow(const Window& window, WindowPoints points) {
  const int views = static_cast<int>(window.cams_from_world.size());
  const int count = static_cast<int>(window.points_in_world.size());
  if (views < 2 || count < 6)
    return {ErrorCode::kInsufficient, "refining a window takes at least two views and six points; there are " +
                                          std::to_string(views) + " and " + std::to_string(count)};
  for (const WindowObservation& observation : window.observations) {
    if (observation.view_idx < 0 || observation.view_idx >= views || observation.point_idx < 0 ||
        observation.point_idx >= count)
      return {ErrorCode::kInvalidArgument, "an observation of the window names a view or point that is not there"};
    if (points == WindowPoints::kFixed) continue;  // filtered below
    const Eigen::Vector3d x = window.cams_from_world[static_cast<std::size_t>(observation.view_idx)] *
                              window.points_in_world[static_cast<std::size_t>(observation.point_idx)];
    if (!(x.dot(observation.ray) > 0.0))
      return {ErrorCode::kInvalidArgument, "a point of the window lies behind a camera that sees it"};
  }
  return Status::Ok();
}

// Parameter blocks of one view, as Ceres wants them.
struct ViewBlocks {
  Eigen::Vector4d rotation;
  Eigen::Vector3d translation;
};

class WindowProblem {
 public:
  WindowProblem(const Window& start, double focal_px, WindowPoints points, const RefinementOptions& options)
      : window_(start),
        focal_px_(focal_px),
        points_(points),
        options_(options),
        loss_(options.loss_scale_px),
        problem_(BorrowingOptions()) {
    for (const Rigid3& cam_from_world : start.cams_from_world)
      views_.push_back({cam_from_world.rotation.coeffs(), cam_from_world.translation});
  }

  Result<WindowRefinement> Solve() {
    AddObservations();
    FixGauge();
    ceres::Solver::Options solver = RigidSolverOptions(
        points_ == WindowPoints::kRefined ? ceres::DENSE_SCHUR : ceres::DENSE_NORMAL_CHOLESKY, options_.max_iterations);
    if (points_ == WindowPoints::kRefined) solver.linear_solver_ordering = Ordering();
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem_, &summary);
    if (!summary.IsSolutionUsable())
      return Status(ErrorCode::kDegenerate, "the refinement of the window found no step that improves it");

    WindowRefinement refinement;
    refinement.cost = summary.final_cost;
    refinement.converged = summary.termination_type == ceres::CONVERGENCE;
    for (std::size_t k = 0; k < views_.size(); ++k)
      window_.cams_from_world[k] = Rigid3(ReadQuaternion(views_[k].rotation.data()), views_[k].translation);
    refinement.window = std::move(window_);
    refinement.median_error_px = MedianError(refinement.window);
    return refinement;
  }

 private:
  void AddObservations() {
    for (const WindowObservation& observation : window_.observations) {
      ViewBlocks& view = views_[static_cast<std::size_t>(observation.view_idx)];
      Eigen::Vector3d& point = window_.points_in_world[static_cast<std::size_t>(observation.point_idx)];
      // Without a point in front the residual is undefined; only fixed points may come this way (see CheckWindow).
      const Eigen::Vector3d x = ReadQuaternion(view.rotation.data()) * point + view.translation;
      if (!(x.dot(observation.ray) > 0.0)) continue;
      problem_.AddResidualBlock(new DirectionCost(observation.ray, focal_px_), &loss_, view.rotation.data(),
                                view.translation.data(), point.data());
    }
  }

  void FixGauge() {
    for (ViewBlocks& view : views_) {
      if (!problem_.HasParameterBlock(view.rotation.data())) continue;
      problem_.SetManifold(view.rotation.data(), &rotation_manifold_);
    }
    if (problem_.HasParameterBlock(views_.front().rotation.data())) {
      problem_.SetParameterBlockConstant(views_.front().rotation.data());
      problem_.SetParameterBlockConstant(views_.front().translation.data());
    }
    if (points_ == WindowPoints::kFixed) {
      for (Eigen::Vector3d& point : window_.points_in_world)
        if (problem_.HasParameterBlock(point.data())) problem_.SetParameterBlockConstant(point.data());
    } else if (problem_.HasParameterBlock(views_.back().translation.data())) {
      problem_.SetManifold(views_.back().translation.data(), &scale_manifold_);
    }
  }

  std::shared_ptr<ceres::ParameterBlockOrdering> Ordering() {
    auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (Eigen::Vector3d& point : window_.points_in_world)
      if (problem_.HasParameterBlock(point.data())) ordering->AddElementToGroup(point.data(), 0);
    for (ViewBlocks& view : views_)
      if (problem_.HasParameterBlock(view.rotation.data())) {
        ordering->AddElementToGroup(view.rotation.data(), 1);
        ordering->AddElementToGroup(view.translation.data(), 1);
      }
    return ordering;
  }

  double MedianError(const Window& window) const {
    std::vector<double> errors_px;
    for (const WindowObservation& observation : window.observations)
      errors_px.push_back(focal_px_ *
                          AngleBetween(window.cams_from_world[static_cast<std::size_t>(observation.view_idx)] *
                                           window.points_in_world[static_cast<std::size_t>(observation.point_idx)],
                                       observation.ray));
    return errors_px.empty() ? 0.0 : Median(std::move(errors_px));
  }

  Window window_;
  double focal_px_;
  WindowPoints points_;
  RefinementOptions options_;
  std::vector<ViewBlocks> views_;
  ceres::CauchyLoss loss_;
  ceres::EigenQuaternionManifold rotation_manifold_;
  ceres::SphereManifold<3> scale_manifold_;
  ceres::Problem problem_;
};

}  // namespace

std::vector<std::size_t> SpreadViews(std::size_t frames, std::size_t max_views) {
  const std::size_t count = std::min(frames, max_views);
  assert(count >= 2);
  std::vector<std::size_t> views;
  for (std::size_t k = 0; k < count; ++k) views.push_back((k * (frames - 1) + (count - 1) / 2) / (count - 1));
  return views;
}

Result<WindowRefinement> RefineWindow(const Window& start, double focal_px, WindowPoints points,
                                      const RefinementOptions& options) {
  if (Status status = CheckWindow(start, points); !status.ok()) return status;
  return WindowProblem(start, focal_px, points, options).Solve();
}

}  // namespace pliant
