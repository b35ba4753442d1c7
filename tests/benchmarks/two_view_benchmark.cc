// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What a start from two frames costs: motion among 30 % outliers, its refinement, and the points.
#include <benchmark/benchmark.h>

#include "pliant/estimation/two_view/relative_pose.h"
#include "pliant/estimation/two_view/two_view_refinement.h"
#include "pliant/geometry/triangulation.h"
#include "support/synthetic_scene.h"

namespace pliant {
namespace {

constexpr std::uint64_t kScenes = 20;

struct Pair {
  std::vector<Eigen::Vector3d> rays0;
  std::vector<Eigen::Vector3d> rays1;
};

std::vector<Pair> MakePairs(const test::SceneOptions& common) {
  std::vector<Pair> pairs;
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
    test::SceneOptions options = common;
    options.seed = seed;
    options.motion = seed % 2 == 0 ? test::Motion::kForward : test::Motion::kSideways;
    const test::Scene scene = test::MakeScene(options);
    pairs.push_back({RaysOf(scene, options, 0), RaysOf(scene, options, 1)});
  }
  return pairs;
}

void BM_TwoViewStart(benchmark::State& state, RelativePoseSolver solver, RobustLoop robust) {
  const test::SceneOptions options{.num_points = 500, .num_frames = 2, .noise_px = 0.3, .outlier_share = 0.3};
  const std::vector<Pair> pairs = MakePairs(options);
  std::uint64_t k = 0;
  for (auto _ : state) {
    const Pair& pair = pairs[k % kScenes];
    const auto pose = EstimateRelativePose(pair.rays0, pair.rays1, options.focal_px, Random(++k),
                                           {.solver = solver, .robust = robust});
    if (!pose.ok()) continue;
    Pair inliers;
    for (std::size_t i = 0; i < pose->inliers.size(); ++i) {
      if (pose->inliers[i] == 0) continue;
      inliers.rays0.push_back(pair.rays0[i]);
      inliers.rays1.push_back(pair.rays1[i]);
    }
    const auto refined = RefineTwoView(pose->cam1_from_cam0, inliers.rays0, inliers.rays1, options.focal_px, {});
    if (!refined.ok()) continue;
    benchmark::DoNotOptimize(
        Triangulate(TriangulationMethod::kIdwm, refined->cam1_from_cam0, inliers.rays0, inliers.rays1));
  }
}

const bool kRegistered = [] {
  for (const auto& [solver, solver_name] : EnumNames<RelativePoseSolver>::kNames)
    for (const auto& [robust, robust_name] : EnumNames<RobustLoop>::kNames) {
      const bool sampled = solver <= RelativePoseSolver::kEigensolver;
      if (solver == RelativePoseSolver::kRotationOnly || (!sampled && robust != RobustLoop::kRansac)) continue;
      const std::string name = "BM_TwoViewStart/" + std::string(solver_name) + "/" + std::string(robust_name);
      benchmark::RegisterBenchmark(name.c_str(), BM_TwoViewStart, solver, robust)->Unit(benchmark::kMillisecond);
    }
  return true;
}();

}  // namespace
}  // namespace pliant
