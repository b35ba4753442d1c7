// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The whole job as `pliant track` does it, images decoded and rows written: a simulated scene in which points are
// placed at once (a start from depth) and stay in view. The arguments are the width of the images, the number of points
// and that of threads. Counters:
//   frames_per_second  over the frames in state tracking       points     followed in a frame, mean
//   memory_mb          resident after a frame, largest         memory_growth_mb  from the first third to the end
//
// And a scene that deforms, from images that arrive at 30 frames/s, with first maps and re-estimations beside tracking:
//   p50_ms, p99_ms, max_ms  latency of a frame, from its arrival until it was done, and by the median:
//   p99_by_median, max_by_median   tracked, skipped  share of the frames
//
// And what a point costs, by the number of points (the argument): us_a_point on one thread, points a frame.
#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <malloc.h>
#include <opencv2/videoio.hpp>
#include <unistd.h>

#include "pliant/datasets/open_sequence.h"
#include "pliant/io/ply.h"
#include "pliant/pipeline/track.h"
#include "pliant/simulation/simulator.h"
#include "pliant/simulation/write_sequence.h"
#include "pliant/tracking/stage_times.h"
#include "support/temporary_folder.h"

namespace pliant {
namespace {

using Clock = std::chrono::steady_clock;

double ResidentMb() {
  std::ifstream statm("/proc/self/statm");
  double all_pages = 0;
  double resident_pages = 0;
  statm >> all_pages >> resident_pages;
  return resident_pages * static_cast<double>(sysconf(_SC_PAGESIZE)) * 1e-6;
}

// Writes a scene that stays in view; the empty path when that failed.
std::filesystem::path WriteHeldScene(const std::filesystem::path& sequence, int frames, int width, int height) {
  SimulationOptions options;
  options.trajectory.kind = TrajectoryKind::kHold;
  options.trajectory.frames = frames;
  options.camera.width = width;
  options.camera.height = height;
  options.deformation.amplitude_mm = 1.0;
  options.sensor.samples = 1;
  const bool written = WriteSequence(options, sequence).ok();
  malloc_trim(0);  // the renderer's memory is not the tracker's
  return written ? sequence : std::filesystem::path();
}

// The images of a sequence as a video, as recordings of that size are, and the first frame's depth as a cloud.
bool WriteAsVideo(const std::filesystem::path& sequence, const std::string& video, const std::string& cloud) {
  auto opened = OpenSequence({.image_path = sequence});
  if (!opened.ok()) return false;
  const Camera& camera = (*opened)->camera();
  const auto depth_mm = (*opened)->Depth(0);
  if (!depth_mm.ok() || !depth_mm->has_value()) return false;
  constexpr int kStep_px = 8;
  std::vector<NewPoint> points;
  for (int v = 0; v < camera.height(); v += kStep_px)
    for (int u = 0; u < camera.width(); u += kStep_px)
      if (const double z = (*depth_mm)->at<float>(v, u); z > 0)
        if (const auto ray = camera.Unproject(Eigen::Vector2d(u, v)); ray && ray->z() > 0)
          points.push_back({.id = PointId{std::ssize(points)}, .position = *ray * (z / ray->z())});
  if (!WritePly(cloud, points).ok()) return false;
  cv::VideoWriter writer(video, cv::CAP_FFMPEG, cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 30,
                         {camera.width(), camera.height()});
  if (!writer.isOpened()) return false;
  for (auto frame = (*opened)->Next(); frame.ok() && frame->has_value(); frame = (*opened)->Next())
    writer.write((*frame)->image);
  return true;
}

// Rendered once: 90 frames of 640x480 as images, 60 of 1920x1080 as a video.
struct HeldScene {
  HeldScene(int width, int height, int number, bool as_video) : frames(number) {
    folder.emplace("run_benchmark_" + std::to_string(width));
    const std::filesystem::path sequence = WriteHeldScene(folder->Path("sequence"), frames, width, height);
    request.input.image_path = sequence;
    if (as_video && !sequence.empty()) {
      cloud_path = folder->Path("depth.ply");
      const std::string video = folder->Path("video.mp4");
      request.input.image_path = WriteAsVideo(sequence, video, cloud_path) ? video : "";
      request.input.camera_path = sequence / "camera.yaml";
    }
    request.output_path = folder->Path("run");
  }

  int frames;
  std::optional<TemporaryFolder> folder;
  RunRequest request;      // without images: it could not be written
  std::string cloud_path;  // empty: the sequence has depth images
};

const HeldScene& SceneOf(std::int64_t width) {
  static const HeldScene small(640, 480, 90, false);
  if (width == 640) return small;
  static const HeldScene large(1920, 1080, 60, true);
  return large;
}

class Meter : public TrackObserver {
 public:
  void OnStart(int) override {}
  void OnFrame(const FrameReport& report) override {
    if (!HasPose(report.state)) return;
    const auto now = Clock::now();
    if (frames_ > 0) seconds_ += std::chrono::duration<double>(now - last_).count();
    last_ = now;
    ++frames_;
    points_ += report.tracked;
    resident_mb_.push_back(ResidentMb());
  }

  void Report(benchmark::State& state, int frames) const {
    if (frames_ < frames / 2) {
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
  Clock::time_point last_;
  std::vector<double> resident_mb_;
};

// So near to each other that 10,000 fit into an image of 1920x1080, which is not made smaller.
void SetPoints(int count, TrackOptions* options) {
  options->image.working = WorkingImageMode::kFixed;
  options->tracker.corners.min_distance_px = 5;
  options->tracker.corners.max_corners = count;
  options->tracker.max_lost_points = count;
}

void BM_Run(benchmark::State& state) {
  const HeldScene& scene = SceneOf(state.range(0));
  if (scene.request.input.image_path.empty()) {
    state.SkipWithError("the sequence could not be written");
    return;
  }
  TrackOptions options = MakeTrackOptions(Preset::kDefault);
  options.threads = static_cast<int>(state.range(2));
  options.tracker.init.method = InitMethod::kDepth;
  options.tracker.init.depth.cloud_path = scene.cloud_path;
  if (const int points = static_cast<int>(state.range(1)); points != options.tracker.corners.max_corners)
    SetPoints(points, &options);
  Meter meter;
  const std::array<TrackObserver*, 1> observers = {&meter};
  for (auto _ : state) {
    meter = Meter();
    const Result<RunSummary> run = RunTrack(scene.request, options, observers);
    if (!run.ok()) {
      state.SkipWithError(run.status().message().c_str());
      return;
    }
  }
  meter.Report(state, scene.frames);
}
BENCHMARK(BM_Run)
    ->ArgNames({"width", "points", "threads"})
    ->Args({640, 500, 1})
    ->Args({640, 500, 2})
    ->Args({1920, 500, 2})
    ->Args({1920, 2000, 2})
    ->Args({1920, 10000, 2})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Iterations(1);

constexpr int kRendered = 100;
constexpr int kShown = 600;
constexpr std::chrono::duration<double> kInterval(1.0 / 30.0);

// A camera in front of a scene that goes forwards, backwards, and so on, from the first time that an image is asked
// for: the newest one counts.
class ArrivingImages : public ImageSource {
 public:
  explicit ArrivingImages(std::vector<cv::Mat> images) : images_(std::move(images)) {}
  int count() const override { return 0; }
  bool IsLive() const override { return true; }
  int Passed() const override {
    const std::lock_guard lock(mutex_);
    return passed_ = static_cast<int>(taken_.size());
  }
  // Of the images that arrived since tracking began.
  double SkippedShare() const {
    const int arrived = taken_.back() + 1 - taken_[static_cast<std::size_t>(passed_)];
    return 1 - static_cast<double>(std::ssize(taken_) - passed_) / arrived;
  }
  std::optional<Clock::time_point> Arrived(int idx) const override {
    const std::lock_guard lock(mutex_);
    return ArrivalOf(taken_[static_cast<std::size_t>(idx)]);
  }
  Result<std::optional<cv::Mat>> Read(int idx) override {
    const std::lock_guard lock(mutex_);
    if (taken_.empty()) begin_ = Clock::now();
    if (std::cmp_equal(taken_.size(), idx)) {
      const int next = taken_.empty() ? 0 : taken_.back() + 1;
      const int number = std::max(next, static_cast<int>((Clock::now() - begin_) / kInterval));
      if (number >= kShown) return std::optional<cv::Mat>();
      std::this_thread::sleep_until(ArrivalOf(number));
      taken_.push_back(number);
    }
    const int turns = static_cast<int>(images_.size()) - 1;
    const int at = taken_[static_cast<std::size_t>(idx)] % (2 * turns);
    return std::optional(images_[static_cast<std::size_t>(at <= turns ? at : 2 * turns - at)]);
  }

 private:
  Clock::time_point ArrivalOf(int number) const {
    return begin_ + std::chrono::duration_cast<Clock::duration>(number * kInterval);
  }

  std::vector<cv::Mat> images_;
  mutable std::mutex mutex_;
  Clock::time_point begin_;
  std::vector<int> taken_;  // the camera's number of each
  mutable int passed_ = 0;  // of these, before tracking began
};

void BM_Latency(benchmark::State& state) {
  SimulationOptions scene;
  scene.trajectory.frames = kRendered;
  scene.trajectory.speed_mm_s = 15;
  scene.deformation.amplitude_mm = 2.5;
  scene.sensor.samples = 1;
  auto simulator = Simulator::Create(scene);
  if (!simulator.ok()) {
    state.SkipWithError(simulator.status().message().c_str());
    return;
  }
  std::vector<cv::Mat> images;
  for (int idx = 0; idx < kRendered; ++idx) images.push_back(simulator->Render(idx).image.clone());
  TrackOptions options = MakeTrackOptions(Preset::kDefault);
  options.image.working = WorkingImageMode::kFixed;
  const TemporaryFolder folder("latency_benchmark");
  RunSummary summary;
  std::shared_ptr<ArrivingImages> source;
  for (auto _ : state) {
    source = std::make_shared<ArrivingImages>(images);
    RunRequest request;
    GivenImages given{.camera = simulator->camera(), .images = source};
    request.input.given = std::make_shared<const GivenImages>(std::move(given));
    request.output_path = folder.Path("run");
    const Result<RunSummary> run = RunTrack(request, options, {});
    if (!run.ok() || !run->latency) {
      state.SkipWithError("the images were not tracked");
      return;
    }
    summary = *run;
  }
  const Latency& latency = *summary.latency;
  state.counters["p50_ms"] = latency.p50;
  state.counters["p99_ms"] = latency.p99;
  state.counters["max_ms"] = latency.max;
  state.counters["p99_by_median"] = latency.p99 / latency.p50;
  state.counters["max_by_median"] = latency.max / latency.p50;
  state.counters["tracked"] = static_cast<double>(summary.frames_tracked) / static_cast<double>(summary.frames_read);
  state.counters["skipped"] = source->SkippedShare();
}

BENCHMARK(BM_Latency)->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(1);

// What a tracked point costs in images of 1920x1080: all stages that look at points, after the first frames.
class PointMeter : public TrackObserver {
 public:
  void OnStart(int) override {}
  void OnFrame(const FrameReport& report) override {
    if (!HasPose(report.state) || report.frame_idx < kSkipped) return;
    for (const auto& [stage, ms] : report.stage_ms)
      if (stage != EnumName(Stage::kPrepare) && stage != EnumName(Stage::kInitialize)) ms_ += ms;
    points_ += report.tracked;
    ++frames_;
  }
  int frames() const { return frames_; }
  double PointsAFrame() const { return static_cast<double>(points_) / frames_; }
  double MicrosecondsAPoint() const { return 1e3 * ms_ / static_cast<double>(points_); }

 private:
  static constexpr int kSkipped = 3;
  int frames_ = 0;
  long points_ = 0;
  double ms_ = 0;
};

void BM_Points(benchmark::State& state) {
  TrackOptions options = MakeTrackOptions(Preset::kDefault);
  options.threads = 1;
  options.tracker.init.method = InitMethod::kDepth;
  SetPoints(static_cast<int>(state.range(0)), &options);
  const HeldScene& scene = SceneOf(1920);
  options.tracker.init.depth.cloud_path = scene.cloud_path;
  RunRequest request = scene.request;
  request.input.end = 12;
  PointMeter meter;
  const std::array<TrackObserver*, 1> observers = {&meter};
  for (auto _ : state) {
    meter = PointMeter();
    const Result<RunSummary> run = RunTrack(request, options, observers);
    if (!run.ok() || meter.frames() == 0) {
      state.SkipWithError("the sequence was not tracked");
      return;
    }
  }
  state.counters["points"] = meter.PointsAFrame();
  state.counters["us_a_point"] = meter.MicrosecondsAPoint();
}
BENCHMARK(BM_Points)->Arg(500)->Arg(2000)->Arg(10000)->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(1);

}  // namespace
}  // namespace pliant
