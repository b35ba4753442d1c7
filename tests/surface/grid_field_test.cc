// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "surface/grid_field.h"

#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace pliant {
namespace {

constexpr double kSpacing_px = 8;
const cv::Size kSize(160, 120);

double PlaneAt(const Eigen::Vector2d& pixel) { return 3.0 + 0.02 * pixel.x() - 0.05 * pixel.y(); }

std::vector<Eigen::Vector2d> SomePixels() {
  std::vector<Eigen::Vector2d> pixels;
  for (int i = 0; i < 40; ++i) pixels.emplace_back((i * 37) % 160, (i * 53) % 120);
  return pixels;
}

TEST(GridField, APlateThroughAPlaneIsThePlane) {
  const std::vector<Eigen::Vector2d> pixels = SomePixels();
  Eigen::MatrixXd values(static_cast<Eigen::Index>(pixels.size()), 2);
  for (std::size_t i = 0; i < pixels.size(); ++i) values.row(static_cast<Eigen::Index>(i)) << PlaneAt(pixels[i]), 7.0;
  const GridField field = FitThinPlate(kSize, kSpacing_px, pixels, values, 0.1);
  for (const Eigen::Vector2d& pixel : std::vector<Eigen::Vector2d>{{0, 0}, {159, 119}, {80.5, 33.25}}) {
    EXPECT_NEAR(field.At(pixel)[0], PlaneAt(pixel), 1e-4);
    EXPECT_NEAR(field.At(pixel)[1], 7.0, 1e-4);
  }
}

TEST(GridField, AWrongValueCountsLittle) {
  const std::vector<Eigen::Vector2d> pixels = SomePixels();
  Eigen::MatrixXd values(static_cast<Eigen::Index>(pixels.size()), 1);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    values(static_cast<Eigen::Index>(i), 0) = PlaneAt(pixels[i]) + 0.01 * (i % 2 == 0 ? 1 : -1);
  const double before = FitThinPlate(kSize, kSpacing_px, pixels, values, 1.0).At(pixels[17])[0];
  values(17, 0) += 5.0;
  const double after = FitThinPlate(kSize, kSpacing_px, pixels, values, 1.0).At(pixels[17])[0];
  EXPECT_LT(after - before, 0.5);
}

TEST(GridField, AnImageOfAnotherSizeHasTheSameValuesAtTheSamePlaces) {
  GridField field({21, 16}, kSpacing_px, 1);
  for (int r = 0; r < 16; ++r)
    for (int c = 0; c < 21; ++c) field.values()(r * 21 + c, 0) = PlaneAt({c * kSpacing_px, r * kSpacing_px});
  const cv::Mat half = field.ToImage({80, 60}, 2.0);
  EXPECT_NEAR(half.at<float>(10, 20), PlaneAt({40.5, 20.5}), 1e-5);  // the middle of four pixels
  EXPECT_NEAR(field.ToImage(kSize, 1.0).at<float>(20, 40), PlaneAt({40, 20}), 1e-5);
}

}  // namespace
}  // namespace pliant
