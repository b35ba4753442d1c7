// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/point_colors.h"

#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "pliant/image/brightness.h"

namespace pliant {
namespace {

constexpr int kColoredPoints = 800;

cv::Mat TextureOf(int seed) {
  cv::RNG random(static_cast<std::uint64_t>(seed));
  cv::Mat image(240, 320, CV_8UC3);
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(image, image, {}, 2.0);
  cv::normalize(image, image, 20, 230, cv::NORM_MINMAX);
  return image;
}

// Points of an image, with its colors or all gray.
struct Colored {
  RunMap map;
  std::vector<PointObservation> observations;

  Colored(const cv::Mat& image, int count, bool gray = false) {
    cv::RNG random(7);
    for (int k = 0; k < count; ++k) {
      const Eigen::Vector2d pixel(random.uniform(20, image.cols - 20), random.uniform(20, image.rows - 20));
      PointObservation seen;
      seen.id = PointId{k};
      seen.pixel = pixel;
      observations.push_back(seen);
      NewPoint point;
      point.id = seen.id;
      if (!gray) point.rgb = ColorAt(image, pixel);
      map.points.emplace(point.id, point);
    }
  }

  bool AreOtherThan(const cv::Mat& image) const {
    PointColors colors(map);
    colors.Compare(observations, image);
    return colors.AreOfOtherImages();
  }
};

TEST(PointColors, AreThoseOfTheImageInOtherLightToo) {
  const cv::Mat image = TextureOf(1);
  const Colored points(image, kColoredPoints);
  EXPECT_FALSE(points.AreOtherThan(image));
  EXPECT_FALSE(points.AreOtherThan(0.8 * image + cv::Scalar::all(25)));
}

TEST(PointColors, AreNotThoseOfAnotherImageNorOfOneThatMoved) {
  const Colored points(TextureOf(1), kColoredPoints);
  EXPECT_TRUE(points.AreOtherThan(TextureOf(987654)));
  cv::Mat moved;
  cv::warpAffine(TextureOf(1), moved, cv::Matx23d(1, 0, 12, 0, 1, 7), {}, cv::INTER_LINEAR, cv::BORDER_REFLECT);
  EXPECT_TRUE(points.AreOtherThan(moved));
}

TEST(PointColors, SayNothingWhereTheyAreFewOrNone) {
  EXPECT_FALSE(Colored(TextureOf(1), 20).AreOtherThan(TextureOf(987654)));
  EXPECT_FALSE(Colored(TextureOf(1), kColoredPoints, true).AreOtherThan(TextureOf(987654)));
}

TEST(PointColors, CountInTheFirstFrameThatHasThem) {
  const Colored points(TextureOf(1), kColoredPoints);
  PointColors colors(points.map);
  colors.Compare(points.observations, TextureOf(1));
  colors.Compare(points.observations, TextureOf(987654));  // seen before
  EXPECT_FALSE(colors.AreOfOtherImages());
}

}  // namespace
}  // namespace pliant
