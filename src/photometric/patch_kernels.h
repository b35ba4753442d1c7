// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The inner loops over a patch, each compiled for several instruction sets and chosen at run time. Patches are stored
// in blocks: `size` rows of `row_stride` floats (a multiple of 8), of which the first `size` count; what lies beyond is
// zero in every block that multiplies. Image pointers must be readable `row_stride + 1` pixels to the right of a row's
// start and 4 bytes beyond any sampled pixel (the pyramid's padding).
#pragma once

#include <cstddef>
#include <cstdint>

namespace pliant {

struct ImageView {
  const std::uint8_t* origin = nullptr;  // pixel (0, 0)
  std::ptrdiff_t stride = 0;             // bytes
};

struct PatchShape {
  int size = 0;                          // pixels a side
  int row_stride = 0;                    // floats
  int half() const { return size / 2; }  // from the center to the outermost pixel
};

// A block of `rows` x `shape.row_stride` bilinear values; (x, y) is the pixel under the first.
void SampleGrid(ImageView image, double x, double y, int rows, PatchShape shape, float* out);

// As SampleGrid, at (x, y) + A (col, row) with A = {xx, xy, yx, yy}.
void SampleAffineGrid(ImageView image, double x, double y, const float* affine, PatchShape shape, float* out);

// sums[k] = sum over the patch of solve[k * size * row_stride + v] * I(v), with I sampled as in SampleGrid; 3 blocks.
void SolveOnGrid(ImageView image, double x, double y, const float* solve, PatchShape shape, float* sums);

// sums[k] = sum of solve block k times values; `blocks` blocks.
void SolveOnValues(const float* values, const float* solve, int blocks, PatchShape shape, float* sums);

// {sum w, sum w x, sum w y, sum w x x, sum w y y, sum w x y} with x and y taken relative to `origin`; w = 1 where
// `weights` is null.
struct MomentSums {
  float w, x, y, xx, yy, xy;
};
MomentSums SumMoments(const float* x, const float* y, const float* weights, float origin, PatchShape shape);

// The linear model of a patch's look, block by block. From `values` (size + 2 rows: a margin of one pixel all round,
// its first pixel at block position -1, -1): gradients gx, gy by central differences and the values less `mean`.
// Translation: gx, gy, values, 1, u, v, where u and v go from -1 to 1 over the patch. Affine: gx, gy, u gx, v gx, u gy,
// v gy, values, 1, u, v. All times `weights` where not null.
enum class BasisKind { kTranslation, kAffine };
void FillPatchBasis(const float* values, const float* weights, float mean, BasisKind kind, PatchShape shape,
                    float* basis);

// gram[i * blocks + j] = sum of block i times block j.
void PatchGramMatrix(const float* basis, int blocks, PatchShape shape, float* gram);

// out block i = sum over j of coefficients[i * blocks + j] * basis block j, for i < rows; `blocks` is 2, 4, 6, 8
// or 10.
void CombineBlocks(const float* basis, int blocks, const float* coefficients, int rows, PatchShape shape, float* out);

}  // namespace pliant
