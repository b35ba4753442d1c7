// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The true depth of the surface at pixels, from what a sequence has: its depth images, or its pairs of images, whose
// disparity is measured to a part of a pixel at every pixel asked for, with its own uncertainty (whole pixels would
// cost 0.2 to 0.7 mm at 55 to 100 mm with an endoscope's baseline).
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pliant/base/options.h"
#include "pliant/base/status.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/datasets/sequence.h"
#include "pliant/evaluation/run_input.h"
#include "pliant/image/depth_lookup.h"

namespace pliant {

enum class SurfaceSource {
  kAny,    // depth images where the sequence has them, else its pairs
  kDepth,  // depth images
  kPairs,  // pairs of images
};
template <>
struct EnumNames<SurfaceSource> {
  static constexpr std::array kNames = {std::pair{SurfaceSource::kAny, std::string_view("any")},
                                        std::pair{SurfaceSource::kDepth, std::string_view("depth")},
                                        std::pair{SurfaceSource::kPairs, std::string_view("pairs")}};
};

class SurfaceTruth {
 public:
  virtual ~SurfaceTruth() = default;

  // One answer a pixel; nothing where the frame has no truth at all. To be asked in ascending order of frames. Fails as
  // Sequence does.
  virtual Result<std::optional<std::vector<DepthAtPixel>>> At(int frame_idx,
                                                              std::span<const Eigen::Vector2d> pixels) = 0;
  // Whether it is measured as a start from a pair measures its map, so that of the frame of such a start it says
  // nothing.
  virtual bool IsOfPairs() const = 0;
};

// From the depth images: interpolated, never across a relative step of more than max_depth_step. `sequence` must
// outlive it.
std::unique_ptr<SurfaceTruth> SurfaceTruthFromDepthImages(const Sequence& sequence, double max_depth_step);

// From the pairs of a sequence at its beginning, opened for this alone. A pixel without a certain match has no depth.
// The standard deviation of a disparity is that of the rows of the frame's matches, which ought to agree, and what the
// match followed back is off, together (docs/method.md, eq. B6).
std::unique_ptr<SurfaceTruth> PairTruth(std::unique_ptr<Sequence> sequence, int threads);

// The source by name, for a run on `sequence`, which was opened by `request` and must outlive it. kAny takes depth
// images where the sequence has any for the run's frames, else pairs where they are rectified. Fails with kMismatch
// where kPairs are none (CheckPairs), and as OpenSequence.
Result<std::unique_ptr<SurfaceTruth>> OpenSurfaceTruth(SurfaceSource source, const EvaluationInput& run,
                                                       const Sequence& sequence, const SequenceRequest& request,
                                                       double max_depth_step);

}  // namespace pliant
