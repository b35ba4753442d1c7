// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/surface_truth.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "pliant/base/statistics.h"
#include "support/rendered_sequence.h"

namespace pliant {
namespace {

constexpr double kDepth = 0.01;     // median, relative: a tenth of a pixel of some 20 px of disparity
constexpr double kSigmasLow = 0.3;  // of a normal distribution the median is 0.67 standard deviations ...
constexpr double kSigmasHigh = 1.2;
constexpr double kWithinThree = 0.9;  // ... and nearly all are within three; some pixels lie beside an edge

std::vector<Eigen::Vector2d> Grid() {
  std::vector<Eigen::Vector2d> pixels;
  for (double v = 12.3; v < 230; v += 11)
    for (double u = 12.7; u < 310; u += 11) pixels.emplace_back(u, v);
  return pixels;
}

std::unique_ptr<Sequence> Pairs() {
  auto sequence = std::make_unique<RenderedSequence>();
  sequence->mono = false;
  return sequence;
}

TEST(SurfaceTruth, PairsMeasureTheDepthAndHowCertainItIs) {
  const RenderedSequence depth_images;
  const std::vector<Eigen::Vector2d> pixels = Grid();
  const auto exact = SurfaceTruthFromDepthImages(depth_images, 0.05);
  const auto measured = PairTruth(Pairs(), 2);
  std::vector<double> errors;
  std::vector<double> in_sigmas;
  for (const int frame : {0, 3, 4, 17}) {
    const auto truth = exact->At(frame, pixels);
    const auto found = measured->At(frame, pixels);
    ASSERT_TRUE(truth.ok() && truth->has_value());
    ASSERT_TRUE(found.ok() && found->has_value());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const DepthAtPixel& depth = (**found)[i];
      if (depth.lookup != DepthLookup::kOk || (**truth)[i].lookup != DepthLookup::kOk) continue;
      const double error_mm = std::abs(depth.depth_mm - (**truth)[i].depth_mm);
      errors.push_back(error_mm / depth.depth_mm);
      in_sigmas.push_back(error_mm / depth.sigma_mm);
    }
  }
  EXPECT_GT(errors.size(), 2 * pixels.size()) << "of four times as many";
  EXPECT_LT(Median(errors), kDepth);
  EXPECT_GT(Median(in_sigmas), kSigmasLow);
  EXPECT_LT(Median(in_sigmas), kSigmasHigh);
  const auto within = std::count_if(in_sigmas.begin(), in_sigmas.end(), [](double error) { return error < 3; });
  EXPECT_GT(static_cast<double>(within), kWithinThree * static_cast<double>(in_sigmas.size()));
}

TEST(SurfaceTruth, ComesFromPairsWhereTheyAreRectifiedAndThereIsNoDepth) {
  class Lens final : public Sequence {
   public:
    explicit Lens(const Camera& camera, std::optional<double> baseline_mm)
        : camera_(camera), baseline_mm_(baseline_mm) {}
    const Camera& camera() const override { return camera_; }
    int size() const override { return 1; }
    Result<std::optional<SequenceFrame>> Next() override { return std::optional<SequenceFrame>(); }
    Result<std::optional<cv::Mat>> Depth(int /*frame_idx*/) const override { return std::optional<cv::Mat>(); }
    std::optional<Rigid3> WorldFromCamera(int /*frame_idx*/) const override { return std::nullopt; }
    std::optional<double> BaselineMm() const override { return baseline_mm_; }

   private:
    Camera camera_;
    std::optional<double> baseline_mm_;
  };
  EvaluationInput run;
  run.frames.emplace_back();
  const Camera fisheye =
      Camera::Create("OPENCV_FISHEYE", 320, 240, std::vector<double>{100, 100, 160, 120, 0, 0, 0, 0}).value();
  const Camera& pinhole = Rendered().camera;
  for (const Lens& lens : {Lens(fisheye, 5.0), Lens(pinhole, 0.0), Lens(pinhole, -5.0), Lens(pinhole, std::nullopt)}) {
    const auto any = OpenSurfaceTruth(SurfaceSource::kAny, run, lens, {.image_path = "nowhere"}, 0.05);
    ASSERT_TRUE(any.ok());
    EXPECT_FALSE((*any)->IsOfPairs());
    const auto pairs = OpenSurfaceTruth(SurfaceSource::kPairs, run, lens, {.image_path = "nowhere"}, 0.05);
    EXPECT_EQ(pairs.status().code(), ErrorCode::kMismatch);
  }
  const Lens good(pinhole, 5.0);
  EXPECT_EQ(OpenSurfaceTruth(SurfaceSource::kAny, run, good, {.image_path = "nowhere"}, 0.05).status().code(),
            ErrorCode::kNotFound)
      << "its pairs are wanted";
}

TEST(SurfaceTruth, WhatASequenceDoesNotHaveIsNothing) {
  const std::vector<Eigen::Vector2d> pixels = {{100, 100}};
  const auto measured = PairTruth(Pairs(), 1);
  EXPECT_FALSE(measured->At(1000, pixels)->has_value());
  EXPECT_FALSE(PairTruth(std::make_unique<RenderedSequence>(), 1)->At(0, pixels)->has_value()) << "no pairs";
}

}  // namespace
}  // namespace pliant
