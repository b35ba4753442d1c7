// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/pyramid.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/tolerances.h"

namespace pliant {
namespace {

constexpr double kRounding = 1.0;  // gray levels: each level is rounded to 8 bits

cv::Mat Ramp(cv::Size size) {
  cv::Mat image(size, CV_8UC1);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(20 + x + y / 2);
  return image;
}

TEST(ImagePyramid, PixelOfALevelLiesAtTheHalvedPosition) {
  const ImagePyramid pyramid(Ramp({128, 96}), 3);
  ASSERT_EQ(pyramid.levels(), 3);
  EXPECT_EQ(pyramid.width(2), 32);
  EXPECT_EQ(pyramid.height(2), 24);
  for (int level = 1; level < 3; ++level)
    for (const int x : {4, 10, 20})
      EXPECT_NEAR(pyramid.Level(level).at<std::uint8_t>(8, x), 20 + (x << level) + (4 << level), kRounding);
}

TEST(ImagePyramid, DoesNotFoldFineTextureIntoCoarseLevels) {
  cv::Mat stripes(64, 64, CV_8UC1);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) stripes.at<std::uint8_t>(y, x) = x % 2 == 0 ? 0 : 200;
  const ImagePyramid pyramid(stripes, 2);
  EXPECT_NEAR(pyramid.Level(1).at<std::uint8_t>(10, 10), 100, kRounding);
}

TEST(ImagePyramid, PaddingRepeatsTheBorder) {
  const ImagePyramid pyramid(Ramp({64, 48}), 2);
  for (int level = 0; level < 2; ++level) {
    const std::uint8_t* origin = pyramid.origin(level);
    const std::ptrdiff_t stride = pyramid.stride(level);
    const int pad = ImagePyramid::kPadding;
    EXPECT_EQ(origin[-pad], origin[0]);
    EXPECT_EQ(origin[-pad * stride], origin[0]);
    const std::ptrdiff_t last = (pyramid.height(level) - 1) * stride + pyramid.width(level) - 1;
    EXPECT_EQ(origin[last + pad * stride + pad], origin[last]);
  }
}

TEST(ImagePyramid, StopsBeforeLevelsBecomeTiny) { EXPECT_EQ(ImagePyramid(Ramp({64, 40}), 8).levels(), 2); }

TEST(ToGray, LeavesGrayAndWeighsColors) {
  const cv::Mat gray = Ramp({8, 8});
  EXPECT_EQ(ToGray(gray).data, gray.data);
  const cv::Mat red(4, 4, CV_8UC3, cv::Scalar(0, 0, 200));
  EXPECT_NEAR(ToGray(red).at<std::uint8_t>(0, 0), 0.299 * 200, kRounding);
}

TEST(SampleBilinear, IsExactOnARampAndSaysWhenItIsOutside) {
  const cv::Mat image = Ramp({30, 30});
  EXPECT_NEAR(*SampleBilinear(image, 3.25, 4.0), 20 + 3.25 + 2, kRoundOff);
  EXPECT_EQ(*SampleBilinear(image, 29, 29), image.at<std::uint8_t>(29, 29));
  EXPECT_FALSE(SampleBilinear(image, 29.001, 3).has_value());
  EXPECT_FALSE(SampleBilinear(image, -0.001, 3).has_value());
  EXPECT_FALSE(SampleBilinear(image, std::nan(""), 3).has_value());
}

}  // namespace
}  // namespace pliant
