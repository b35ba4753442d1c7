// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// This file is compiled once for every instruction set, from within itself.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "photometric/patch_kernels.cc"
#include "photometric/patch_kernels.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <hwy/foreach_target.h>  // must precede highway.h
#include <hwy/highway.h>

#ifndef PLIANT_PATCH_KERNELS_ONCE
#define PLIANT_PATCH_KERNELS_ONCE
static_assert(std::endian::native == std::endian::little, "two neighbors are read as one word, the left one lowest");
#endif

HWY_BEFORE_NAMESPACE();
namespace pliant {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Eight lanes at most: rows are padded to multiples of eight.
using F = hn::CappedTag<float, 8>;
using I = hn::Rebind<std::int32_t, F>;
using U8 = hn::Rebind<std::uint8_t, F>;
using Vf = hn::Vec<F>;

HWY_INLINE Vf LoadPixels(const std::uint8_t* p) { return hn::ConvertTo(F(), hn::PromoteTo(I(), hn::LoadU(U8(), p))); }

HWY_INLINE Vf LoadBetween(const std::uint8_t* p, Vf fraction) {
  const Vf left = LoadPixels(p);
  return hn::MulAdd(fraction, hn::Sub(LoadPixels(p + 1), left), left);
}

HWY_INLINE float SumOfLanes(Vf v) { return hn::GetLane(hn::SumOfLanes(F(), v)); }

HWY_INLINE const std::uint8_t* Address(const ImageView& image, double x, double y) {
  return image.origin + static_cast<std::ptrdiff_t>(y) * image.stride + static_cast<std::ptrdiff_t>(x);
}

void SampleGrid(ImageView image, double x, double y, int rows, PatchShape shape, float* out) {
  const double x0 = std::floor(x);
  const double y0 = std::floor(y);
  const std::uint8_t* top = Address(image, x0, y0);
  const Vf fx = hn::Set(F(), static_cast<float>(x - x0));
  const Vf fy = hn::Set(F(), static_cast<float>(y - y0));
  const int lanes = static_cast<int>(hn::Lanes(F()));
  for (int col = 0; col < shape.row_stride; col += lanes) {
    const std::uint8_t* p = top + col;
    Vf above = LoadBetween(p, fx);
    for (int row = 0; row < rows; ++row) {
      p += image.stride;
      const Vf below = LoadBetween(p, fx);
      hn::StoreU(hn::MulAdd(fy, hn::Sub(below, above), above), F(), out + row * shape.row_stride + col);
      above = below;
    }
  }
}

void SampleAffineGrid(ImageView image, double x, double y, const float* affine, PatchShape shape, float* out) {
  // Offsets from an anchor near the patch keep the fractions of single precision.
  const double x_anchor = std::floor(x);
  const double y_anchor = std::floor(y);
  const auto* base = reinterpret_cast<const std::int32_t*>(Address(image, x_anchor, y_anchor));
  const auto x_start = static_cast<float>(x - x_anchor);
  const auto y_start = static_cast<float>(y - y_anchor);
  const auto stride = hn::Set(I(), static_cast<std::int32_t>(image.stride));
  const auto low_byte = hn::Set(I(), 0xFF);
  const int lanes = static_cast<int>(hn::Lanes(F()));
  for (int row = 0; row < shape.size; ++row) {
    const Vf row_x = hn::Set(F(), x_start + affine[1] * static_cast<float>(row));
    const Vf row_y = hn::Set(F(), y_start + affine[3] * static_cast<float>(row));
    for (int col = 0; col < shape.row_stride; col += lanes) {
      const Vf u = hn::Iota(F(), static_cast<float>(col));
      const Vf px = hn::MulAdd(hn::Set(F(), affine[0]), u, row_x);
      const Vf py = hn::MulAdd(hn::Set(F(), affine[2]), u, row_y);
      const Vf px0 = hn::Floor(px);
      const Vf py0 = hn::Floor(py);
      const Vf fx = hn::Sub(px, px0);
      const Vf fy = hn::Sub(py, py0);
      const auto offset = hn::Add(hn::Mul(hn::ConvertTo(I(), py0), stride), hn::ConvertTo(I(), px0));
      const auto above = hn::GatherOffset(I(), base, offset);
      const auto below = hn::GatherOffset(I(), base, hn::Add(offset, stride));
      const Vf a0 = hn::ConvertTo(F(), hn::And(above, low_byte));
      const Vf a1 = hn::ConvertTo(F(), hn::And(hn::ShiftRight<8>(above), low_byte));
      const Vf b0 = hn::ConvertTo(F(), hn::And(below, low_byte));
      const Vf b1 = hn::ConvertTo(F(), hn::And(hn::ShiftRight<8>(below), low_byte));
      const Vf a = hn::MulAdd(fx, hn::Sub(a1, a0), a0);
      const Vf b = hn::MulAdd(fx, hn::Sub(b1, b0), b0);
      hn::StoreU(hn::MulAdd(fy, hn::Sub(b, a), a), F(), out + row * shape.row_stride + col);
    }
  }
}

void SolveOnGrid(ImageView image, double x, double y, const float* solve, PatchShape shape, float* sums) {
  const double x0 = std::floor(x);
  const double y0 = std::floor(y);
  const std::uint8_t* top = Address(image, x0, y0);
  const Vf fx = hn::Set(F(), static_cast<float>(x - x0));
  const Vf fy = hn::Set(F(), static_cast<float>(y - y0));
  const int lanes = static_cast<int>(hn::Lanes(F()));
  const int block = shape.size * shape.row_stride;
  Vf sum0 = hn::Zero(F());
  Vf sum1 = sum0;
  Vf sum2 = sum0;
  for (int col = 0; col < shape.size; col += lanes) {
    const std::uint8_t* p = top + col;
    const float* k = solve + col;
    Vf above = LoadBetween(p, fx);
    for (int row = 0; row < shape.size; ++row) {
      p += image.stride;
      const Vf below = LoadBetween(p, fx);
      const Vf value = hn::MulAdd(fy, hn::Sub(below, above), above);
      sum0 = hn::MulAdd(value, hn::LoadU(F(), k), sum0);
      sum1 = hn::MulAdd(value, hn::LoadU(F(), k + block), sum1);
      sum2 = hn::MulAdd(value, hn::LoadU(F(), k + 2 * block), sum2);
      k += shape.row_stride;
      above = below;
    }
  }
  sums[0] = SumOfLanes(sum0);
  sums[1] = SumOfLanes(sum1);
  sums[2] = SumOfLanes(sum2);
}

HWY_INLINE float Dot(const float* a, const float* b, int count) {
  const int lanes = static_cast<int>(hn::Lanes(F()));
  Vf even = hn::Zero(F());
  Vf odd = even;
  int i = 0;
  for (; i + 2 * lanes <= count; i += 2 * lanes) {
    even = hn::MulAdd(hn::LoadU(F(), a + i), hn::LoadU(F(), b + i), even);
    odd = hn::MulAdd(hn::LoadU(F(), a + i + lanes), hn::LoadU(F(), b + i + lanes), odd);
  }
  for (; i < count; i += lanes) even = hn::MulAdd(hn::LoadU(F(), a + i), hn::LoadU(F(), b + i), even);
  return SumOfLanes(hn::Add(even, odd));
}

void SolveOnValues(const float* values, const float* solve, int blocks, PatchShape shape, float* sums) {
  const int block = shape.size * shape.row_stride;
  for (int k = 0; k < blocks; ++k) sums[k] = Dot(values, solve + k * block, block);
}

MomentSums SumMoments(const float* x, const float* y, const float* weights, float origin, PatchShape shape) {
  const int lanes = static_cast<int>(hn::Lanes(F()));
  const Vf zero = hn::Zero(F());
  const Vf shift = hn::Set(F(), origin);
  const Vf one = hn::Set(F(), 1.0F);
  Vf sw = zero, sx = zero, sy = zero, sxx = zero, syy = zero, sxy = zero;
  for (int row = 0; row < shape.size; ++row) {
    for (int col = 0; col < shape.size; col += lanes) {
      const int i = row * shape.row_stride + col;
      const Vf inside = hn::IfThenElseZero(
          hn::Lt(hn::Iota(F(), static_cast<float>(col)), hn::Set(F(), static_cast<float>(shape.size))), one);
      const Vf w = weights == nullptr ? inside : hn::Mul(inside, hn::LoadU(F(), weights + i));
      const Vf a = hn::Sub(hn::LoadU(F(), x + i), shift);
      const Vf b = hn::Sub(hn::LoadU(F(), y + i), shift);
      const Vf wa = hn::Mul(w, a);
      const Vf wb = hn::Mul(w, b);
      sw = hn::Add(sw, w);
      sx = hn::Add(sx, wa);
      sy = hn::Add(sy, wb);
      sxx = hn::MulAdd(wa, a, sxx);
      syy = hn::MulAdd(wb, b, syy);
      sxy = hn::MulAdd(wa, b, sxy);
    }
  }
  return {SumOfLanes(sw), SumOfLanes(sx), SumOfLanes(sy), SumOfLanes(sxx), SumOfLanes(syy), SumOfLanes(sxy)};
}

void FillPatchBasis(const float* values, const float* weights, float mean, BasisKind kind, PatchShape shape,
                    float* basis) {
  const int lanes = static_cast<int>(hn::Lanes(F()));
  const int block = shape.size * shape.row_stride;
  const float half = 0.5F * static_cast<float>(shape.size - 1);
  const Vf one_half = hn::Set(F(), 0.5F);
  const Vf one = hn::Set(F(), 1.0F);
  for (int row = 0; row < shape.size; ++row) {
    const float v_row = (static_cast<float>(row) - half) / half;
    for (int col = 0; col < shape.row_stride; col += lanes) {
      const Vf column = hn::Iota(F(), static_cast<float>(col));
      const auto inside = hn::Lt(column, hn::Set(F(), static_cast<float>(shape.size)));
      const int i = row * shape.row_stride + col;
      const Vf weight = weights == nullptr ? one : hn::LoadU(F(), weights + i);
      const Vf w = hn::IfThenElseZero(inside, weight);
      // Beyond the last column these read into the next row, and into the spare row at the end.
      const float* center = values + (row + 1) * shape.row_stride + col + 1;
      const Vf gx = hn::Mul(hn::Mul(one_half, w), hn::Sub(hn::LoadU(F(), center + 1), hn::LoadU(F(), center - 1)));
      const Vf gy = hn::Mul(hn::Mul(one_half, w), hn::Sub(hn::LoadU(F(), center + shape.row_stride),
                                                          hn::LoadU(F(), center - shape.row_stride)));
      float* out = basis + i;
      const auto store = [&](Vf value) {
        hn::StoreU(value, F(), out);
        out += block;
      };
      store(gx);
      store(gy);
      const Vf u = hn::Mul(hn::Sub(column, hn::Set(F(), half)), hn::Set(F(), 1.0F / half));
      const Vf v = hn::Set(F(), v_row);
      if (kind == BasisKind::kAffine) {
        store(hn::Mul(u, gx));
        store(hn::Mul(v, gx));
        store(hn::Mul(u, gy));
        store(hn::Mul(v, gy));
      }
      store(hn::Mul(w, hn::Sub(hn::LoadU(F(), center), hn::Set(F(), mean))));
      store(w);
      store(hn::Mul(w, u));
      store(hn::Mul(w, v));
    }
  }
}

void PatchGramMatrix(const float* basis, int blocks, PatchShape shape, float* gram) {
  const int block = shape.size * shape.row_stride;
  for (int i = 0; i < blocks; ++i)
    for (int j = i; j < blocks; ++j)
      gram[i * blocks + j] = gram[j * blocks + i] = Dot(basis + i * block, basis + j * block, block);
}

// The number of blocks is known to the compiler, so that all coefficients stay in registers.
template <int kBlocks>
HWY_INLINE void CombineRow(const float* basis, const float* coefficients, int block, float* out) {
  const int lanes = static_cast<int>(hn::Lanes(F()));
  for (int i = 0; i < block; i += lanes) {
    Vf sum = hn::Zero(F());
    for (int j = 0; j < kBlocks; ++j)
      sum = hn::MulAdd(hn::Set(F(), coefficients[j]), hn::LoadU(F(), basis + j * block + i), sum);
    hn::StoreU(sum, F(), out + i);
  }
}

void CombineBlocks(const float* basis, int blocks, const float* coefficients, int rows, PatchShape shape, float* out) {
  const int block = shape.size * shape.row_stride;
  for (int r = 0; r < rows; ++r) {
    float row[10] = {};  // a copy that `out` cannot overlap
    std::copy(coefficients + r * blocks, coefficients + (r + 1) * blocks, row);
    float* target = out + r * block;
    if (blocks <= 4) {
      blocks == 4 ? CombineRow<4>(basis, row, block, target) : CombineRow<2>(basis, row, block, target);
    } else if (blocks <= 6) {
      CombineRow<6>(basis, row, block, target);
    } else {
      blocks == 8 ? CombineRow<8>(basis, row, block, target) : CombineRow<10>(basis, row, block, target);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace pliant
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pliant {

HWY_EXPORT(SampleGrid);
HWY_EXPORT(SampleAffineGrid);
HWY_EXPORT(SolveOnGrid);
HWY_EXPORT(SolveOnValues);
HWY_EXPORT(SumMoments);
HWY_EXPORT(FillPatchBasis);
HWY_EXPORT(PatchGramMatrix);
HWY_EXPORT(CombineBlocks);

void SampleGrid(ImageView image, double x, double y, int rows, PatchShape shape, float* out) {
  HWY_DYNAMIC_DISPATCH(SampleGrid)(image, x, y, rows, shape, out);
}
void SampleAffineGrid(ImageView image, double x, double y, const float* affine, PatchShape shape, float* out) {
  HWY_DYNAMIC_DISPATCH(SampleAffineGrid)(image, x, y, affine, shape, out);
}
void SolveOnGrid(ImageView image, double x, double y, const float* solve, PatchShape shape, float* sums) {
  HWY_DYNAMIC_DISPATCH(SolveOnGrid)(image, x, y, solve, shape, sums);
}
void SolveOnValues(const float* values, const float* solve, int blocks, PatchShape shape, float* sums) {
  HWY_DYNAMIC_DISPATCH(SolveOnValues)(values, solve, blocks, shape, sums);
}
MomentSums SumMoments(const float* x, const float* y, const float* weights, float origin, PatchShape shape) {
  return HWY_DYNAMIC_DISPATCH(SumMoments)(x, y, weights, origin, shape);
}
void FillPatchBasis(const float* values, const float* weights, float mean, BasisKind kind, PatchShape shape,
                    float* basis) {
  HWY_DYNAMIC_DISPATCH(FillPatchBasis)(values, weights, mean, kind, shape, basis);
}
void PatchGramMatrix(const float* basis, int blocks, PatchShape shape, float* gram) {
  HWY_DYNAMIC_DISPATCH(PatchGramMatrix)(basis, blocks, shape, gram);
}
void CombineBlocks(const float* basis, int blocks, const float* coefficients, int rows, PatchShape shape, float* out) {
  HWY_DYNAMIC_DISPATCH(CombineBlocks)(basis, blocks, coefficients, rows, shape, out);
}

}  // namespace pliant
#endif
