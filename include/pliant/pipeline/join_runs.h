// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Run folders of parts of one recording in, one run folder out. Consecutive parts overlap: in the frames that both
// have, their cameras and the depths at the same pixels tell how the worlds of the two lie to each other (J1, J2 in
// docs/method.md). Depths are compared, and points followed, as the parts have them: nothing is solved for again.
#pragma once

#include <string>
#include <vector>

#include "pliant/base/job_progress.h"
#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/io/run_summary.h"

namespace pliant {

struct JoinOptions {
  double max_distance = 0.01;         // of the image's width, between two points whose depths are compared
  int min_points = 12;                // that are compared in the frames of an overlap
  double max_depth_difference = 0.2;  // median |log ratio| of these depths, after one scale, where worlds are joined
  double max_same_distance = 0.002;   // of the image's width, of points that are one
  void List(OptionTable& table);      // group "Join"
};

struct JoinRequest {
  std::vector<std::string> run_paths;     // two or more, in any order
  std::string sequence_path;              // images of a run without sparse/; empty: those that its run.json names
  std::string camera_path;                // their calibration; empty: the one that belongs to them
  std::string output_path;                // a folder, made if need be; none of the runs', nor in one
  std::vector<std::string> command_line;  // for run.json
};

// How two submaps of consecutive runs were joined, or why they were not.
struct RunJoint {
  std::string run;  // the later one
  std::string before;
  int frames = 0;               // that have a pose in both
  int points = 0;               // pairs of points at the same pixels, over all these frames
  double scale = 1;             // a unit of the later one's world in the earlier one's
  double depth_difference = 0;  // median |log ratio of the depths at the same pixels|, after that scale
  double depth_spread = 0;  // median |log(depth / median depth)|: what depth_difference would be of one constant depth
  int same_points = 0;      // that are one
  std::string failure;      // why the later run's submap stays one of its own; empty: they are joined
};

struct JoinSummary {
  std::vector<RunJoint> joints;  // at least one for each run but the first, in the order of time
  RunSummary run;                // of the joined run
};

// Whether the paths can be those of a join. Fails with kInvalidArgument where fewer than two runs are given, or one of
// them twice, and where the joined run would overwrite one of them or be in its folder. JoinRuns fails likewise.
Status CheckPaths(const JoinRequest& request);

// A frame that several runs have is the earlier run's up to the middle of their overlap, then the later one's; where
// only one of them has a pose, that one's. Of runs that are metric the unit stays. Fails with kNotFound, kUnreadable or
// kMismatch for a run that cannot be read, is another program's, or is not of the same images, calibration and stride
// as the first, kInsufficient where no run has a pose, kInvalidArgument as CheckPaths and for an output
// folder that holds something else, kUnwritable, and kInterrupted where `progress` asks to stop, which is heeded until
// all frames are written. The joined run appears in the output folder whole, and where that fails what was there before
// is still there.
Result<JoinSummary> JoinRuns(const JoinRequest& request, const JoinOptions& options, const JobProgress& progress);

}  // namespace pliant
