// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The joint problem of one frame: ours against the straightforward formulation (automatic derivatives, both directed
// edges, SPARSE_NORMAL_CHOLESKY, Ceres' defaults), from the same start, on one thread. Counters: the final cost,
// the iterations, and for ours the relative difference of its cost to the reference's.
#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>
#include <ceres/ceres.h>

#include "estimation/frame_scene.h"
#include "pliant/estimation/frame/frame_problem.h"
#include "pliant/estimation/pose/camera_pose.h"

namespace pliant {
namespace {

struct ReprojectionFunctor {
  Eigen::Vector4d intrinsics;  // fx, fy, cx, cy
  Eigen::Vector3d position;
  Eigen::Vector2d pixel;

  template <class T>
  bool operator()(const T* rotation, const T* translation, const T* delta, T* residual) const {
    const Eigen::Map<const Eigen::Quaternion<T>> q(rotation);
    const Eigen::Map<const Eigen::Matrix<T, 3, 1>> t(translation);
    const Eigen::Map<const Eigen::Matrix<T, 3, 1>> d(delta);
    const Eigen::Matrix<T, 3, 1> moved = position.cast<T>() + d;
    const Eigen::Matrix<T, 3, 1> x = q * moved + t;
    if (!(x.z() > T(0.0))) return false;
    residual[0] = intrinsics(0) * x.x() / x.z() + intrinsics(2) - pixel.x();
    residual[1] = intrinsics(1) * x.y() / x.z() + intrinsics(3) - pixel.y();
    return true;
  }
};

struct SpatialFunctor {
  double weight;
  double sigma;
  template <class T>
  bool operator()(const T* delta_i, const T* delta_j, T* residual) const {
    for (int c = 0; c < 3; ++c) residual[c] = weight * (delta_i[c] - delta_j[c]) / sigma;
    return true;
  }
};

struct TemporalFunctor {
  double sigma;
  template <class T>
  bool operator()(const T* delta, T* residual) const {
    for (int c = 0; c < 3; ++c) residual[c] = delta[c] / sigma;
    return true;
  }
};

// The straightforward formulation; the final cost and the number of steps.
ceres::Solver::Summary SolveReference(const FrameScene& scene, const Rigid3& initial) {
  const FrameProblemOptions o;
  const Eigen::Vector4d intrinsics(scene.camera.params().data());
  Rigid3 pose = initial;
  std::vector<Eigen::Vector3d> deltas(scene.positions.size(), Eigen::Vector3d::Zero());
  ceres::Problem problem;
  for (std::size_t i = 0; i < deltas.size(); ++i) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<ReprojectionFunctor, 2, 4, 3, 3>(
                                 new ReprojectionFunctor{intrinsics, scene.positions[i], scene.pixels[i]}),
                             new ceres::HuberLoss(std::sqrt(o.chi2_rep)), pose.rotation.coeffs().data(),
                             pose.translation.data(), deltas[i].data());
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<TemporalFunctor, 3, 3>(new TemporalFunctor{o.sigma_tmp_mm}),
        new ceres::HuberLoss(std::sqrt(o.chi2_tmp)), deltas[i].data());
  }
  for (const GraphEdge& edge : scene.graph.edges) {
    for (int direction = 0; direction < edge.multiplicity; ++direction) {
      const int from = direction == 0 ? edge.i : edge.j;
      const int to = direction == 0 ? edge.j : edge.i;
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<SpatialFunctor, 3, 3, 3>(new SpatialFunctor{edge.weight, o.sigma_spa_mm}),
          new ceres::HuberLoss(std::sqrt(o.chi2_spa)), deltas[from].data(), deltas[to].data());
    }
  }
  problem.SetManifold(pose.rotation.coeffs().data(), new ceres::EigenQuaternionManifold);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary;
}

struct Case {
  FrameScene scene;
  Rigid3 initial;  // where the joint problem starts in practice: the pose on the last geometry
};

Case MakeCase(int num_points) {
  Case result{MakeFrameScene({.num_points = num_points}), {}};
  const FrameScene& scene = result.scene;
  const Rigid3 predicted = PredictCameraPose(scene.before_last_cam_from_world, scene.last_cam_from_world);
  result.initial =
      EstimateCameraPose(scene.camera, scene.positions, scene.pixels, predicted, {}).value().cam_from_world;
  return result;
}

void BM_FrameProblemReference(benchmark::State& state) {
  const Case c = MakeCase(static_cast<int>(state.range(0)));
  ceres::Solver::Summary summary;
  for (auto _ : state) summary = SolveReference(c.scene, c.initial);
  state.counters["cost"] = summary.final_cost;
  state.counters["iterations"] = static_cast<double>(summary.iterations.size()) - 1;
}

void Solve(benchmark::State& state, FrameSolver solver) {
  const Case c = MakeCase(static_cast<int>(state.range(0)));
  FrameProblemOptions options;
  options.solver = solver;
  FrameSolution solution;
  for (auto _ : state) solution = SolveFrameProblem(c.scene.camera, c.scene.Input(c.initial), options).value();
  const double reference = SolveReference(c.scene, c.initial).final_cost;
  state.counters["cost"] = TotalCost(solution.costs);
  state.counters["iterations"] = solution.iterations;
  state.counters["cost_difference"] = std::abs(TotalCost(solution.costs) - reference) / reference;
}

void BM_FrameProblem(benchmark::State& state) { Solve(state, FrameSolver::kLbfgs); }
void BM_FrameProblemLevenbergMarquardt(benchmark::State& state) { Solve(state, FrameSolver::kLevenbergMarquardt); }

void BM_DeformationGraph(benchmark::State& state) {
  const FrameScene scene = MakeFrameScene({.num_points = static_cast<int>(state.range(0))});
  for (auto _ : state) benchmark::DoNotOptimize(BuildDeformationGraph(scene.positions, {}, {}).value().edges.data());
}

void BM_CameraPose(benchmark::State& state) {
  const FrameScene scene = MakeFrameScene({.num_points = static_cast<int>(state.range(0))});
  const Rigid3 predicted = PredictCameraPose(scene.before_last_cam_from_world, scene.last_cam_from_world);
  int iterations = 0;
  for (auto _ : state)
    iterations = EstimateCameraPose(scene.camera, scene.positions, scene.pixels, predicted, {}).value().iterations;
  state.counters["iterations"] = iterations;
}

constexpr auto kUnit = benchmark::kMillisecond;
BENCHMARK(BM_FrameProblemReference)->Arg(250)->Arg(500)->Arg(1000)->Arg(2000)->Unit(kUnit);
BENCHMARK(BM_FrameProblemLevenbergMarquardt)->Arg(500)->Unit(kUnit);
BENCHMARK(BM_FrameProblem)->Arg(250)->Arg(500)->Arg(1000)->Arg(2000)->Unit(kUnit);
BENCHMARK(BM_DeformationGraph)->Arg(500)->Arg(2000)->Unit(kUnit);
BENCHMARK(BM_CameraPose)->Arg(500)->Arg(2000)->Unit(kUnit);

}  // namespace
}  // namespace pliant
