// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "photometric/patch_solution.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pliant {
namespace {

constexpr int kMaxBlocks = 10;

// Inverse of a symmetric positive definite n x n matrix in place (Gauss-Jordan); false if it is not.
bool Invert(int n, double* m) {
  for (int k = 0; k < n; ++k) {
    const double pivot = m[k * n + k];
    if (!(pivot > 1e-9)) return false;
    m[k * n + k] = 1;
    for (int j = 0; j < n; ++j) m[k * n + j] /= pivot;
    for (int i = 0; i < n; ++i) {
      if (i == k) continue;
      const double factor = m[i * n + k];
      m[i * n + k] = 0;
      for (int j = 0; j < n; ++j) m[i * n + j] -= factor * m[k * n + j];
    }
  }
  return true;
}

// Larger eigenvalue of the covariance of the position (the upper left 2 x 2 of the inverse): its inverse is the
// texture that is left to determine the position when everything else is free (docs/method.md, eq. P4).
double LargestVariance(const double* inverse, int n) {
  const double mean = 0.5 * (inverse[0] + inverse[n + 1]);
  const double half_difference = 0.5 * (inverse[0] - inverse[n + 1]);
  return mean + std::hypot(half_difference, inverse[1]);
}

}  // namespace

PatchFailure SolvePatch(const float* values, const float* weights, BasisKind kind, int level, PatchShape shape,
                        const LucasKanadeOptions& options, float* solve, float* offsets) {
  const int motion = kind == BasisKind::kAffine ? 6 : 2;
  const bool plane = level == 0 && options.shading == Shading::kPlane;
  const int blocks = motion + (plane ? 4 : 2);  // and gain, bias, the two gradients of the shading
  const int used = options.gain_bias == Switch::kOff ? motion : blocks;
  alignas(64) std::array<float, static_cast<std::size_t>(kMaxBlocks) * kMaxBlock> basis;
  std::array<float, kMaxBlocks * kMaxBlocks> gram;
  const float* center = values + shape.row_stride + 1;
  const float gray = center[shape.half() * shape.row_stride + shape.half()];
  FillPatchBasis(values, weights, gray, kind, shape, basis.data());
  PatchGramMatrix(basis.data(), blocks, shape, gram.data());

  std::array<double, kMaxBlocks * kMaxBlocks> inverse;
  for (int i = 0; i < used; ++i)
    for (int j = 0; j < used; ++j)
      inverse[static_cast<std::size_t>(i * used + j)] = gram[static_cast<std::size_t>(i * blocks + j)];
  const double count = gram[static_cast<std::size_t>((motion + 1) * (blocks + 1))];
  if (!Invert(used, inverse.data())) return PatchFailure::kLowTexture;
  if (LargestVariance(inverse.data(), used) * options.min_texture * options.min_texture * count > 1)
    return PatchFailure::kLowTexture;

  const int rows = motion + 1;
  std::array<float, kMaxBlocks * kMaxBlocks> coefficients{};
  for (int i = 0; i < std::min(rows, used); ++i)
    for (int j = 0; j < used; ++j)
      coefficients[static_cast<std::size_t>(i * blocks + j)] =
          static_cast<float>(inverse[static_cast<std::size_t>(i * used + j)]);
  CombineBlocks(basis.data(), blocks, coefficients.data(), rows, shape, solve);
  std::fill(offsets, offsets + rows, 0.0F);
  if (options.gain_bias == Switch::kOff) {
    // Only the difference to the patch moves it, and the gain is 1.
    SolveOnValues(center, solve, motion, shape, offsets);
    offsets[motion] = -1;
  }
  return PatchFailure::kNone;
}

Support SupportAt(const SupportMask& mask, ImageSize size, double x, double y, int radius_px) {
  const int cx = static_cast<int>(std::lround(x));
  const int cy = static_cast<int>(std::lround(y));
  const int cols = std::min(cx + radius_px, size.width - 1) - std::max(cx - radius_px, 0) + 1;
  const int rows = std::min(cy + radius_px, size.height - 1) - std::max(cy - radius_px, 0) + 1;
  const double side = 2 * radius_px + 1;
  const double inside = std::max(cols, 0) * static_cast<double>(std::max(rows, 0)) / (side * side);
  return {inside, mask.unrestricted() ? inside : mask.Fraction(cx, cy, radius_px)};
}

void FillWeights(const SupportMask& mask, ImageSize size, double x, double y, const Affine2& affine, PatchShape shape,
                 const float* reference, float* weights) {
  const int half = shape.half();
  const cv::Mat& valid = mask.valid();
  const auto round = [](double value) { return static_cast<int>(std::floor(value + 0.5)); };
  if (affine.xy == 0 && affine.yx == 0) {  // rows stay rows: every column is looked up once
    std::array<int, static_cast<std::size_t>(PatchRowStride(kMaxPatchSize))> columns;
    for (int col = 0; col < shape.size; ++col) {
      const int px = round(x + affine.xx * (col - half));
      columns[static_cast<std::size_t>(col)] = px >= 0 && px < size.width ? px : -1;
    }
    std::fill(weights, weights + BlockOf(shape), 0.0F);
    for (int row = 0; row < shape.size; ++row) {
      const int py = round(y + affine.yy * (row - half));
      if (py < 0 || py >= size.height) continue;
      const std::uint8_t* usable = valid.empty() ? nullptr : valid.ptr<std::uint8_t>(py);
      for (int col = 0; col < shape.size; ++col) {
        const int i = row * shape.row_stride + col;
        const int px = columns[static_cast<std::size_t>(col)];
        if (px >= 0 && (usable == nullptr || usable[px] != 0)) weights[i] = reference == nullptr ? 1.0F : reference[i];
      }
    }
    return;
  }
  for (int row = 0; row < shape.size; ++row) {
    const double v = row - half;
    const double row_x = x + affine.xy * v;
    const double row_y = y + affine.yy * v;
    for (int col = 0; col < shape.row_stride; ++col) {
      const int i = row * shape.row_stride + col;
      const double u = col - half;
      const int px = round(row_x + affine.xx * u);
      const int py = round(row_y + affine.yx * u);
      const bool inside = col < shape.size && px >= 0 && py >= 0 && px < size.width && py < size.height;
      const bool usable = inside && (valid.empty() || valid.ptr<std::uint8_t>(py)[px] != 0);
      weights[i] = usable ? (reference == nullptr ? 1.0F : reference[i]) : 0.0F;
    }
  }
}

}  // namespace pliant
