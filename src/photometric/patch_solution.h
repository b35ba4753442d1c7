// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The least-squares solution of a patch's linear model, and which of its pixels count.
#pragma once

#include "photometric/patch_kernels.h"
#include "pliant/photometric/patch.h"

namespace pliant {

// Largest block: kMaxPatchSize rows.
inline constexpr int kMaxBlock = kMaxPatchSize * PatchRowStride(kMaxPatchSize);

// Share of a patch that must be usable on a coarse level, which only has to come near.
inline constexpr double kMinCoarseSupport = 0.3;

inline PatchShape ShapeOf(int size) { return {size, PatchRowStride(size)}; }
inline int BlockOf(PatchShape shape) { return shape.size * shape.row_stride; }

// Writes the solution (3 blocks and offsets for a translation, 7 for affine motion). `values` and `weights` (null: all
// ones) as in PatchLevel. Shading is a matter of the finest level: on a coarse one a plane leaves too little of the
// patch to be found by. kLowTexture if the patch does not determine its position.
PatchFailure SolvePatch(const float* values, const float* weights, BasisKind kind, int level, PatchShape shape,
                        const LucasKanadeOptions& options, float* solve, float* offsets);

struct ImageSize {
  int width = 0;
  int height = 0;
};

// Share of the patch around (x, y), pixels of level 0, that lies inside the image and on usable pixels; radius_px of
// level 0.
struct Support {
  double inside = 0;
  double usable = 0;
};
Support SupportAt(const SupportMask& mask, ImageSize size, double x, double y, int radius_px);

// weights[v] = 1 where the pixel of level 0 under patch pixel v is usable and inside, else 0, times `reference` where
// not null. (x, y): the patch's center on level 0; A: {xx, xy, yx, yy} from patch pixels to pixels of level 0.
void FillWeights(const SupportMask& mask, ImageSize size, double x, double y, const Affine2& affine, PatchShape shape,
                 const float* reference, float* weights);

}  // namespace pliant
