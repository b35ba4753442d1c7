// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "refinement/free_intrinsics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include "refinement/one_openmp_thread.h"

namespace pliant {
namespace {

constexpr int kMaxIterations = 200;  // focal length, distortion and depths are a long valley
constexpr double kFunctionTolerance = 1e-7;
constexpr double kLogDistanceSigma = 5;  // of every point: it says nothing of the depths

using Pose = std::array<double, 6>;  // rotation vector, translation

class StopCallback final : public ceres::IterationCallback {
 public:
  explicit StopCallback(const std::function<bool()>& goes_on) : goes_on_(goes_on) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& /*summary*/) override {
    return goes_on_() ? ceres::SOLVER_CONTINUE : ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }

 private:
  const std::function<bool()>& goes_on_;
};

struct RadialResidual {
  Eigen::Vector2d pixel;
  Eigen::Vector2d center;
  double sigma_px;

  template <class T>
  bool operator()(const T* intrinsics, const T* pose, const T* point, T* residual) const {
    T in_cam[3];
    ceres::AngleAxisRotatePoint(pose, point, in_cam);
    for (int i = 0; i < 3; ++i) in_cam[i] += pose[3 + i];
    if (in_cam[2] <= T(0)) return false;
    const T x = in_cam[0] / in_cam[2];
    const T y = in_cam[1] / in_cam[2];
    const T scale = exp(intrinsics[0]) * (1.0 + intrinsics[1] * (x * x + y * y));
    residual[0] = (scale * x + center.x() - pixel.x()) / sigma_px;
    residual[1] = (scale * y + center.y() - pixel.y()) / sigma_px;
    return true;
  }
};

// Holds the unit, which no pixel says.
struct DistanceResidual {
  Eigen::Vector3d from;
  double distance;

  template <class T>
  bool operator()(const T* point, T* residual) const {
    const T x = point[0] - from.x();
    const T y = point[1] - from.y();
    const T z = point[2] - from.z();
    residual[0] = log(sqrt(x * x + y * y + z * z) / distance) / kLogDistanceSigma;
    return true;
  }
};

Pose ToPose(const Rigid3& rigid) {
  const Eigen::AngleAxisd turn(rigid.rotation);
  const Eigen::Vector3d rotation = turn.angle() * turn.axis();
  const Eigen::Vector3d& t = rigid.translation;
  return {rotation.x(), rotation.y(), rotation.z(), t.x(), t.y(), t.z()};
}

// Of the points in the problem.
void AddDistances(const Eigen::Vector3d& origin, std::vector<Eigen::Vector3d>* points, ceres::Problem* problem) {
  for (Eigen::Vector3d& point : *points)
    if (problem->HasParameterBlock(point.data()))
      problem->AddResidualBlock(new ceres::AutoDiffCostFunction<DistanceResidual, 1, 3>(
                                    new DistanceResidual{origin, (point - origin).norm()}),
                                nullptr, point.data());
}

Status NothingFits() {
  return {ErrorCode::kDegenerate,
          "no focal length and distortion fit better; give frames with more motion, or a calibration"};
}

}  // namespace

Status SolveFreeIntrinsics(const Recording& recording, const std::vector<bool>& used, double noise_px,
                           const std::function<bool()>& goes_on, RadialIntrinsics* intrinsics, BundleState* state) {
  std::array<double, 2> free = {std::log(intrinsics->focal_px), intrinsics->k};
  std::vector<Pose> poses;
  for (const Rigid3& pose : state->cams_from_world) poses.push_back(ToPose(pose));
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::CauchyLoss loss(kBundleLossScale);
  ceres::Problem problem(problem_options);
  const auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (std::size_t o = 0; o < used.size(); ++o) {
    if (!used[o]) continue;
    const RecordedObservation& seen = recording.observations[o];
    // One behind the camera at the start could not be evaluated.
    const Rigid3& start = state->cams_from_world[static_cast<std::size_t>(seen.view_idx)];
    if (!((start * state->rest_positions[static_cast<std::size_t>(seen.point_idx)]).z() > 0)) continue;
    double* point = state->rest_positions[static_cast<std::size_t>(seen.point_idx)].data();
    double* pose = poses[static_cast<std::size_t>(seen.view_idx)].data();
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<RadialResidual, 2, 2, 6, 3>(new RadialResidual{
                                 seen.pixel, Eigen::Vector2d(intrinsics->cx, intrinsics->cy), noise_px}),
                             &loss, free.data(), pose, point);
    ordering->AddElementToGroup(point, 0);
    ordering->AddElementToGroup(pose, 1);
  }
  ordering->AddElementToGroup(free.data(), 1);
  const auto first =
      std::ranges::find_if(poses, [&](const Pose& pose) { return problem.HasParameterBlock(pose.data()); });
  if (first == poses.end()) return NothingFits();
  problem.SetParameterBlockConstant(first->data());
  AddDistances(state->cams_from_world[static_cast<std::size_t>(first - poses.begin())].OriginInSource(),
               &state->rest_positions, &problem);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_SCHUR;
  options.linear_solver_ordering = ordering;
  options.max_num_iterations = kMaxIterations;
  options.function_tolerance = kFunctionTolerance;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  StopCallback stop(goes_on);
  options.callbacks.push_back(&stop);
  ceres::Solver::Summary summary;
  {
    const OneOpenMpThread one_thread;
    ceres::Solve(options, &problem, &summary);
  }
  if (!summary.IsSolutionUsable()) return NothingFits();
  intrinsics->focal_px = std::exp(free[0]);
  intrinsics->k = free[1];
  for (std::size_t v = 0; v < poses.size(); ++v) {
    const Pose& pose = poses[v];
    if (problem.HasParameterBlock(pose.data()))
      state->cams_from_world[v] = {RotationExp({pose[0], pose[1], pose[2]}),
                                   Eigen::Vector3d(pose[3], pose[4], pose[5])};
  }
  return Status::Ok();
}

}  // namespace pliant
