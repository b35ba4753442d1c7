// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/photometric/ssim.h"

#include <vector>

#include <gtest/gtest.h>

#include "photometric/synthetic_texture.h"
#include "pliant/photometric/lucas_kanade.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

constexpr double kTwiceAsBright = 0.7;     // twice the mean and contrast: 0.8 * 0.8 of one
constexpr double kSinglePrecision = 1e-4;  // the tracker sums in single precision

// SSIM as in the article, from two lists of gray levels.
double DirectSsim(const std::vector<double>& x, const std::vector<double>& y) {
  const double n = static_cast<double>(x.size());
  double mx = 0, my = 0, vx = 0, vy = 0, c = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mx += x[i] / n;
    my += y[i] / n;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    vx += (x[i] - mx) * (x[i] - mx) / n;
    vy += (y[i] - my) * (y[i] - my) / n;
    c += (x[i] - mx) * (y[i] - my) / n;
  }
  const double c1 = 0.01 * 255 * 0.01 * 255;
  const double c2 = 0.03 * 255 * 0.03 * 255;
  return (2 * mx * my + c1) / (mx * mx + my * my + c1) * (2 * c + c2) / (vx + vy + c2);
}

TEST(Ssim, OfATrackIsTheDirectComputationOnThePatchFound) {
  const SyntheticTexture texture(21);
  const cv::Size size(120, 120);
  const cv::Mat first = texture.Render(size, [](cv::Point2d p) { return p; });
  const cv::Mat second = texture.Render(
      size, [](cv::Point2d p) { return p - cv::Point2d(0.6, 0.2); }, 0.8, 10, 4, 5);
  const Pixel at{60, 60};
  for (const SimilarityMode mode : {SimilarityMode::kPlain, SimilarityMode::kCompensated}) {
    LucasKanadeOptions options;
    options.similarity = mode;
    options.patch_size = 21;
    ReferencePatch patch;
    CutReferencePatch(ImagePyramid(first, 4), {}, at, options, AffineSolution::kWithout, &patch);
    const PatchMatch match = TrackPatch(patch, ImagePyramid(second, 4), {}, at, options);
    ASSERT_EQ(match.failure, PatchFailure::kNone);
    std::vector<double> x, y;
    for (int v = -10; v <= 10; ++v) {
      for (int u = -10; u <= 10; ++u) {
        x.push_back(first.at<std::uint8_t>(60 + v, 60 + u));
        const double value = *SampleBilinear(second, match.pixel.x + u, match.pixel.y + v);
        y.push_back(mode == SimilarityMode::kPlain ? value : match.gain * value + match.bias);
      }
    }
    EXPECT_NEAR(match.ssim, DirectSsim(x, y), kSinglePrecision);
  }
}

TEST(Ssim, IsOneForEqualPatchesAndFallsWithBrightnessOnlyWhenPlain) {
  const PatchMoments same{100, 100, 400, 400, 400};
  EXPECT_DOUBLE_EQ(Ssim(same), 1);
  const PatchMoments twice{100, 200, 400, 1600, 800};  // y = 2 x
  EXPECT_LT(Ssim(twice), kTwiceAsBright);
  EXPECT_NEAR(Ssim(Compensated(twice, 0.5, 0)), 1, kRoundOff);
}

}  // namespace
}  // namespace pliant
