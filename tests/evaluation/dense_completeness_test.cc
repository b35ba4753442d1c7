// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/dense_completeness.h"

#include <functional>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pliant/datasets/png_file.h"
#include "support/rendered_sequence.h"
#include "support/test_folder.h"

namespace pliant {
namespace {

constexpr double kDepthScale = 0.005;
constexpr double kTextured = 0.5;  // at least, of the rendered tissue

// A material of which every point is seen in the given frames alone.
class SeenIn final : public MaterialTruth {
 public:
  explicit SeenIn(std::vector<int> frames) : frames_(std::move(frames)) {}

  Result<std::vector<std::optional<MaterialId>>> PointsAt(int, std::span<const Eigen::Vector2d> pixels) override {
    return std::vector<std::optional<MaterialId>>(pixels.size(), MaterialId{});
  }
  Result<std::vector<std::optional<MaterialState>>> Observe(int frame_idx,
                                                            std::span<const MaterialId> points) override {
    MaterialState state{.point_in_cam = Eigen::Vector3d::UnitZ(), .pixel = {}, .visibility = {}};
    const bool seen = std::ranges::find(frames_, frame_idx) != frames_.end();
    state.visibility = seen ? MaterialVisibility::kVisible : MaterialVisibility::kOccluded;
    return std::vector<std::optional<MaterialState>>(points.size(), state);
  }

 private:
  std::vector<int> frames_;
};

class DenseCompletenessTest : public testing::Test {
 protected:
  // The true depth of frame 5, changed, as found with frames 3 and 7, or with its right image.
  SurfaceFolder Surface(
      bool pair, const std::function<void(cv::Mat*)>& change = [](cv::Mat*) {}) {
    for (const char* kind : {"depth", "confidence"}) std::filesystem::create_directories(folder_.Path(kind));
    cv::Mat depth = Rendered().frames[5].depth.clone();
    change(&depth);
    const cv::Mat sigma(depth.size(), CV_32F, cv::Scalar(0.01));
    EXPECT_TRUE(WritePng(folder_.Path("depth/5.png"), QuantizeDepth(depth, kDepthScale)).ok());
    EXPECT_TRUE(WritePng(folder_.Path("confidence/5.png"), QuantizeDepth(sigma, surface::kConfidenceUnit)).ok());
    return {folder_.Path("."), {}, Rendered().camera, kDepthScale, {{5, "5.png", {3, 7}, pair}}, ComparedWindows{320}};
  }

  Result<std::optional<DenseCompleteness>> Compute(const SurfaceFolder& surface, MaterialTruth* material) {
    RenderedSequence images;
    images.mono = false;
    return ComputeDenseCompleteness(surface, &images, material, {});
  }

  TestFolder folder_;
};

TEST_F(DenseCompletenessTest, CountsWhatTwoOtherImagesSee) {
  const SurfaceFolder surface =
      Surface(false, [](cv::Mat* depth) { (*depth)(cv::Rect(0, 0, depth->cols, depth->rows / 2)).setTo(0.0F); });
  SeenIn both({3, 7});
  const auto all = Compute(surface, &both);
  ASSERT_TRUE(all.ok() && all->has_value());
  EXPECT_GT((*all)->share, kTextured);
  EXPECT_NEAR((*all)->known_share, 0.5, 0.1);
  SeenIn one({3});
  const auto none = Compute(surface, &one);
  ASSERT_TRUE(none.ok());
  EXPECT_FALSE(none->has_value());
}

TEST_F(DenseCompletenessTest, CountsFramesWithoutADepthThatWereCompared) {
  SurfaceFolder surface = Surface(false);
  surface.frames_without_depth = {{6, "", {4, 8}}, {9, "", {}}};
  SeenIn others({3, 4, 7, 8});
  const auto half = Compute(surface, &others);
  ASSERT_TRUE(half.ok()) << half.status().message();
  ASSERT_TRUE(half->has_value());
  EXPECT_NEAR((*half)->known_share, 0.5, 0.01);
}

TEST_F(DenseCompletenessTest, DoesNotCountFilledHoles) {
  const SurfaceFolder surface = Surface(false);
  std::filesystem::create_directories(folder_.Path("filled"));
  cv::Mat filled(Rendered().camera.height(), Rendered().camera.width(), CV_8U, cv::Scalar(0));
  filled(cv::Rect(0, 0, filled.cols, filled.rows / 2)).setTo(255);
  ASSERT_TRUE(WritePng(folder_.Path("filled/5.png"), filled).ok());
  SeenIn both({3, 7});
  const auto measured = Compute(surface, &both);
  ASSERT_TRUE(measured.ok() && measured->has_value());
  EXPECT_NEAR((*measured)->known_share, 0.5, 0.1);
}

TEST_F(DenseCompletenessTest, OfAPairCountsWhatTheRightImageSees) {
  const auto whole = Compute(Surface(true), nullptr);
  ASSERT_TRUE(whole.ok() && whole->has_value());
  EXPECT_EQ((*whole)->known_share, 1.0);
  // What the right camera does not see lies at the left rim and behind the left side of the upper lobe.
  const double baseline_px = Rendered().camera.params()[0] * Rendered().baseline_mm;
  const auto without_rim = Compute(Surface(true,
                                           [&](cv::Mat* depth) {
                                             for (int y = 0; y < depth->rows; ++y)
                                               for (int x = 0; x < depth->cols; ++x)
                                                 if (x + 1 < baseline_px / depth->at<float>(y, x))
                                                   depth->at<float>(y, x) = 0.0F;
                                           }),
                                   nullptr);
  ASSERT_TRUE(without_rim.ok() && without_rim->has_value());
  EXPECT_EQ((*without_rim)->known_share, 1.0);
}

TEST_F(DenseCompletenessTest, IsNotKnownWithoutWhatOtherImagesSee) {
  SurfaceFolder surface = Surface(false);
  const auto without_material = Compute(surface, nullptr);
  ASSERT_TRUE(without_material.ok());
  EXPECT_FALSE(without_material->has_value());
  surface.windows.reset();
  SeenIn both({3, 7});
  const auto without_windows = Compute(surface, &both);
  ASSERT_TRUE(without_windows.ok());
  EXPECT_FALSE(without_windows->has_value());
}

}  // namespace
}  // namespace pliant
