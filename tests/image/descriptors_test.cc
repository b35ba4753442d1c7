// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/image/descriptors.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace pliant {
namespace {

cv::Mat Texture() {
  cv::Mat noise(240, 320, CV_8UC1);
  cv::RNG rng(7);
  rng.fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(noise, noise, cv::Size(), 3);
  cv::normalize(noise, noise, 30, 220, cv::NORM_MINMAX);
  return noise;
}

std::vector<Eigen::Vector2d> Grid(double dx, double dy) {
  std::vector<Eigen::Vector2d> pixels;
  for (int y = 40; y <= 200; y += 20)
    for (int x = 40; x <= 280; x += 20) pixels.emplace_back(x + dx, y + dy);
  return pixels;
}

TEST(Descriptors, TellPixelsApartAfterAChangeOfLightAndView) {
  const cv::Mat before = Texture();
  cv::Mat after;
  const cv::Matx23d change(1.05, 0.08, 4.0, -0.08, 1.05, 9.0);  // 5 % larger, turned by 4 degrees, shifted
  cv::warpAffine(before, after, change, before.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
  after.convertTo(after, CV_8UC1, 0.6, 20);
  const std::vector<Eigen::Vector2d> a = Grid(0, 0);
  std::vector<Eigen::Vector2d> b;
  for (auto p = a.rbegin(); p != a.rend(); ++p)  // in another order
    b.emplace_back(change(0, 0) * p->x() + change(0, 1) * p->y() + change(0, 2),
                   change(1, 0) * p->x() + change(1, 1) * p->y() + change(1, 2));
  const cv::Mat of_a = DescribePixels(before, a);
  ASSERT_EQ(of_a.rows, static_cast<int>(a.size()));
  EXPECT_EQ(of_a.cols, 128);
  const auto pairs = MatchDescriptors(of_a, DescribePixels(after, b), 0.85);
  EXPECT_GT(pairs.size(), a.size() * 9 / 10);
  for (const auto& [i, j] : pairs) EXPECT_EQ(j, static_cast<int>(a.size()) - 1 - i);
}

TEST(Descriptors, PixelsOfAnotherImageMatchRarely) {
  const auto pixels = Grid(0, 0);
  cv::Mat other;
  cv::flip(Texture(), other, 0);
  const auto pairs = MatchDescriptors(DescribePixels(Texture(), pixels), DescribePixels(other, pixels), 0.85);
  EXPECT_LT(pairs.size(), pixels.size() / 10);
}

TEST(Descriptors, ExistAtAndBeyondTheEdge) {
  const std::vector<Eigen::Vector2d> pixels = {{0, 0}, {319, 239}, {-3, 100}, {160, 250}};
  const cv::Mat descriptors = DescribePixels(Texture(), pixels);
  ASSERT_EQ(descriptors.rows, 4);
  EXPECT_TRUE(cv::checkRange(descriptors));
}

TEST(Descriptors, NothingMatchesNothing) {
  EXPECT_EQ(DescribePixels(Texture(), {}).rows, 0);
  EXPECT_TRUE(MatchDescriptors(DescribePixels(Texture(), {}), DescribePixels(Texture(), Grid(0, 0)), 0.85).empty());
  EXPECT_TRUE(MatchDescriptors(DescribePixels(Texture(), Grid(0, 0)), {}, 0.85).empty());
}

}  // namespace
}  // namespace pliant
