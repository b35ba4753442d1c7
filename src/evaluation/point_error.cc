// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/point_error.h"

#include <algorithm>
#include <map>
#include <utility>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

// The null's estimate: every point of a frame on its pixel's ray at depth 1.
std::vector<PointPair> NullPairs(std::span<const PointPair> pairs) {
  std::vector<PointPair> null;
  null.reserve(pairs.size());
  for (const PointPair& pair : pairs) null.push_back({pair.ray, pair.truth, pair.ray});
  return null;
}

// Errors of many frames together.
struct Pool {
  std::vector<double> errors_mm;
  std::vector<double> relative_depths;
  std::vector<double> frame_rmses_mm;
  std::vector<double> frame_medians_mm;
  std::vector<double> scales;
  int left_out = 0;

  PointFigures Add(const ProtocolErrors& frame, double scale);
  PointSummary Summary() const;
};

PointFigures Pool::Add(const ProtocolErrors& frame, double scale) {
  const PointFigures figures{scale, static_cast<int>(frame.errors_mm.size()), Rms(frame.errors_mm),
                             Median(frame.errors_mm), Median(frame.relative_depths)};
  errors_mm.insert(errors_mm.end(), frame.errors_mm.begin(), frame.errors_mm.end());
  relative_depths.insert(relative_depths.end(), frame.relative_depths.begin(), frame.relative_depths.end());
  frame_rmses_mm.push_back(figures.rmse_mm);
  frame_medians_mm.push_back(figures.median_mm);
  scales.push_back(scale);
  left_out += frame.left_out;
  return figures;
}

PointSummary Pool::Summary() const {
  PointSummary summary;
  summary.mean_rmse_mm = Mean(frame_rmses_mm);
  summary.pooled_rmse_mm = Rms(errors_mm);
  summary.pooled_median_mm = Median(errors_mm);
  summary.mean_median_mm = Mean(frame_medians_mm);
  summary.median_relative_depth = Median(relative_depths);
  summary.min_scale = *std::min_element(scales.begin(), scales.end());
  summary.max_scale = *std::max_element(scales.begin(), scales.end());
  summary.left_out_share = left_out / static_cast<double>(left_out + static_cast<int>(errors_mm.size()));
  for (std::size_t k = 0; k < kNearDistances_mm.size(); ++k) {
    const auto near = std::ranges::count_if(errors_mm, [&](double error) { return error <= kNearDistances_mm[k]; });
    summary.within[k] = errors_mm.empty() ? 0.0 : static_cast<double>(near) / static_cast<double>(errors_mm.size());
    summary.average_within += summary.within[k] / static_cast<double>(kNearDistances_mm.size());
  }
  return summary;
}

// One scale for all frames of a submap.
struct SubmapScale {
  double estimate = 1;
  double null_depth = 1;
};

std::map<int, SubmapScale> SubmapScales(std::span<const PairedFrame> frames, ErrorProtocol protocol, ErrorScale scale) {
  std::map<int, std::vector<PointPair>> submaps;
  for (const PairedFrame& frame : frames)
    submaps[frame.submap].insert(submaps[frame.submap].end(), frame.pairs.begin(), frame.pairs.end());
  std::map<int, SubmapScale> scales;
  for (const auto& [idx, pairs] : submaps) {
    if (pairs.empty()) continue;
    if (scale == ErrorScale::kGlobal) scales[idx].estimate = ProtocolScale(pairs, protocol);
    // The null has no millimeters of its own: without per-frame scales it gets the best one depth.
    scales[idx].null_depth = ProtocolScale(NullPairs(pairs), protocol);
  }
  return scales;
}

// At least one frame has a pair.
ProtocolError ComputeProtocolError(std::span<const PairedFrame> frames, ErrorProtocol protocol,
                                   const PointErrorOptions& options) {
  const bool per_frame = options.scale == ErrorScale::kPerFrame;
  std::map<int, SubmapScale> scales;
  if (!per_frame) scales = SubmapScales(frames, protocol, options.scale);
  ProtocolError error;
  error.protocol = protocol;
  Pool estimates;
  Pool nulls;
  const auto figures = [&](std::span<const PointPair> pairs, double fixed_scale, Pool* pool) {
    const double scale = per_frame ? ProtocolScale(pairs, protocol) : fixed_scale;
    return pool->Add(ApplyProtocol(pairs, scale, protocol, options.protocol), scale);
  };
  for (const PairedFrame& frame : frames) {
    if (frame.pairs.empty()) continue;
    PointFrameError row;
    row.frame_idx = frame.frame_idx;
    row.estimate = figures(frame.pairs, scales[frame.submap].estimate, &estimates);
    row.null = figures(NullPairs(frame.pairs), scales[frame.submap].null_depth, &nulls);
    error.frames.push_back(row);
  }
  error.estimate = estimates.Summary();
  error.null = nulls.Summary();
  return error;
}

}  // namespace

void PointErrorOptions::List(OptionTable& table) {
  table.AddChoices("protocol", &protocols, "how points are compared; the plain figure of paper is given in any case");
  table.AddChoice("scale", &scale, "factor of the estimate: the paper's is per_frame after a monocular start");
  table.Add("max_depth_step", &max_depth_step, "-",
            "relative depth step around a pixel above which the true depth is not interpolated", 0.0, 10.0);
  table.Add("max_truth_sigma_mm", &max_truth_sigma_mm, "mm",
            "uncertainty of a true depth, where it is known (pairs of images), above which it is not used", 0.0, 1e6);
  protocol.List(table);
}

LeftOutCounts& LeftOutCounts::operator+=(const LeftOutCounts& other) {
  outside_image += other.outside_image;
  no_depth += other.no_depth;
  depth_step += other.depth_step;
  uncertain += other.uncertain;
  no_ray += other.no_ray;
  not_finite += other.not_finite;
  return *this;
}

std::string Describe(const LeftOutCounts& counts) {
  const std::string uncertain =
      counts.uncertain > 0 ? std::to_string(counts.uncertain) + " of uncertain truth, " : std::string();
  return std::to_string(counts.depth_step) + " on a depth step, " + std::to_string(counts.no_depth) +
         " without true depth, " + uncertain + std::to_string(counts.outside_image) + " outside the image, " +
         std::to_string(counts.no_ray) + " without a ray, " + std::to_string(counts.not_finite) + " not a number";
}

Result<PointError> ComputePointError(std::span<const PairedFrame> frames, const PointErrorOptions& options) {
  PointError error;
  error.scale = options.scale;
  std::vector<PointPair> all;
  for (const PairedFrame& frame : frames) {
    error.left_out += frame.left_out;
    if (frame.pairs.empty())
      ++error.frames_without_pair;
    else
      error.frame_left_out.push_back(frame.left_out);
    all.insert(all.end(), frame.pairs.begin(), frame.pairs.end());
  }
  error.points = static_cast<int>(all.size());
  std::vector<double> truth_sigmas_mm;
  for (const PointPair& pair : all) truth_sigmas_mm.push_back(pair.truth_sigma_mm);
  error.truth_sigma_mm = Rms(truth_sigmas_mm);
  if (all.empty())
    return Status(ErrorCode::kInsufficient, "no point has a true position to compare with: of " +
                                                std::to_string(error.left_out.Total()) + " observations " +
                                                Describe(error.left_out) + "; check that the truth is this run's");
  error.plain = ComputeProtocolError(frames, ErrorProtocol::kPaper, options);
  for (const auto& [protocol, name] : EnumNames<ErrorProtocol>::kNames) {
    if (std::find(options.protocols.begin(), options.protocols.end(), protocol) == options.protocols.end()) continue;
    error.protocols.push_back(protocol == ErrorProtocol::kPaper ? error.plain
                                                                : ComputeProtocolError(frames, protocol, options));
  }
  return error;
}

}  // namespace pliant
