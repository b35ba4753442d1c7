// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/material_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluation/truth_sequence.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

constexpr double kNotFlat_mm = 1;       // the truth is no plane before the camera, so the null has an error
constexpr double kDriftError_mm = 0.5;  // 1.25 px in the mean, at a focal length of 60 px and some 50 mm
constexpr double kDistances_mm = 0.5;   // of the drift, for the points are not all 52 mm away
constexpr int kFrames = 6;

Status AddFrame(int frame_idx, std::vector<TrackedPoint> points, const cv::Mat& depth_mm,
                MaterialErrorCollector* collector, int submap = 0) {
  for (TrackedPoint& point : points) point.surface = LookUpDepth(depth_mm, point.pixel, 0.05);
  return collector->AddFrame(frame_idx, submap, points);
}

// Points that start at `first` in frame 0 and are tracked `slide_px` a frame beside their material; estimates are the
// true surface under the tracked pixel divided by `scale`.
Status AddFrames(const TruthSequence& sequence, const WallMaterial& wall, const std::vector<Eigen::Vector2d>& first,
                 const Eigen::Vector2d& slide_px, double scale, MaterialErrorCollector* collector) {
  for (int frame_idx = 0; frame_idx < kFrames; ++frame_idx) {
    std::vector<TrackedPoint> points;
    for (std::size_t i = 0; i < first.size(); ++i) {
      const Eigen::Vector2d pixel = WallMaterial::PixelIn(frame_idx, 0, first[i]) + frame_idx * slide_px;
      points.push_back({PointId{static_cast<int>(i)}, pixel, wall.PointIn(frame_idx, pixel) / scale});
    }
    if (Status status = AddFrame(frame_idx, points, **sequence.Depth(frame_idx), collector); !status.ok())
      return status;
  }
  return Status::Ok();
}

class MaterialErrorTest : public testing::Test {
 protected:
  Result<MaterialError> Compute(const std::vector<Eigen::Vector2d>& first, const Eigen::Vector2d& slide_px,
                                double scale) {
    MaterialErrorCollector collector(wall_, sequence_.camera());
    if (Status status = AddFrames(sequence_, wall_, first, slide_px, scale, &collector); !status.ok()) return status;
    return collector.Compute({});
  }

  TruthSequence sequence_{kFrames};
  WallMaterial wall_{sequence_};
  std::vector<Eigen::Vector2d> pixels_ = {{10, 10}, {30.5, 12.25}, {20, 30}, {40, 20.75}};
};

TEST_F(MaterialErrorTest, IsZeroForPointsThatStayOnTheirMaterial) {
  const auto error = Compute(pixels_, {0, 0}, 2);
  ASSERT_TRUE(error.ok()) << error.status().message();
  EXPECT_LT(error->error.plain.estimate.pooled_rmse_mm, kLengthRoundOff_mm);
  EXPECT_NEAR(error->error.plain.estimate.max_scale, 2, kLengthRoundOff_mm);
  EXPECT_GT(error->error.plain.null.pooled_rmse_mm, kNotFlat_mm);
  EXPECT_LT(error->drift.rmse_px, kLengthRoundOff_mm);
  EXPECT_LT(error->drift.rmse_mm, kLengthRoundOff_mm);
  EXPECT_EQ(error->tracks, 4);
  EXPECT_EQ(error->error.points, 4 * kFrames);
}

TEST_F(MaterialErrorTest, TheScaleOfAllFramesIsThatOfTheirSubmap) {
  MaterialErrorCollector collector(wall_, sequence_.camera());
  for (int frame_idx = 0; frame_idx < kFrames; ++frame_idx) {
    const int submap = frame_idx < kFrames / 2 ? 0 : 1;
    std::vector<TrackedPoint> points;
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      const Eigen::Vector2d pixel = WallMaterial::PixelIn(frame_idx, 0, pixels_[i]);
      points.push_back(
          {PointId{static_cast<int>(i)}, pixel, wall_.PointIn(frame_idx, pixel) / (submap == 0 ? 2.0 : 3.0)});
    }
    ASSERT_TRUE(AddFrame(frame_idx, points, **sequence_.Depth(frame_idx), &collector, submap).ok());
  }
  PointErrorOptions options;
  options.scale = ErrorScale::kGlobal;
  const auto error = collector.Compute(options);
  ASSERT_TRUE(error.ok()) << error.status().message();
  EXPECT_LT(error->error.plain.estimate.pooled_rmse_mm, kLengthRoundOff_mm);
}

// They are on the surface all the time: the surface error is none, the material error is all drift.
TEST_F(MaterialErrorTest, TellsDriftAlongTheSurfaceFromShape) {
  const Eigen::Vector2d slide_px(0.3, 0.4);
  const auto error = Compute(pixels_, slide_px, 1);
  ASSERT_TRUE(error.ok());
  EXPECT_GT(error->error.plain.estimate.pooled_rmse_mm, kDriftError_mm);
  ASSERT_EQ(error->frames.size(), static_cast<std::size_t>(kFrames));
  for (int i = 0; i < kFrames; ++i) {
    EXPECT_NEAR(error->frames[static_cast<std::size_t>(i)].drift.median_px, 0.5 * i, kLengthRoundOff_mm);
    EXPECT_NEAR(error->frames[static_cast<std::size_t>(i)].drift.rmse_px, 0.5 * i, kLengthRoundOff_mm);
  }
  // 0.5 px a frame at a focal length of 60 px and some 50 mm.
  EXPECT_NEAR(error->frames.back().drift.median_mm, 2.5 / 60 * 52, kDistances_mm);
  EXPECT_NEAR(error->drift.median_px, 1.25, kLengthRoundOff_mm);
  // Points that stay put are off by the material's own motion, (0.5, 0.25) px a frame.
  EXPECT_NEAR(error->drift.still_median_px, 2.5 * std::hypot(0.5, 0.25), kLengthRoundOff_mm);
}

TEST_F(MaterialErrorTest, CountsPointsTrackedWhoseMaterialHasLeftTheImage) {
  const auto error = Compute({{61.25, 20}, {20, 20}}, {-0.5, 0}, 1);  // the first leaves in truth after frame 3
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->outside_image, 2);
  EXPECT_EQ(error->tracks_outside_image, 1);
  EXPECT_EQ(error->frames[3].outside_image, 0);
  EXPECT_EQ(error->frames[4].outside_image, 1);
  EXPECT_EQ(error->occluded, 0);
}

TEST_F(MaterialErrorTest, LeavesOutTracksThatStartWhereThereIsNoMaterialPoint) {
  MaterialErrorCollector collector(wall_, sequence_.camera());
  cv::Mat_<float> step(48, 64, 50.0F);
  step(cv::Rect(32, 0, 32, 48)) = 60.0F;
  const auto at = [](int id, double u, double v) {
    return TrackedPoint{PointId{id}, {u, v}, Eigen::Vector3d(0, 0, 50)};
  };
  ASSERT_TRUE(AddFrame(0, {at(0, 31.5, 20), at(1, -1, 20), at(2, 10, 10)}, step, &collector).ok());
  // Where a track goes later does not matter.
  ASSERT_TRUE(AddFrame(1, {at(0, 10, 20), at(1, 10, 20), at(2, 31.5, 10)}, step, &collector).ok());
  const auto error = collector.Compute({});
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->error.points, 2);
  EXPECT_EQ(error->error.left_out.depth_step, 2);
  EXPECT_EQ(error->error.left_out.outside_image, 2);
  EXPECT_EQ(error->tracks, 1);
  EXPECT_EQ(error->drift.points_px, 2);
  EXPECT_EQ(error->drift.points_mm, 1);  // on the step there is no surface to drift along
}

// A point of the wall is followed by tracks 0 and 1 one after the other, by 2 while 0 lives, and found again by 3 after
// a gap.
TEST_F(MaterialErrorTest, CountsTracksThatGoOnWithOneThatEnded) {
  const Eigen::Vector2d start(20, 20);
  const auto at = [&](int frame_idx, int id, const Eigen::Vector2d& off) {
    const Eigen::Vector2d pixel = WallMaterial::PixelIn(frame_idx, 0, start) + off;
    return TrackedPoint{PointId{id}, pixel, wall_.PointIn(frame_idx, pixel)};
  };
  const Eigen::Vector2d none(0, 0);
  MaterialErrorCollector collector(wall_, sequence_.camera());
  const auto add = [&](int frame_idx, const std::vector<TrackedPoint>& points) {
    ASSERT_TRUE(AddFrame(frame_idx, points, **sequence_.Depth(frame_idx), &collector).ok());
  };
  add(0, {at(0, 0, none), at(0, 9, {20, 0})});
  add(1, {at(1, 0, none), at(1, 2, {1, 0})});  // 2 starts where 0 still is: another one
  add(2, {at(2, 1, {1.5, 0})});                // goes on with 0 or with 2
  add(3, {at(3, 4, {0, 2.5})});                // too far from all
  add(5, {at(5, 3, {0.5, 0})});                // goes on with the one that is left, or with 1
  const auto error = collector.Compute({});
  ASSERT_TRUE(error.ok()) << error.status().message();
  EXPECT_EQ(error->tracks, 6);
  EXPECT_EQ(error->continuing_tracks, 2);
}

TEST_F(MaterialErrorTest, NeedsATrackWithAMaterialPoint) {
  MaterialErrorCollector collector(wall_, sequence_.camera());
  EXPECT_EQ(collector.Compute({}).status().code(), ErrorCode::kInsufficient);
}

}  // namespace
}  // namespace pliant
