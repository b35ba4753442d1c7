// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A run folder in, the refined run's folder out: every submap by itself (pliant/refinement/refine_recording.h), with
// the states, times and names of the run. Observations of wrong tracks are left out.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/io/run_summary.h"
#include "pliant/refinement/refine_recording.h"

namespace pliant {

struct RefineRequest {
  std::string run_path;
  std::string sequence_path;              // images of a run without sparse/; empty: those that its run.json names
  std::string camera_path;                // their calibration; empty: the one that belongs to them
  std::string output_path;                // a folder, made if need be; neither the run's nor in it
  std::vector<std::string> command_line;  // for run.json
  const std::atomic<bool>* stop =
      nullptr;  // becomes true when the last solution of all frames is to be written, if there is one; may be null
};

// What became of one submap.
struct SubmapRefinement {
  int submap = 0;
  bool deforming = false;
  double residual_correlation = 0;
  double noise_px = 0;
  int frames = 0;
  int points = 0;              // that are left
  int observations = 0;        // of the run
  int wrong_observations = 0;  // left out
  std::string failure;         // why it is in the refined run as it is in the run; empty: it was refined
};

// What became of the focal length where it was to be estimated.
struct RefinedFocalLength {
  double assumed_px = 0;
  double estimated_px = 0;  // 0: it was not, and `failure` says why
  double sigma_px = 0;
  double distortion = 0;        // k of SIMPLE_RADIAL; 0: held
  double distortion_sigma = 0;  // likewise
  std::string failure;
};

struct RefineSummary {
  std::vector<SubmapRefinement> submaps;
  std::optional<RefinedFocalLength> focal_length;
  RunSummary run;        // of the refined run
  bool stopped = false;  // on request: the last solution of all frames was written
};

using RefineProgress = std::function<void(const RefinementProgress&)>;

// Fails with kInvalidArgument where the refined run would overwrite the run or be in its folder, as RefineRun does.
Status CheckPaths(const RefineRequest& request);

// A submap of several that cannot be refined stays as it is. A focal length that is estimated is that of the refined
// run, whose folder then holds its camera.yaml; where the recording does not determine it the camera's is kept. Fails
// with kNotFound, kUnreadable or kMismatch for a run that cannot be read, kInsufficient for one without points or of a
// single frame, kInvalidArgument as CheckPaths and for an output folder that holds something else, kUnwritable. The
// output folder is not touched before the refinement is done; the refined run then appears in it whole, and where that
// fails what was there before is still there.
Result<RefineSummary> RefineRun(const RefineRequest& request, const RefineOptions& options,
                                const RefineProgress& callback);

}  // namespace pliant
