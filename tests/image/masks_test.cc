// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/masks.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "pliant/image/pyramid.h"

namespace pliant {
namespace {

const cv::Size kMaskSize(320, 240);
const cv::Point kCenter(160, 120);
constexpr int kSpotWithHalo = 400;  // pixels: a disk of radius 11 has 380

cv::Mat Tissue() { return {kMaskSize, CV_8UC3, cv::Scalar(90, 100, 170)}; }

cv::Mat RoundView() {
  cv::Mat image(kMaskSize, CV_8UC3, cv::Scalar(3, 3, 3));
  cv::circle(image, kCenter, 110, cv::Scalar(90, 100, 170), cv::FILLED);
  return image;
}

int At(const cv::Mat& mask, int x, int y) { return mask.at<std::uint8_t>(y, x); }

TEST(HighlightMask, FindsSaturatedSpotsAndTheirHalo) {
  cv::Mat image = Tissue();
  cv::circle(image, {100, 80}, 5, cv::Scalar(255, 255, 255), cv::FILLED);
  const cv::Mat mask = HighlightMask(image, {});
  EXPECT_EQ(At(mask, 100, 80), 255);
  EXPECT_EQ(At(mask, 107, 80), 255);
  EXPECT_EQ(At(mask, 112, 80), 0);
  EXPECT_LT(cv::countNonZero(mask), kSpotWithHalo);
}

TEST(HighlightMask, TellsPaleSpotsFromColoredOnesAndFromWhiteTissue) {
  cv::Mat image = Tissue();
  cv::circle(image, {60, 80}, 5, cv::Scalar(215, 215, 220), cv::FILLED);   // pale: a highlight below saturation
  cv::circle(image, {150, 80}, 5, cv::Scalar(150, 215, 255), cv::FILLED);  // bright, but colored
  cv::rectangle(image, {200, 120}, {319, 239}, cv::Scalar(205, 205, 210), cv::FILLED);  // a white surface
  const cv::Mat mask = HighlightMask(image, {});
  EXPECT_EQ(At(mask, 60, 80), 255);
  EXPECT_EQ(At(mask, 150, 80), 0);
  EXPECT_EQ(At(mask, 270, 190), 0);
}

TEST(DarkBorderMask, CoversWhatSurroundsARoundView) {
  const cv::Mat mask = DarkBorderMask(ToGray(RoundView()), {});
  EXPECT_EQ(At(mask, 2, 2), 255);
  EXPECT_EQ(At(mask, 317, 237), 255);
  EXPECT_EQ(At(mask, 5, 120), 255);
  EXPECT_EQ(At(mask, 160, 120), 0);
  EXPECT_EQ(At(mask, 160 + 100, 120), 0);
  EXPECT_EQ(At(mask, 160 + 112, 120), 255);
}

TEST(DarkBorderMask, KeepsADarkLumenInTheMiddleAndAtASide) {
  cv::Mat image = RoundView();
  cv::circle(image, kCenter, 40, cv::Scalar(2, 2, 2), cv::FILLED);
  EXPECT_EQ(At(DarkBorderMask(ToGray(image), {}), 160, 120), 0);
  cv::Mat open = Tissue();
  cv::circle(open, {310, 120}, 50, cv::Scalar(2, 2, 2), cv::FILLED);
  EXPECT_EQ(cv::countNonZero(DarkBorderMask(ToGray(open), {})), 0);
}

TEST(DarkBorderMask, IgnoresCaptionsOnTheBlack) {
  cv::Mat image = RoundView();
  cv::putText(image, "12:30", {2, 14}, cv::FONT_HERSHEY_PLAIN, 0.8, cv::Scalar(255, 255, 255));
  EXPECT_EQ(At(DarkBorderMask(ToGray(image), {}), 20, 10), 255);
}

TEST(DarkBorderMask, IsEmptyOnAFullViewAndFullOnABlackImage) {
  EXPECT_EQ(cv::countNonZero(DarkBorderMask(ToGray(Tissue()), {})), 0);
  EXPECT_EQ(cv::countNonZero(DarkBorderMask(cv::Mat::zeros(kMaskSize, CV_8UC1), {})), kMaskSize.area());
}

TEST(ValidMask, CombinesGivenAndFoundMasksAndHonorsTheSwitches) {
  cv::Mat image = RoundView();
  cv::circle(image, {200, 150}, 5, cv::Scalar(255, 255, 255), cv::FILLED);
  cv::Mat given(kMaskSize, CV_8UC1, cv::Scalar(7));
  given(cv::Rect(100, 100, 20, 20)).setTo(0);
  const cv::Mat valid = ValidMask(image, given, {});
  EXPECT_EQ(At(valid, 110, 110), 0);
  EXPECT_EQ(At(valid, 200, 150), 0);
  EXPECT_EQ(At(valid, 3, 3), 0);
  EXPECT_EQ(At(valid, 160, 60), 255);
  MaskOptions off;
  off.highlights = Switch::kOff;
  off.border = Switch::kOff;
  EXPECT_EQ(cv::countNonZero(ValidMask(image, {}, off)), kMaskSize.area());
}

TEST(SupportMask, GivesTheShareOfASquareAndCountsTheOutsideAsUnusable) {
  cv::Mat valid(20, 20, CV_8UC1, cv::Scalar(255));
  valid(cv::Rect(0, 0, 10, 20)).setTo(0);
  const SupportMask mask(valid);
  EXPECT_DOUBLE_EQ(mask.Fraction(14, 10, 2), 1.0);
  EXPECT_DOUBLE_EQ(mask.Fraction(10, 10, 2), 0.6);
  EXPECT_DOUBLE_EQ(mask.Fraction(19, 10, 1), 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(mask.Fraction(-30, 10, 1), 0.0);
  EXPECT_TRUE(mask.Valid(10, 0));
  EXPECT_FALSE(mask.Valid(9, 0));
  EXPECT_FALSE(mask.Valid(20, 0));
  EXPECT_DOUBLE_EQ(SupportMask().Fraction(-30, 10, 1), 1.0);
}

TEST(ErodeMask, KeepsOnlyWholeSquares) {
  cv::Mat valid(30, 30, CV_8UC1, cv::Scalar(255));
  valid.at<std::uint8_t>(15, 15) = 0;
  const cv::Mat eroded = ErodeMask(valid, 3);
  EXPECT_EQ(At(eroded, 15 + 3, 15), 0);
  EXPECT_EQ(At(eroded, 15 + 4, 15), 255);
  EXPECT_EQ(At(eroded, 2, 15), 0);
  EXPECT_EQ(At(eroded, 3, 15), 255);
}

}  // namespace
}  // namespace pliant
