// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Whether images are those that a run was tracked in.
#pragma once

#include <set>
#include <span>

#include <opencv2/core/mat.hpp>

#include "pliant/io/run_map.h"
#include "pliant/scene/frame_report.h"

namespace pliant {

// The colors that a run gave its points, against those at the points' pixels. A point is a corner: a few pixels beside
// it the image has other colors, so that where it is as far from its own color as there, the image is another one.
class PointColors {
 public:
  explicit PointColors(const RunMap& known) : known_(known) {}

  // What the run has seen in a frame, and its image: 8-bit, 1 or 3 (BGR) channels. Frames come in order; a point counts
  // in the first one that has it.
  void Compare(std::span<const PointObservation> observations, const cv::Mat& image);
  // Whether the images that were compared are others. False where few points, or points without a color, say nothing.
  bool AreOfOtherImages() const;

 private:
  const RunMap& known_;
  std::set<PointId> seen_;
  // Sums of the distances from the points' colors, gray levels: at the points, and beside them.
  double at_ = 0;
  double beside_ = 0;
};

}  // namespace pliant
