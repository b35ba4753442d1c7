// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Reads run folders: Pliant's, also of runs that were killed, and other programs' results that consist of
// trajectory.txt and observations.csv alone. The last line of a file may be cut off: it is left out and counted.
// Anything else that cannot be read is an error with file and line.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/io/run_summary.h"
#include "pliant/scene/frame_report.h"

namespace pliant {

// A row of frames.csv.
struct RunFrame {
  int frame_idx = 0;
  double timestamp_s = 0;
  TrackingState state = TrackingState::kWaitingForReference;
  int tracked = 0;
  int optimized = 0;
  int lost = 0;
  int added = 0;
  std::vector<CostTerm> costs;  // of the columns cost_<name>, in their order
  double median_reprojection_error_px = 0;
  int submap = 0;                // whose world the frame's pose and points are in
  std::vector<double> stage_ms;  // as Run::stage_names
  double latency_ms = 0;         // FrameReport::latency_ms; 0 where it was not measured
};

struct RunPose {
  std::optional<int> frame_idx;  // nothing in another program's result: its time tells the frame
  double timestamp_s = 0;
  Rigid3 world_from_cam;
  int submap = 0;
};

struct Run {
  std::optional<RunSummary> summary;  // nothing: another program's result
  std::vector<std::string> stage_names;
  std::vector<RunFrame> frames;  // empty: another program's result
  std::vector<RunPose> poses;    // a pose a tracked frame; its frame is the row of frames.csv with state `tracking`
  int cut_lines = 0;             // last lines that were cut off, in trajectory.txt and frames.csv
};

// Fails with kNotFound (no folder, no trajectory.txt, no observations.csv), kUnreadable (file and line) or kMismatch
// (poses that belong to no row of frames.csv).
Result<Run> ReadRun(const std::string& path);

// CRC-32 of the bytes of trajectory.txt, eight hexadecimal digits: what was made of a run tells by it that another run
// is in the folder now. Fails with kNotFound or kUnreadable.
Result<std::string> TrajectoryChecksum(const std::string& run_path);

struct FrameObservations {
  int frame_idx = 0;
  std::vector<PointObservation> observations;
};

// observations.csv, a frame at a time: memory does not grow with the run. Another program's may have no column ssim; it
// is not a number then.
class ObservationReader {
 public:
  // `path` is the run folder. Fails with kNotFound, or kUnreadable for a header that is not a run's.
  static Result<ObservationReader> Open(const std::string& path);
  ObservationReader(ObservationReader&&) noexcept;
  ObservationReader& operator=(ObservationReader&&) noexcept;
  ~ObservationReader();

  // The next frame's rows, nothing at the end. A frame whose last row was cut off is returned without that row. Fails
  // with kUnreadable for a row that is not numbers, that repeats a point, or whose frame is before the one before.
  Result<std::optional<FrameObservations>> Next();
  // The rows of frame `frame_idx`, none where the file has none. Frames before it are passed over, so frames are asked
  // for in growing order. Fails as Next.
  Result<std::vector<PointObservation>> Of(int frame_idx);
  int cut_lines() const;

 private:
  struct State;
  explicit ObservationReader(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// Calls `function(k, observations)` for each of a run's frames `frames_idx`, which grow, in order: with what
// observations.csv has of frame `frames_idx[k]`, or with nothing. Fails as the reader does, or as `function`.
using ObservationsFunction = std::function<Status(std::size_t, const std::vector<PointObservation>&)>;
Status ForEachFrame(const std::string& run_path, std::span<const int> frames_idx, const ObservationsFunction& function);

}  // namespace pliant
