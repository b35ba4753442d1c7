// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Exports of a long run: 10,000 points in each of 1,000 frames, ten million observations, in every format. Each export
// is a process of its own. Counters:
//   seconds_per_million  observations        memory_mb  resident, largest
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <benchmark/benchmark.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "pliant/camera/camera.h"
#include "pliant/exchange/export.h"
#include "pliant/io/run_writer.h"
#include "support/temporary_folder.h"

namespace pliant {
namespace {

constexpr int kFrames = 1000;
constexpr int kPoints = 10000;
constexpr int kColumns = 100;
constexpr double kMillions = 1e-6 * kFrames * kPoints;

// Runs `work` in a process of its own; its largest resident memory, or nothing where it failed.
template <class Work>
std::optional<double> MemoryMb(Work work) {
  const pid_t child = fork();
  if (child == 0) _exit(work() ? 0 : 1);
  int state = 0;
  rusage usage{};
  if (child < 0 || wait4(child, &state, 0, &usage) < 0 || !WIFEXITED(state) || WEXITSTATUS(state) != 0)
    return std::nullopt;
  return static_cast<double>(usage.ru_maxrss) * 1024e-6;
}

// A wall of points that moves up and down before a camera that goes sideways.
bool WriteLongRun(const std::string& path) {
  const std::array<double, 4> params = {500, 500, 319.5, 239.5};
  const Camera camera = *Camera::Create(CameraModelId::kPinhole, 640, 480, params);
  RunWriterOptions options;
  options.sparse_format = colmap::Format::kBinary;
  auto writer = RunWriter::Create(path, camera, {"0.1.0", {"pliant"}, 1, "nowhere", {}}, "", {}, options);
  if (!writer.ok()) return false;
  for (int frame = 0; frame < kFrames; ++frame) {
    FrameReport report;
    report.frame_idx = frame;
    report.name = std::to_string(frame) + ".png";
    report.timestamp_s = frame / 30.0;
    report.state = TrackingState::kTracking;
    report.cam_from_world = Rigid3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(-0.01 * frame, 0, 0));
    for (int i = 0; i < kPoints; ++i) {
      const int row = i / kColumns;
      const Eigen::Vector3d rest(0.3 * (i % kColumns - 50), 0.3 * (row - 50), 60);
      const Eigen::Vector3d x = rest + Eigen::Vector3d(0, 0.001 * frame, 0.1 * (i % 7));
      if (frame == 0) report.new_points.push_back({PointId{i}, rest});
      report.observations.push_back({PointId{i}, *camera.Project(*report.cam_from_world * x), x, 0.9});
    }
    if (!writer->Write(report).ok()) return false;
  }
  return writer->Finish(RunStatus::kCompleted, "").ok();
}

// The run, written once; empty when that failed.
const std::string& RunPath(const TemporaryFolder& folder) {
  static const std::string path = MemoryMb([&] { return WriteLongRun(folder.Path("run")); }) ? folder.Path("run") : "";
  return path;
}

void BM_Export(benchmark::State& state, const std::string& format) {
  static const TemporaryFolder folder("export_benchmark");
  if (RunPath(folder).empty()) {
    state.SkipWithError("the run could not be written");
    return;
  }
  std::optional<double> memory_mb;
  for (auto _ : state)
    memory_mb = MemoryMb([&] { return ExportRun({RunPath(folder), "", format, folder.Path("out")}, {}).ok(); });
  std::error_code ignored;
  std::filesystem::remove_all(folder.Path("out"), ignored);
  if (!memory_mb) {
    state.SkipWithError("the export failed");
    return;
  }
  state.counters["seconds_per_million"] =
      benchmark::Counter(kMillions, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["memory_mb"] = *memory_mb;
}

// `database` needs COLMAP.
#define PLIANT_BENCHMARK_EXPORT(name) \
  BENCHMARK_CAPTURE(BM_Export, name, #name)->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(1)
PLIANT_BENCHMARK_EXPORT(canonical);
PLIANT_BENCHMARK_EXPORT(spacetime);
PLIANT_BENCHMARK_EXPORT(frames);
PLIANT_BENCHMARK_EXPORT(ply);
PLIANT_BENCHMARK_EXPORT(trajectories);
PLIANT_BENCHMARK_EXPORT(colmap4d);
PLIANT_BENCHMARK_EXPORT(database);

}  // namespace
}  // namespace pliant
