// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/relative_depth.h"

#include <cmath>
#include <utility>

#include "pliant/base/statistics.h"

namespace pliant {
RelativeDepthFrame CompareDepths(int frame_idx, std::span<const DepthPair> pairs, NullDepths null) {
  std::vector<double> ratios;
  std::vector<double> depths;
  for (const DepthPair& pair : pairs) {
    ratios.push_back(std::log(pair.depth / pair.other));
    depths.push_back(std::log(null == NullDepths::kOfRun ? pair.depth : pair.other));
  }
  return {frame_idx, static_cast<int>(pairs.size()), MedianDeviation(std::move(ratios)),
          MedianDeviation(std::move(depths))};
}

Result<RelativeDepthError> Summarize(std::vector<RelativeDepthFrame> frames, const std::string& why) {
  if (frames.empty()) return Status(ErrorCode::kInsufficient, why);
  RelativeDepthError error;
  std::vector<double> differences;
  std::vector<double> nulls;
  for (const RelativeDepthFrame& frame : frames) {
    error.points += frame.points;
    differences.push_back(frame.difference);
    nulls.push_back(frame.null);
  }
  error.difference = Median(std::move(differences));
  error.null = Median(std::move(nulls));
  error.frames = std::move(frames);
  return error;
}

}  // namespace pliant
