// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The depths of a run against those of structure from motion (sfm_points.h), after one scale a frame
// (relative_depth.h). The reconstructed points are sparse and seldom at a point's pixel, so its true depth is the mean
// of the three nearest ones, weighted by 1 / (distance + 2 px), or that of the nearest one where the third is far. A
// point without a reconstructed one near it, or among points of different depths (an edge), is left out. The
// reconstruction is rigid and has errors of its own: its depths are good to about a percent.
#pragma once

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/datasets/sfm_points.h"
#include "pliant/evaluation/relative_depth.h"
#include "pliant/evaluation/run_input.h"

namespace pliant {

struct SfmErrorOptions {
  double max_distance = 0.01;        // from a point to the nearest reconstructed one, by the image's width
  double max_third_distance = 0.03;  // to the third nearest, or the nearest alone is taken; by the image's width
  double max_depth_step = 0.15;      // largest minus smallest of the depths that are averaged, by their mean
  int min_points = 8;                // compared in a frame that counts

  void List(OptionTable& table);
};

// `width_px`: the image's width. The null is of the reconstructed depths. Fails with kInsufficient where no frame has
// enough points to compare.
Result<RelativeDepthError> ComputeSfmError(const EvaluationInput& run, const SfmPoints& sfm, int width_px,
                                           const SfmErrorOptions& options);

}  // namespace pliant
