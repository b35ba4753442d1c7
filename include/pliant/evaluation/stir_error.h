// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How far tracked points end from labelled ones, by the measures of the STIR challenge (io/stir_file.h), in pixels or
// in millimeters. The labelled points of the end belong to no point of the start, so that a point's distance is that to
// the nearest of them.
//   accuracy at d    share of the points, of all recordings together, whose distance is at most d
//   end point error  mean distance in a recording, then the mean of the recordings
// The null is the challenge's control: the labelled points of the start, as though nothing had moved.
#pragma once

#include <array>
#include <string>

#include "pliant/base/status.h"
#include "pliant/io/stir_file.h"

namespace pliant {

struct StirAccuracy {
  int points = 0;
  std::array<double, 5> within = {};  // at StirError::thresholds
  double average_within = 0;          // the mean of these
  double end_point_error = 0;
};

struct StirError {
  int dimensions = 2;                     // 2: px, 3: mm
  int recordings = 0;                     // of the tracked points; others are not scored
  std::array<double, 5> thresholds = {};  // 4, 8, 16, 32, 64 px, or 2, 4, 8, 16, 32 mm
  StirAccuracy estimate;
  StirAccuracy null;
};

// Fails with kInsufficient where no point was tracked, and with kMismatch where a recording has no labelled points at
// its start or its end, or not as many tracked points as labelled ones at its start (3D: fewer), or one file is in
// pixels and another one in millimeters.
Result<StirError> ComputeStirError(const StirPoints& tracked, const StirPoints& start, const StirPoints& end);

// The same of files. Fails also as ReadStirPoints.
struct StirRequest {
  std::string tracked_path;
  std::string start_path;
  std::string end_path;
};
Result<StirError> EvaluateStir(const StirRequest& request);

// A few lines for a person; and every figure by name, which WriteStirError writes into stir.json in `folder`
// (kUnwritable).
std::string StirTable(const StirError& error);
std::string StirJson(const StirError& error);
Status WriteStirError(const StirError& error, const std::string& folder);

}  // namespace pliant
