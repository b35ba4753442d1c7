// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The error of estimated points against true ones, frame by frame and over the run, through one or several protocols
// (protocol.h):
//   e_t = sqrt( sum_i | s_t X_i - X_i^gt |^2 / n_t )        plain: no point is left out
// What X_i^gt is makes it a surface error (surface_error.h) or a material error (material_error.h). Beside every figure
// stands its NULL: the same pixels, all at one constant depth, through the same protocol. A figure no better than its
// null says that nothing was reconstructed. Millimeters throughout.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/evaluation/protocol.h"

namespace pliant {

struct PointErrorOptions {
  std::vector<ErrorProtocol> protocols = {ErrorProtocol::kPaper};  // the paper's is computed in any case
  ErrorScale scale = ErrorScale::kPerFrame;
  double max_depth_step = 0.05;   // relative step among the four pixels around an observation, above it no truth
  double max_truth_sigma_mm = 1;  // of a point's true depth, where it is known how certain it is: above it no truth
  ProtocolOptions protocol;

  void List(OptionTable& table);
};

// Observations without a pair, by reason. In a material error the first four speak of the track's first pixel.
struct LeftOutCounts {
  int outside_image = 0;  // no four pixels around
  int no_depth = 0;       // the truth has a hole there
  int depth_step = 0;     // the truth is discontinuous there
  int uncertain = 0;      // or too uncertain
  int no_ray = 0;         // the camera model has no forward ray there
  int not_finite = 0;     // the estimate is not a number

  int Total() const { return outside_image + no_depth + depth_step + uncertain + no_ray + not_finite; }
  LeftOutCounts& operator+=(const LeftOutCounts& other);
};

std::string Describe(const LeftOutCounts& counts);

// All of one frame that has truth.
struct PairedFrame {
  int frame_idx = 0;
  std::vector<PointPair> pairs;
  LeftOutCounts left_out;
  int submap = 0;  // whose unit the estimates are in
};

// The figures of one set of pairs, of the estimate or of its null.
struct PointFigures {
  double scale = 1;
  int points = 0;  // that count
  double rmse_mm = 0;
  double median_mm = 0;
  double median_relative_depth = 0;  // median of |s z - z_gt| / z_gt
};

struct PointFrameError {
  int frame_idx = 0;
  PointFigures estimate;
  PointFigures null;
};

// At which points are near their truth: those of the STIR challenge in space (stir_error.h).
inline constexpr std::array<double, 5> kNearDistances_mm = {2, 4, 8, 16, 32};

// Over all frames that have a pair.
struct PointSummary {
  double mean_rmse_mm = 0;           // mean over frames of the frames' RMSE: the paper's figure
  double pooled_rmse_mm = 0;         // over all observations at once
  double pooled_median_mm = 0;       // median over all observations
  double mean_median_mm = 0;         // mean over frames of the frames' medians
  double median_relative_depth = 0;  // over all observations
  double min_scale = 1;              // smallest and largest of the frames' scales
  double max_scale = 1;
  double left_out_share = 0;          // of the pairs, by the protocol
  std::array<double, 5> within = {};  // share of all observations at most kNearDistances_mm from the truth
  double average_within = 0;          // the mean of these
};

struct ProtocolError {
  ErrorProtocol protocol = ErrorProtocol::kPaper;
  std::vector<PointFrameError> frames;  // those with at least one pair, in order
  PointSummary estimate;
  PointSummary null;
};

struct PointError {
  ErrorScale scale = ErrorScale::kPerFrame;
  ProtocolError plain;                   // the paper's protocol: every pair counts
  std::vector<ProtocolError> protocols;  // those asked for, each once, in the order of their names in protocol.h
  int points = 0;                        // pairs in all
  double truth_sigma_mm = 0;             // of the truth of these, root mean square; 0: exact, or not known
  int frames_without_pair = 0;           // tracked, with truth, but every observation was left out
  LeftOutCounts left_out;
  std::vector<LeftOutCounts> frame_left_out;  // as plain.frames
};

// Fails with kInsufficient when no frame has a pair; the sentence says what was left out and why.
Result<PointError> ComputePointError(std::span<const PairedFrame> frames, const PointErrorOptions& options);

}  // namespace pliant
