// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/surface/fill_holes.h"

#include <array>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace pliant {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 120;
constexpr double kFocal_px = 150;
constexpr float kSigma = 0.01F;
constexpr double kFloatDepth = 1e-5;  // relative, of a plane that floats hold
constexpr double kBend = 2e-3;  // relative: the sagitta of the hole in the sphere, 1.8^2 / 50 mm of 55 mm, and some
const cv::Point kHole(80, 60);
constexpr int kHoleRadius_px = 5;
constexpr int kHoleArea_px = 100;  // a disc of this radius has somewhat fewer pixels

Camera TestCameraOfHoles() {
  return Camera::Create(CameraModelId::kPinhole, kWidth, kHeight, std::array{kFocal_px, kFocal_px, 79.5, 59.5}).value();
}

// Of the plane z = 50 + slope x.
DenseDepth Plane(double slope) {
  DenseDepth dense{cv::Mat(kHeight, kWidth, CV_32F), cv::Mat(kHeight, kWidth, CV_32F, cv::Scalar(kSigma))};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      dense.depth.at<float>(y, x) = static_cast<float>(50.0 / (1.0 - slope * (x - 79.5) / kFocal_px));
  return dense;
}

// The inside of a sphere around (0, 0, 30).
DenseDepth Sphere(double radius) {
  DenseDepth dense = Plane(0);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const Eigen::Vector3d ray((x - 79.5) / kFocal_px, (y - 59.5) / kFocal_px, 1.0);
      const double half = 30.0 / ray.squaredNorm();
      dense.depth.at<float>(y, x) =
          static_cast<float>(half + std::sqrt(half * half - (900.0 - radius * radius) / ray.squaredNorm()));
    }
  return dense;
}

void CutHole(cv::Point at, int radius_px, DenseDepth* dense) {
  for (cv::Mat* image : {&dense->depth, &dense->sigma}) cv::circle(*image, at, radius_px, cv::Scalar(0), cv::FILLED);
}

cv::Mat AllTissue() { return {kHeight, kWidth, CV_8U, cv::Scalar(255)}; }

double LargestRelativeError(const cv::Mat& depth, const cv::Mat& truth, const cv::Mat& where) {
  double largest = 0.0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      if (where.at<std::uint8_t>(y, x) != 0)
        largest = std::max(largest, std::abs(depth.at<float>(y, x) / truth.at<float>(y, x) - 1.0));
  return largest;
}

TEST(FillHoles, APlaneIsExact) {
  const DenseDepth truth = Plane(0.5);
  DenseDepth dense{truth.depth.clone(), truth.sigma.clone()};
  CutHole(kHole, kHoleRadius_px, &dense);
  const cv::Mat hole = dense.depth == 0.0F;
  const cv::Mat filled = FillHoles(TestCameraOfHoles(), AllTissue(), kHoleArea_px, &dense);
  EXPECT_EQ(cv::countNonZero(filled != hole), 0);
  EXPECT_LT(LargestRelativeError(dense.depth, truth.depth, filled), kFloatDepth);
  // As certain as what is around, on which nothing was changed.
  EXPECT_NEAR(dense.sigma.at<float>(kHole), kSigma, kFloatDepth);
  EXPECT_EQ(cv::countNonZero((dense.depth != truth.depth) & (hole == 0)), 0);
}

TEST(FillHoles, ACurvedSurfaceIsLessCertain) {
  const DenseDepth truth = Sphere(25);
  DenseDepth dense{truth.depth.clone(), truth.sigma.clone()};
  CutHole(kHole, kHoleRadius_px, &dense);
  const cv::Mat filled = FillHoles(TestCameraOfHoles(), AllTissue(), kHoleArea_px, &dense);
  EXPECT_GT(cv::countNonZero(filled), 0);
  EXPECT_LT(LargestRelativeError(dense.depth, truth.depth, filled), kBend);
  EXPECT_GT(dense.sigma.at<float>(kHole), kSigma);
}

TEST(FillHoles, NothingIsFilledAcrossAnEdge) {
  // The right side is farther by a tenth.
  DenseDepth dense = Plane(0);
  dense.depth.colRange(kHole.x, kWidth) *= 1.1;
  CutHole(kHole, kHoleRadius_px, &dense);
  EXPECT_EQ(cv::countNonZero(FillHoles(TestCameraOfHoles(), AllTissue(), kHoleArea_px, &dense)), 0);
  EXPECT_EQ(dense.depth.at<float>(kHole), 0.0F);
}

TEST(FillHoles, ALargeHoleAndOneAtTheBorderStay) {
  DenseDepth dense = Plane(0.2);
  CutHole({40, 60}, kHoleRadius_px, &dense);
  CutHole({110, 60}, 2 * kHoleRadius_px, &dense);
  CutHole({80, 0}, 2, &dense);
  const cv::Mat filled = FillHoles(TestCameraOfHoles(), AllTissue(), kHoleArea_px, &dense);
  EXPECT_NE(filled.at<std::uint8_t>(60, 40), 0);
  EXPECT_EQ(filled.at<std::uint8_t>(60, 110), 0);
  EXPECT_EQ(filled.at<std::uint8_t>(0, 80), 0);
}

TEST(FillHoles, WhatIsNotTissueStays) {
  DenseDepth dense = Plane(0.2);
  CutHole(kHole, kHoleRadius_px, &dense);
  cv::Mat tissue = AllTissue();
  tissue.at<std::uint8_t>(kHole) = 0;
  EXPECT_EQ(cv::countNonZero(FillHoles(TestCameraOfHoles(), tissue, kHoleArea_px, &dense)), 0);
}

}  // namespace
}  // namespace pliant
