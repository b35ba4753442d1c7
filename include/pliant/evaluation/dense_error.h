// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A dense depth against the true one, by the figures of the literature on depth (Eigen, Puhrsch and Fergus, NIPS 2014),
// over the pixels that have both. Beside them the same pixels by what the run's points alone say, and by one depth.
#pragma once

#include <array>
#include <optional>

#include "pliant/base/status.h"
#include "pliant/datasets/sequence.h"
#include "pliant/datasets/surface_folder.h"
#include "pliant/evaluation/protocol.h"
#include "pliant/evaluation/run_input.h"

namespace pliant {

// Means over the frames; x the depth after its scale, y the true one, mm.
struct DepthFigures {
  double abs_rel = 0;                    // mean |x - y| / y
  double sq_rel_mm = 0;                  // mean (x - y)^2 / y
  double rmse_mm = 0;                    // root mean (x - y)^2
  double rmse_log = 0;                   // root mean log(x / y)^2
  std::array<double, 3> below = {};      // share with max(x / y, y / x) < 1.25, 1.25^2, 1.25^3
  std::array<double, 3> within_mm = {};  // share with |x - y| < 1, 2, 5 mm
};
inline constexpr std::array kDepthBoundsMm = {1.0, 2.0, 5.0};

// Of a mesh's vertices; means over the frames that have such ones.
struct VertexFigures {
  DepthFigures depth;
  std::optional<std::array<double, 2>> within_sigma;  // shares within 1, 2 of their own; nothing: none has any
};

// Of the pixels where a depth can be expected (ComputeDenseCompleteness).
struct DenseCompleteness {
  double share = 0;        // such pixels, of those with a true depth
  double known_share = 0;  // of such pixels, that have a depth
};

struct DenseError {
  ErrorScale scale = ErrorScale::kPerFrame;  // of the depths
  int frames = 0;                            // that have pixels with both depths
  int frames_without_depth = 0;  // that have a true depth, and no other: known_share and complete_mm count them
  double known_share = 0;        // of the pixels with a true depth
  std::array<double, 3> complete_mm = {};  // share of these that are known to 1, 2, 5 mm
  DepthFigures estimate;
  DepthFigures certain_half;                    // of the pixels with the smaller sigmas
  std::optional<DepthFigures> interpolation;    // a thin plate through the run's points, at the pixels of `estimate`;
                                                // nothing: too few points
  DepthFigures null;                            // one constant depth there
  std::optional<DepthFigures> filled;           // of the pixels that were filled from the rim of a hole, which are none
                                                // of the others; over the frames that have such ones; nothing: none has
  double filled_share = 0;                      // of the pixels with a true depth; 0: holes were not filled
  std::optional<VertexFigures> mesh;            // where the frame has a depth of its own too; nothing: no frame has any
  std::optional<VertexFigures> mesh_alone;      // where it has none: also of tissue that is hidden here; likewise
  double mesh_vertices = 0;                     // mean over the frames; 0: there is no mesh
  std::optional<double> mesh_alone_share = {};  // of the vertices; nothing: there is no mesh
  double within_1_sigma = 0;                    // shares of the pixels of `estimate`
  double within_2_sigma = 0;
  std::optional<DenseCompleteness> textured;  // nothing: it is not known what other images see
};

// `scale`: of each frame the median of y / x, one a submap (the median of these), or none. `run` is the one that
// the surface was made of. Fails with kMismatch where the surface's images are not the sequence's, kInsufficient where
// no frame has both depths, and as Sequence and ReadSurfaceDepth.
Result<DenseError> ComputeDenseError(const SurfaceFolder& surface, const EvaluationInput& run, const Sequence& sequence,
                                     ErrorScale scale);

}  // namespace pliant
