// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/photometric/patch.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "photometric/patch_solution.h"

namespace pliant {
namespace {

PatchFailure CutLevel(const ImagePyramid& pyramid, const SupportMask& mask, Pixel center, int level,
                      const LucasKanadeOptions& options, PatchShape shape, PatchLevel* out) {
  const double scale = 1 << level;
  const ImageSize size{pyramid.width(), pyramid.height()};
  const int half = shape.half();
  const Support support = SupportAt(mask, size, center.x, center.y, static_cast<int>(scale) * (half + 1) - 1);
  const double wanted = level == 0 ? options.min_valid_support : kMinCoarseSupport;
  if (support.inside < wanted) return PatchFailure::kOutOfImage;
  if (support.usable < wanted) return PatchFailure::kMasked;

  out->values.resize(static_cast<std::size_t>((shape.size + 3) * shape.row_stride));
  SampleGrid({pyramid.origin(level), pyramid.stride(level)}, center.x / scale - half - 1, center.y / scale - half - 1,
             shape.size + 2, shape, out->values.data());
  out->support = static_cast<float>(support.usable);
  out->weights.clear();
  if (support.usable < 1) {
    out->weights.resize(static_cast<std::size_t>(BlockOf(shape)));
    FillWeights(mask, size, center.x, center.y, {scale, 0, 0, scale}, shape, nullptr, out->weights.data());
  }
  out->solve.resize(static_cast<std::size_t>(3 * BlockOf(shape)));
  return SolvePatch(out->values.data(), out->weights.empty() ? nullptr : out->weights.data(), BasisKind::kTranslation,
                    level, shape, options, out->solve.data(), out->offsets.data());
}

}  // namespace

ReferencePatch ReferencePatch::TakeForAlignment() {
  ReferencePatch part{.center = center,
                      .size = size,
                      .levels = {},
                      .solve_affine = std::exchange(solve_affine, {}),
                      .offsets_affine = offsets_affine};
  if (!empty()) part.levels.assign(1, levels.front());
  return part;
}

PatchFailure CutReferencePatch(const ImagePyramid& pyramid, const SupportMask& mask, Pixel center,
                               const LucasKanadeOptions& options, AffineSolution affine, ReferencePatch* patch) {
  assert(!pyramid.empty());
  patch->center = center;
  patch->size = std::min(options.patch_size | 1, kMaxPatchSize);
  patch->levels.resize(static_cast<std::size_t>(std::min(options.levels, pyramid.levels())));
  patch->solve_affine.clear();
  const PatchShape shape = ShapeOf(patch->size);
  const bool inside =
      center.x >= 0 && center.y >= 0 && center.x <= pyramid.width() - 1 && center.y <= pyramid.height() - 1;
  for (int level = 0; level < static_cast<int>(patch->levels.size()); ++level) {
    PatchLevel& out = patch->levels[static_cast<std::size_t>(level)];
    out.failure = inside ? CutLevel(pyramid, mask, center, level, options, shape, &out) : PatchFailure::kOutOfImage;
    if (patch->failure() != PatchFailure::kNone) return patch->failure();
  }
  if (affine == AffineSolution::kWith) {
    const PatchLevel& finest = patch->levels.front();
    patch->solve_affine.resize(static_cast<std::size_t>(7 * BlockOf(shape)));
    const PatchFailure failure =
        SolvePatch(finest.values.data(), finest.weights.empty() ? nullptr : finest.weights.data(), BasisKind::kAffine,
                   0, shape, options, patch->solve_affine.data(), patch->offsets_affine.data());
    // Six parameters need more texture than two: without it the patch still aligns by translation.
    if (failure != PatchFailure::kNone) patch->solve_affine.clear();
  }
  return PatchFailure::kNone;
}

}  // namespace pliant
