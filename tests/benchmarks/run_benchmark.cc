// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The whole job as `pliant track` does it, images decoded and rows written: a simulated sequence of 640x480 in which
// 500 points are placed at once (a start from depth) and stay in view. The argument is the number of threads. Counters:
//   frames_per_second  over the frames in state tracking       points     followed in a frame, mean
//   memory_mb          resident after a frame, largest         memory_growth_mb  from the first third to the end
#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

#include <benchmark/benchmark.h>
#include <malloc.h>
#include <unistd.h>

#include "pliant/pipeline/track.h"
#include "pliant/simulation/write_sequence.h"
#include "support/temporary_folder.h"

namespace pliant {
namespace {

constexpr int kFrames = 90;

double ResidentMb() {
  std::ifstream statm("/proc/self/statm");
  double all_pages = 0;
  double resident_pages = 0;
  statm >> all_pages >> resident_pages;
  return resident_pages * static_cast<double>(sysconf(_SC_PAGESIZE)) * 1e-6;
}

// The sequence, rendered once; empty when that failed.
const std::filesystem::path& SequencePath() {
  static const TemporaryFolder folder("run_benchmark");
  static const std::filesystem::path path = [] {
    SimulationOptions options;
    options.trajectory.kind = TrajectoryKind::kHold;
    options.trajectory.frames = kFrames;
    options.deformation.amplitude_mm = 1.0;
    options.sensor.samples = 1;
    const std::filesystem::path sequence = folder.Path("sequence");
    const bool written = WriteSequence(options, sequence).ok();
    malloc_trim(0);  // the renderer's memory is not the tracker's
    return written ? sequence : std::filesystem::path();
  }();
  return path;
}

class Meter : public TrackObserver {
 public:
  void OnStart(int) override {}
  void OnFrame(const FrameReport& report) override {
    if (!HasPose(report.state)) return;
    const auto now = std::chrono::steady_clock::now();
    if (frames_ > 0) seconds_ += std::chrono::duration<double>(now - last_).count();
    last_ = now;
    ++frames_;
    points_ += report.tracked;
    resident_mb_.push_back(ResidentMb());
  }

  void Report(benchmark::State& state) const {
    if (frames_ < kFrames / 2) {
      state.SkipWithError("the sequence was not tracked");
      return;
    }
    const std::size_t third = resident_mb_.size() / 3;
    state.counters["frames_per_second"] = (frames_ - 1) / seconds_;
    state.counters["points"] = static_cast<double>(points_) / frames_;
    state.counters["memory_mb"] = *std::max_element(resident_mb_.begin(), resident_mb_.end());
    state.counters["memory_growth_mb"] = resident_mb_.back() - resident_mb_[third];
  }

 private:
  int frames_ = 0;
  long points_ = 0;
  double seconds_ = 0;
  std::chrono::steady_clock::time_point last_;
  std::vector<double> resident_mb_;
};

void BM_Run(benchmark::State& state) {
  if (SequencePath().empty()) {
    state.SkipWithError("the sequence could not be written");
    return;
  }
  TrackOptions options = MakeTrackOptions(Preset::kDefault);
  options.threads = static_cast<int>(state.range(0));
  options.tracker.init.method = InitMethod::kDepth;
  RunRequest request;
  request.input.image_path = SequencePath();
  request.output_path = (SequencePath().parent_path() / "run").string();
  Meter meter;
  const std::array<TrackObserver*, 1> observers = {&meter};
  for (auto _ : state) {
    meter = Meter();
    const Result<RunSummary> run = RunTrack(request, options, observers);
    if (!run.ok()) {
      state.SkipWithError(run.status().message().c_str());
      return;
    }
  }
  meter.Report(state);
}
BENCHMARK(BM_Run)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(1);

}  // namespace
}  // namespace pliant
