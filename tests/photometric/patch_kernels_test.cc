// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Every instruction set of this machine against plain code.
#include "photometric/patch_kernels.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "photometric/synthetic_texture.h"
#include "pliant/photometric/patch.h"

namespace pliant {
namespace {

constexpr double kValue = 2e-3;     // gray levels: single precision of positions and values
constexpr double kRelative = 1e-5;  // of sums of some hundred products in another order
constexpr PatchShape kShape{21, PatchRowStride(21)};
constexpr int kBlock = kShape.size * kShape.row_stride;

const ImagePyramid& Pyramid() {
  static const ImagePyramid pyramid(SyntheticTexture(31).Render({100, 90}, [](cv::Point2d p) { return p; }), 1);
  return pyramid;
}
ImageView View() { return {Pyramid().origin(0), Pyramid().stride(0)}; }
double Plain(double x, double y) { return *SampleBilinear(Pyramid().Level(0), x, y); }

template <class Body>
void ForEveryTarget(const Body& body) {
  const auto supported = hwy::SupportedTargets();
  for (auto rest = supported; rest != 0; rest &= rest - 1) {
    const auto target = rest & ~(rest - 1);
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    body();
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

std::vector<float> Pattern(int blocks, std::uint64_t seed) {
  Random random(seed);
  std::vector<float> out(static_cast<std::size_t>(blocks * kBlock), 0.0F);
  for (int b = 0; b < blocks; ++b)
    for (int r = 0; r < kShape.size; ++r)
      for (int c = 0; c < kShape.size; ++c)
        out[static_cast<std::size_t>(b * kBlock + r * kShape.row_stride + c)] = static_cast<float>(random.Normal(10));
  return out;
}

TEST(PatchKernels, SampleGridIsBilinear) {
  ForEveryTarget([] {
    std::vector<float> out(kBlock);
    SampleGrid(View(), 30.37, 22.81, kShape.size, kShape, out.data());
    for (int r = 0; r < kShape.size; ++r)
      for (int c = 0; c < kShape.size; ++c)
        EXPECT_NEAR(out[static_cast<std::size_t>(r * kShape.row_stride + c)], Plain(30.37 + c, 22.81 + r), kValue);
  });
}

TEST(PatchKernels, SampleAffineGridIsBilinear) {
  ForEveryTarget([] {
    const float a[4] = {1.1F, -0.2F, 0.3F, 0.9F};
    std::vector<float> out(kBlock);
    SampleAffineGrid(View(), 40.37, 22.81, a, kShape, out.data());
    for (int r = 0; r < kShape.size; ++r)
      for (int c = 0; c < kShape.size; ++c)
        EXPECT_NEAR(out[static_cast<std::size_t>(r * kShape.row_stride + c)],
                    Plain(40.37 + 1.1 * c - 0.2 * r, 22.81 + 0.3 * c + 0.9 * r), kValue);
  });
}

TEST(PatchKernels, SolveOnGridSumsProductsWithTheSample) {
  const std::vector<float> solve = Pattern(3, 1);
  ForEveryTarget([&] {
    float sums[3];
    SolveOnGrid(View(), 30.37, 22.81, solve.data(), kShape, sums);
    for (int k = 0; k < 3; ++k) {
      double expected = 0, size = 0;
      for (int r = 0; r < kShape.size; ++r)
        for (int c = 0; c < kShape.size; ++c) {
          const double term =
              solve[static_cast<std::size_t>(k * kBlock + r * kShape.row_stride + c)] * Plain(30.37 + c, 22.81 + r);
          expected += term;
          size += std::abs(term);
        }
      EXPECT_NEAR(sums[k], expected, kRelative * size);
    }
  });
}

TEST(PatchKernels, MomentsGramAndCombinationMatchPlainCode) {
  const std::vector<float> blocks = Pattern(2, 2);
  ForEveryTarget([&] {
    const float* x = blocks.data();
    const float* y = x + kBlock;
    double xx = 0, xy = 0, sx = 0;
    for (int i = 0; i < kBlock; ++i) {
      xx += x[i] * static_cast<double>(x[i]);
      xy += x[i] * static_cast<double>(y[i]);
      sx += x[i];
    }
    const double scale = kRelative * xx;
    float gram[4];
    PatchGramMatrix(blocks.data(), 2, kShape, gram);
    EXPECT_NEAR(gram[0], xx, scale);
    EXPECT_NEAR(gram[1], xy, scale);
    EXPECT_EQ(gram[1], gram[2]);
    const MomentSums sums = SumMoments(x, y, nullptr, 0, kShape);
    EXPECT_EQ(sums.w, 21 * 21);
    EXPECT_NEAR(sums.x, sx, scale);
    EXPECT_NEAR(sums.xy, xy, scale);
    const float coefficients[2] = {2.0F, -0.5F};
    std::vector<float> out(kBlock);
    CombineBlocks(blocks.data(), 2, coefficients, 1, kShape, out.data());
    for (std::size_t i = 0; i < out.size(); ++i) EXPECT_NEAR(out[i], 2 * x[i] - 0.5 * y[i], kValue);
  });
}

TEST(PatchKernels, FillBasisTakesCentralDifferencesAndLeavesPaddingZero) {
  std::vector<float> values(static_cast<std::size_t>((kShape.size + 3) * kShape.row_stride));
  SampleGrid(View(), 20, 20, kShape.size + 2, kShape, values.data());
  ForEveryTarget([&] {
    std::vector<float> basis(static_cast<std::size_t>(10 * kBlock), 7.0F);
    FillPatchBasis(values.data(), nullptr, 100, BasisKind::kAffine, kShape, basis.data());
    const auto at = [&](int block, int r, int c) {
      return basis[static_cast<std::size_t>(block * kBlock + r * kShape.row_stride + c)];
    };
    for (const auto& [r, c] : {std::pair{0, 0}, {20, 20}, {7, 13}}) {
      const double gx = 0.5 * (Plain(22 + c, 21 + r) - Plain(20 + c, 21 + r));
      const double gy = 0.5 * (Plain(21 + c, 22 + r) - Plain(21 + c, 20 + r));
      EXPECT_NEAR(at(0, r, c), gx, kValue);
      EXPECT_NEAR(at(1, r, c), gy, kValue);
      EXPECT_NEAR(at(3, r, c), gx * (r - 10) / 10, kValue);
      EXPECT_NEAR(at(4, r, c), gy * (c - 10) / 10, kValue);
      EXPECT_NEAR(at(6, r, c), Plain(21 + c, 21 + r) - 100, kValue);
      EXPECT_EQ(at(7, r, c), 1);
      EXPECT_NEAR(at(8, r, c), (c - 10) / 10.0, kValue);
    }
    for (int block = 0; block < 10; ++block)
      for (int r = 0; r < kShape.size; ++r) EXPECT_EQ(at(block, r, kShape.size), 0);
  });
}

}  // namespace
}  // namespace pliant
