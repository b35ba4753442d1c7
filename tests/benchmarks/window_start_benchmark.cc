// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What an attempt of the deforming window at a first map costs, the one that succeeds: solution, and all frames.
#include <benchmark/benchmark.h>

#include "pliant/tracking/bootstrapping/make_initializer.h"
#include "support/synthetic_frames.h"
#include "support/synthetic_scene.h"

namespace pliant {
namespace {

constexpr std::uint64_t kScenes = 5;

void BM_WindowStart(benchmark::State& state, int frames, double amplitude_mm, int threads) {
  constexpr double kFramesPerSecond = 30.0;
  const double seconds = (frames - 1) / kFramesPerSecond;
  test::SceneOptions options{.num_points = 500, .num_frames = frames, .noise_px = 0.1, .light_sigma = 0.1};
  options.baseline_mm = 15.0 * seconds;
  options.wave = {.amplitude_mm = amplitude_mm, .wavelength_mm = 100.0, .omega_rad_s = 5.0, .seconds = seconds};
  std::vector<std::vector<InitFrame>> scenes;
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
    options.seed = seed;
    scenes.push_back(test::FramesOf(test::MakeScene(options), options, 0));
  }
  const Camera camera = test::SceneCamera(options);
  const auto initializer = MakeInitializer({}, Random(1));
  std::size_t k = 0;
  double maps = 0;
  for (auto _ : state) {
    const InitOutcome outcome = initializer->Try({camera, scenes[k++ % kScenes], {}, InitMoment::kMoreFollow, threads});
    maps += outcome.decision == InitDecision::kMap ? 1 : 0;
  }
  state.counters["maps"] = benchmark::Counter(maps, benchmark::Counter::kAvgIterations);
}
BENCHMARK_CAPTURE(BM_WindowStart, rigid, 21, 0.0, 2)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(BM_WindowStart, deforming, 46, 2.5, 2)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(BM_WindowStart, deforming_1_thread, 46, 2.5, 1)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace pliant
