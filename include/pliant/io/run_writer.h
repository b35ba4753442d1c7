// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Writes a run folder from frame reports, row by row as frames are done, so that a run that is killed keeps what it
// had:
//   config.yaml       as given
//   run.json          `interrupted` until Finish
//   trajectory.txt    a line a tracked frame
//   observations.csv  a row a point and tracked frame
//   frames.csv        a row a frame, written after the frame's other rows
//   map.ply, sparse/  by Finish; of several submaps map.ply, map_1.ply, ... and sparse/0, sparse/1, ...
// Where submaps were merged on the way Finish writes the rows once more, in the worlds that their frames have in the
// end. Units: pixels to 1e-4, positions (map units, mm) and times (s) to 1e-6, quaternions to 1e-9.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/io/canonical_model.h"
#include "pliant/io/run_summary.h"
#include "pliant/scene/frame_report.h"

namespace pliant {

class StateArchive;

enum class RunTimings {
  kWritten,
  kNone,  // zeros instead, so that two runs can be compared byte by byte
};

template <>
struct EnumNames<RunTimings> {
  static constexpr std::array kNames = {std::pair{RunTimings::kWritten, std::string_view("written")},
                                        std::pair{RunTimings::kNone, std::string_view("none")}};
};

// The columns of frames.csv that depend on the program, in order.
struct RunColumns {
  std::vector<std::string> costs;   // cost_<term>
  std::vector<std::string> stages;  // ms_<stage>
};

struct RunWriterOptions {
  RunTimings timings = RunTimings::kWritten;
  colmap::Format sparse_format = colmap::Format::kBoth;
  std::optional<double> total_s = std::nullopt;  // what the run took; nothing: the time from Create to Finish
  bool replaces_run = true;                      // one with poses that is in the folder; false: Create fails there
};

// Whether the folder holds a run with poses; one that failed before it had any is nothing to keep.
bool HoldsRun(const std::filesystem::path& folder);

class RunWriter {
 public:
  // Makes the folder (and those above it) and begins its files. A former run with poses is set aside, and deleted when
  // this one has a pose, or has come to its end without one; where it fails or is stopped before, or the writer goes
  // without Finish, the former run is restored. A folder that holds anything else, and no run, is refused.
  // Fails with kInvalidArgument (a folder with other content), kMismatch (options.replaces_run) or kUnwritable.
  static Result<RunWriter> Create(const std::string& output_path, const Camera& camera, RunDescription description,
                                  const std::string& config_yaml, RunColumns columns,
                                  const RunWriterOptions& options = {});
  // Goes on with a run that was stopped, or killed, from what Serialize wrote when these frames were the last: rows of
  // later ones are cut off, and what Finish made is deleted. The arguments are those of Create; a former run that is
  // still aside stays so. Fails with kUnreadable where rows are missing, or the archive is damaged, and kUnwritable.
  static Result<RunWriter> Resume(const std::string& output_path, const Camera& camera, RunDescription description,
                                  const std::string& config_yaml, RunColumns columns, const RunWriterOptions& options,
                                  StateArchive& archive);
  RunWriter(RunWriter&&) noexcept;
  RunWriter& operator=(RunWriter&&) noexcept;
  ~RunWriter();  // without Finish the folder stays what a killed run leaves

  // Appends one frame. Frames come in growing order. Fails with kUnwritable (a full disk), or kInvalidArgument for a
  // report with numbers that are not finite, a term or a stage that has no column, or an observed point that was never
  // new. A term or a stage that the report does not name is 0.
  Status Write(const FrameReport& report);

  // Writes what Resume needs; all rows are then on the disk itself. Fails with kUnwritable.
  Status Serialize(StateArchive& archive);

  // What became of the images of a live source; before Finish.
  void SetStream(const StreamCounts& stream);

  // RunDescription::warnings, which are known when all images were read; before Finish.
  void SetWarnings(std::vector<std::string> warnings);

  // Brings the rows of merged submaps into one world, writes map.ply, sparse/ and the final run.json; to be called
  // once, whatever ended the run. run.json is attempted even when the others fail, and then says `failed` with the
  // reason. The checkpoint of a run that has come to its end is deleted; before, its rows are kept beside it. Where a
  // former run is restored, summary().note alone says what became of this one.
  Status Finish(RunStatus status, const std::string& note);

  const RunSummary& summary() const;

 private:
  struct State;
  explicit RunWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pliant
