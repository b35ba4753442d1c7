// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/photometric/lucas_kanade.h"

#include <gtest/gtest.h>

#include "photometric/synthetic_texture.h"

namespace pliant {
namespace {

constexpr double kSubPixel_px = 0.02;  // 8-bit rounding and bilinear values of waves of 8 px and more
constexpr double kGain = 0.01;
constexpr double kBias = 1.5;          // gray levels: a gain error of 0.01 around a level of 120
constexpr double kSameSurface = 0.99;  // SSIM of a patch and itself, shifted by parts of a pixel
const cv::Size kSize(240, 200);
const Pixel kCenter{120.3, 100.8};

const SyntheticTexture& Texture() {
  static const SyntheticTexture texture(11);
  return texture;
}

ImagePyramid View(cv::Point2d shift, double gain = 1, double bias = 0) {
  return {Texture().Render(
              kSize, [&](cv::Point2d p) { return p - shift; }, gain, bias),
          4};
}

ReferencePatch Cut(const ImagePyramid& pyramid, const LucasKanadeOptions& options = {}, Pixel center = kCenter) {
  ReferencePatch patch;
  CutReferencePatch(pyramid, {}, center, options, AffineSolution::kWith, &patch);
  return patch;
}

TEST(TrackPatch, RecoversSubPixelShifts) {
  const ReferencePatch patch = Cut(View({0, 0}));
  ASSERT_EQ(patch.failure(), PatchFailure::kNone);
  for (const cv::Point2d shift : {cv::Point2d(0, 0), {0.25, -0.4}, {0.5, 0.5}, {-3.7, 2.2}, {7.3, -5.6}}) {
    const PatchMatch match = TrackPatch(patch, View(shift), {}, kCenter, {});
    ASSERT_EQ(match.failure, PatchFailure::kNone) << shift;
    EXPECT_NEAR(match.pixel.x, kCenter.x + shift.x, kSubPixel_px);
    EXPECT_NEAR(match.pixel.y, kCenter.y + shift.y, kSubPixel_px);
    EXPECT_GT(match.ssim, kSameSurface);
  }
}

TEST(TrackPatch, RecoversGainAndBias) {
  const ReferencePatch patch = Cut(View({0, 0}));
  // The image is 0.8 I0 - 12, so that I0 = 1.25 It + 15.
  const PatchMatch match = TrackPatch(patch, View({1.4, -0.9}, 0.8, -12), {}, kCenter, {});
  ASSERT_EQ(match.failure, PatchFailure::kNone);
  EXPECT_NEAR(match.pixel.x, kCenter.x + 1.4, kSubPixel_px);
  EXPECT_NEAR(match.gain, 1.25, kGain);
  EXPECT_NEAR(match.bias, 15, kBias);
}

TEST(TrackPatch, WithoutGainAndBiasABrightnessChangePullsThePatchAside) {
  LucasKanadeOptions off;
  off.gain_bias = Switch::kOff;
  off.min_ssim = -1;
  const ImagePyramid reference = View({0, 0});
  const ReferencePatch patch = Cut(reference, off);
  const PatchMatch same = TrackPatch(patch, View({1.4, -0.9}), {}, kCenter, off);
  EXPECT_EQ(same.failure, PatchFailure::kNone);
  EXPECT_NEAR(same.pixel.x, kCenter.x + 1.4, kSubPixel_px);
  EXPECT_EQ(same.gain, 1);
  const PatchMatch darker = TrackPatch(patch, View({1.4, -0.9}, 0.8, -12), {}, kCenter, off);
  EXPECT_GT(std::hypot(darker.pixel.x - kCenter.x - 1.4, darker.pixel.y - kCenter.y + 0.9), 5 * kSubPixel_px);
}

TEST(TrackPatch, AShadingPlaneIsNotMistakenForMotion) {
  // Brightness rises by 30 gray levels over the patch, as when a light moves past.
  const auto shaded = [](const cv::Mat& image) {
    cv::Mat out = image.clone();
    for (int y = 0; y < image.rows; ++y)
      for (int x = 0; x < image.cols; ++x)
        out.at<std::uint8_t>(y, x) =
            cv::saturate_cast<std::uint8_t>(0.7 * image.at<std::uint8_t>(y, x) + 1.5 * (x - 120));
    return out;
  };
  const ImagePyramid moved(shaded(Texture().Render(kSize, [](cv::Point2d p) { return p - cv::Point2d(0.6, 0.3); })), 4);
  const auto error = [&](Shading shading) {
    LucasKanadeOptions options;
    options.shading = shading;
    const PatchMatch match = TrackPatch(Cut(View({0, 0}), options), moved, {}, kCenter, options);
    return std::hypot(match.pixel.x - kCenter.x - 0.6, match.pixel.y - kCenter.y - 0.3);
  };
  EXPECT_LT(error(Shading::kPlane), kSubPixel_px);
  EXPECT_GT(error(Shading::kNone), 2 * kSubPixel_px);
}

TEST(AlignPatch, RecoversAnAffineChange) {
  const ReferencePatch patch = Cut(View({0, 0}));
  const cv::Matx22d a(1.18, 0.06, -0.09, 0.9);
  const cv::Matx22d inverse = a.inv();
  const cv::Point2d center(kCenter.x, kCenter.y);
  const cv::Point2d shift(0.7, -0.5);
  const ImagePyramid warped(Texture().Render(kSize,
                                             [&](cv::Point2d p) {
                                               const cv::Vec2d d = inverse * cv::Vec2d(p.x - center.x - shift.x,
                                                                                       p.y - center.y - shift.y);
                                               return center + cv::Point2d(d[0], d[1]);
                                             }),
                            4);
  constexpr double kAffine = 0.01;
  const PatchMatch match = AlignPatch(patch, warped, {}, kCenter, {}, AlignmentModel::kAffine, {});
  ASSERT_EQ(match.failure, PatchFailure::kNone);
  EXPECT_NEAR(match.pixel.x, kCenter.x + shift.x, kSubPixel_px);
  EXPECT_NEAR(match.pixel.y, kCenter.y + shift.y, kSubPixel_px);
  EXPECT_NEAR(match.affine.xx, a(0, 0), kAffine);
  EXPECT_NEAR(match.affine.xy, a(0, 1), kAffine);
  EXPECT_NEAR(match.affine.yx, a(1, 0), kAffine);
  EXPECT_NEAR(match.affine.yy, a(1, 1), kAffine);
  const Affine2 known{a(0, 0), a(0, 1), a(1, 0), a(1, 1)};
  const PatchMatch shifted = AlignPatch(patch, warped, {}, kCenter, known, AlignmentModel::kTranslation, {});
  ASSERT_EQ(shifted.failure, PatchFailure::kNone);
  EXPECT_NEAR(shifted.pixel.x, kCenter.x + shift.x, kSubPixel_px);
}

TEST(TrackPatch, MaskedPixelsCarryNoWeight) {
  // A bright spot that does not move covers a part of the patch; masked, it does not matter.
  cv::Mat image = Texture().Render(kSize, [](cv::Point2d p) { return p - cv::Point2d(1.2, 0.4); });
  const cv::Rect spot(122, 102, 12, 12);
  image(spot).setTo(255);
  cv::Mat valid(kSize, CV_8UC1, cv::Scalar(255));
  valid(cv::Rect(spot.x - 3, spot.y - 3, spot.width + 6, spot.height + 6)).setTo(0);
  LucasKanadeOptions options;
  options.patch_size = 21;
  options.levels = 1;  // coarser pixels mix the spot in
  const ReferencePatch patch = Cut(View({0, 0}), options);
  const PatchMatch masked = TrackPatch(patch, ImagePyramid(image, 4), SupportMask(valid), kCenter, options);
  ASSERT_EQ(masked.failure, PatchFailure::kNone);
  EXPECT_NEAR(masked.pixel.x, kCenter.x + 1.2, kSubPixel_px);
  EXPECT_NEAR(masked.pixel.y, kCenter.y + 0.4, kSubPixel_px);
  const PatchMatch covered = TrackPatch(patch, ImagePyramid(image, 4), {}, kCenter, options);
  EXPECT_TRUE(covered.failure != PatchFailure::kNone || std::abs(covered.pixel.x - kCenter.x - 1.2) > kSubPixel_px);
}

PatchFailure FailureOf(const ReferencePatch& patch, const cv::Mat& image, Pixel start,
                       const LucasKanadeOptions& options = {}, const SupportMask& mask = {}) {
  return TrackPatch(patch, ImagePyramid(image, 4), mask, start, options).failure;
}

TEST(TrackPatch, EveryFailureHasItsReason) {
  const ImagePyramid reference = View({0, 0});
  const ReferencePatch patch = Cut(reference);
  const cv::Mat same = reference.Level(0);
  EXPECT_EQ(FailureOf(patch, same, kCenter), PatchFailure::kNone);
  EXPECT_EQ(FailureOf({}, same, kCenter), PatchFailure::kUnknownPoint);
  EXPECT_EQ(FailureOf(patch, same, {-3, 50}), PatchFailure::kOutOfImage);
  EXPECT_EQ(FailureOf(patch, same, kCenter, {}, SupportMask(cv::Mat::zeros(kSize, CV_8UC1))), PatchFailure::kMasked);
  const ReferencePatch flat = Cut(ImagePyramid(cv::Mat(kSize, CV_8UC1, cv::Scalar(90)), 4));
  EXPECT_EQ(FailureOf(flat, same, kCenter), PatchFailure::kLowTexture);
  LucasKanadeOptions short_leash;
  short_leash.max_correction_px = 1;
  EXPECT_EQ(FailureOf(patch, View({4, 0}).Level(0), kCenter, short_leash), PatchFailure::kDiverged);
  LucasKanadeOptions narrow;
  narrow.max_gain = 1.2;
  EXPECT_EQ(FailureOf(patch, View({0, 0}, 0.7, 0).Level(0), kCenter, narrow), PatchFailure::kGainOutOfRange);
  LucasKanadeOptions strict;
  strict.min_ssim = 0.95;
  strict.max_gain = 100;
  const cv::Mat noisy = Texture().Render(
      kSize, [](cv::Point2d p) { return p; }, 1, 0, 25, 4);
  EXPECT_EQ(FailureOf(patch, noisy, kCenter, strict), PatchFailure::kLowSimilarity);
}

TEST(TrackPatch, BlackAndWhiteImagesAreNeverATrack) {
  const ReferencePatch patch = Cut(View({0, 0}));
  for (const int level : {0, 255})
    EXPECT_NE(FailureOf(patch, cv::Mat(kSize, CV_8UC1, cv::Scalar(level)), kCenter), PatchFailure::kNone);
}

TEST(CutReferencePatch, RefusesWhatCannotBeFollowed) {
  ReferencePatch patch;
  const ImagePyramid pyramid = View({0, 0});
  const auto cut = [&](Pixel at, const SupportMask& mask) {
    return CutReferencePatch(pyramid, mask, at, {}, AffineSolution::kWithout, &patch);
  };
  EXPECT_EQ(cut({kSize.width + 5.0, 20}, {}), PatchFailure::kOutOfImage);
  EXPECT_EQ(cut({0, 0}, {}), PatchFailure::kOutOfImage);  // three quarters of it lie outside
  EXPECT_EQ(cut(kCenter, SupportMask(cv::Mat::zeros(kSize, CV_8UC1))), PatchFailure::kMasked);
  EXPECT_EQ(cut(kCenter, {}), PatchFailure::kNone);
}

TEST(TrackBatch, IsTheSameForEveryNumberOfThreads) {
  const ImagePyramid reference = View({0, 0});
  const ImagePyramid moved = View({2.3, 1.1}, 0.9, 5);
  std::vector<ReferencePatch> patches;
  for (int y = 20; y < 190; y += 12)
    for (int x = 20; x < 230; x += 12) patches.push_back(Cut(reference, {}, {x + 0.4, y + 0.7}));
  std::vector<TrackRequest> requests;
  for (const ReferencePatch& patch : patches) requests.push_back({&patch, patch.center});
  const auto one = TrackBatch(requests, moved, {}, {}, 1);
  const auto two = TrackBatch(requests, moved, {}, {}, 2);
  ASSERT_EQ(one.size(), requests.size());
  ASSERT_EQ(two.size(), one.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].pixel.x, two[i].pixel.x);
    EXPECT_EQ(one[i].pixel.y, two[i].pixel.y);
    EXPECT_EQ(one[i].ssim, two[i].ssim);
    EXPECT_EQ(one[i].failure, two[i].failure);
  }
}

}  // namespace
}  // namespace pliant
