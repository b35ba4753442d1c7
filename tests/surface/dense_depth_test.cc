// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/surface/dense_depth.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pliant/base/statistics.h"
#include "surface/textured_plane.h"

namespace pliant {
namespace {

using test::TexturedPlane;

Result<DenseDepth> Estimate(const TexturedPlane& plane, const SurfaceView& reference,
                            const std::vector<SurfaceView>& neighbors, int threads = 1) {
  const auto estimator = DenseDepthEstimator::Create(plane.camera, {{}, 15, plane.noise_levels}, {}, threads);
  EXPECT_TRUE(estimator.ok()) << estimator.status().message();
  return estimator->Estimate(reference, neighbors);
}

struct Judged {
  double known_of_textured = 0;
  int known_of_flat = 0;
  double median_error = 0;  // relative
  double p95_error = 0;
  double within_2_sigma = 0;
};

Judged Judge(const TexturedPlane& plane, const DenseDepth& dense) {
  std::vector<double> errors;
  int textured = 0;
  int flat = 0;
  int inside = 0;
  constexpr double kWindowMm = 3;
  for (int y = 12; y < TexturedPlane::kHeight - 12; ++y)
    for (int x = 0; x < TexturedPlane::kWidth; ++x) {
      const Eigen::Vector3d truth = plane.PointOn(x, y, 0);
      const double depth = dense.depth.at<float>(y, x);
      if (truth.x() > TexturedPlane::kFlatFrom_mm + kWindowMm) flat += depth > 0 ? 1 : 0;
      if (truth.x() > TexturedPlane::kFlatFrom_mm - kWindowMm || x < 12) continue;
      ++textured;
      if (!(depth > 0)) continue;
      errors.push_back(std::abs(depth / truth.z() - 1.0));
      inside += errors.back() < 2.0 * dense.sigma.at<float>(y, x) ? 1 : 0;
    }
  if (errors.empty()) return {};
  return {static_cast<double>(errors.size()) / textured, flat, Median(errors), Quantile(errors, 0.95),
          static_cast<double>(inside) / static_cast<double>(errors.size())};
}

TEST(DenseDepth, SeesThroughTheMotionOfTheMaterial) {
  const TexturedPlane plane;
  const auto dense = Estimate(plane, plane.View(0), plane.Neighbors());
  ASSERT_TRUE(dense.ok()) << dense.status().message();
  const Judged judged = Judge(plane, *dense);
  EXPECT_GT(judged.known_of_textured, 0.9);
  EXPECT_LT(judged.median_error, 0.004);
  EXPECT_LT(judged.p95_error, 0.015);
  EXPECT_GT(judged.within_2_sigma, 0.85);
}

TEST(DenseDepth, IsWrongOrSilentWithoutTheMotion) {
  const TexturedPlane plane;
  std::vector<SurfaceView> still = plane.Neighbors();
  for (SurfaceView& view : still) {  // as if nothing had moved
    view.observations = plane.Points(0);
  }
  const auto dense = Estimate(plane, plane.View(0), still);
  ASSERT_TRUE(dense.ok()) << dense.status().message();
  const Judged judged = Judge(plane, *dense);
  EXPECT_TRUE(judged.known_of_textured < 0.5 || judged.median_error > 0.01)
      << judged.known_of_textured << " " << judged.median_error;
}

TEST(DenseDepth, HasHolesWhereNothingIsToBeSeen) {
  const TexturedPlane plane{.noise_levels = 2};
  SurfaceView reference = plane.View(0);
  const cv::Rect tool(60, 60, 80, 50);
  reference.valid(tool).setTo(0);
  const auto dense = Estimate(plane, reference, plane.Neighbors());
  ASSERT_TRUE(dense.ok()) << dense.status().message();
  EXPECT_EQ(cv::countNonZero(dense->depth(tool) > 0), 0);
  const Judged judged = Judge(plane, *dense);
  EXPECT_GT(judged.known_of_textured, 0.6);
  EXPECT_LT(judged.known_of_flat, 1400);  // of some 14000 pixels
  EXPECT_LT(judged.median_error, 0.01);
}

int Rejected(const DenseDepth& dense, DepthRejection why) { return dense.rejected[static_cast<std::size_t>(why)]; }

int AllPixels(const DenseDepth& dense) {
  return cv::countNonZero(dense.depth > 0) + std::accumulate(dense.rejected.begin(), dense.rejected.end(), 0);
}

TEST(DenseDepth, ACameraThatStandsStillTellsNothing) {
  const TexturedPlane plane{.slide_mm = 1, .baseline_mm = 0};
  const auto dense = Estimate(plane, plane.View(0), plane.Neighbors());
  ASSERT_TRUE(dense.ok()) << dense.status().message();
  EXPECT_EQ(cv::countNonZero(dense->depth > 0), 0);
  EXPECT_GT(Rejected(*dense, DepthRejection::kLittleParallax), AllPixels(*dense) / 2);
}

TEST(DenseDepth, EveryPixelHasADepthOrAReasonForNone) {
  const TexturedPlane plane{.noise_levels = 2};
  SurfaceView reference = plane.View(0);
  const cv::Rect tool(60, 60, 80, 50);
  reference.valid(tool).setTo(0);
  const auto dense = Estimate(plane, reference, plane.Neighbors());
  ASSERT_TRUE(dense.ok()) << dense.status().message();
  EXPECT_EQ(AllPixels(*dense), TexturedPlane::kWidth * TexturedPlane::kHeight);
  EXPECT_EQ(Rejected(*dense, DepthRejection::kNotSurface), tool.area());
  EXPECT_EQ(Rejected(*dense, DepthRejection::kLittleParallax), 0);
}

TEST(DenseDepth, IsTheSameOnAnyNumberOfThreads) {
  const TexturedPlane plane{.noise_levels = 1};
  const auto one = Estimate(plane, plane.View(0), plane.Neighbors(), 1);
  const auto three = Estimate(plane, plane.View(0), plane.Neighbors(), 3);
  ASSERT_TRUE(one.ok() && three.ok());
  EXPECT_EQ(cv::countNonZero(one->depth != three->depth), 0);
  EXPECT_EQ(cv::countNonZero(one->sigma != three->sigma), 0);
}

TEST(DenseDepth, LargerImagesAreReduced) {
  const TexturedPlane plane;
  const auto estimator = DenseDepthEstimator::Create(plane.camera, {}, {.max_width = 160}, 1);
  ASSERT_TRUE(estimator.ok());
  const auto dense = estimator->Estimate(plane.View(0), plane.Neighbors());
  ASSERT_TRUE(dense.ok()) << dense.status().message();
  EXPECT_EQ(dense->depth.size(), cv::Size(TexturedPlane::kWidth, TexturedPlane::kHeight));
  EXPECT_LT(Judge(plane, *dense).median_error, 0.01);
}

TEST(DenseDepth, NeedsPointsInCommon) {
  const TexturedPlane plane;
  std::vector<SurfaceView> neighbors = plane.Neighbors();
  for (SurfaceView& view : neighbors) view.observations.resize(5);
  EXPECT_EQ(Estimate(plane, plane.View(0), neighbors).status().code(), ErrorCode::kInsufficient);
  EXPECT_EQ(Estimate(plane, plane.View(0), {}).status().code(), ErrorCode::kInsufficient);
}

}  // namespace
}  // namespace pliant
