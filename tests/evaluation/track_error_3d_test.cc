// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/track_error_3d.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/tolerances.h"

namespace pliant {
namespace {

using testing::HasSubstr;

constexpr int kFramesInSpace = 6;
// In an image whose smaller side has 256 px: sqrt(400 * 625) * 256 / 512.
constexpr double kScoredFocal_px = 250;
constexpr double kFewPoints = 0.1;  // share of the tilted wall that is near one depth

Camera TallCamera() { return Camera::Create("PINHOLE", 512, 640, std::vector<double>{400, 625, 255.5, 319.5}).value(); }

// A tilted wall that moves sideways, by kStep a frame. It is hidden in the frames that are said, and not there at all
// left of the image.
class TiltedWall final : public MaterialTruth {
 public:
  explicit TiltedWall(std::set<int> hidden = {}) : hidden_(std::move(hidden)) {}

  // Where the point is in a frame that is at a pixel in frame `first`.
  static Eigen::Vector3d At(int first, const Eigen::Vector2d& pixel, int frame_idx) {
    const Eigen::Vector3d ray = *TallCamera().Unproject(pixel);
    const double depth = 40 + pixel.x() / 16;
    return depth * ray / ray.z() + (frame_idx - first) * kStep;
  }

  Result<std::vector<std::optional<MaterialId>>> PointsAt(int frame_idx,
                                                          std::span<const Eigen::Vector2d> pixels) override {
    std::vector<std::optional<MaterialId>> ids;
    for (const Eigen::Vector2d& pixel : pixels) {
      ids.emplace_back();
      if (pixel.x() < 0) continue;
      ids.back() = MaterialId{static_cast<std::int64_t>(starts_.size())};
      starts_.emplace_back(frame_idx, pixel);
    }
    return ids;
  }
  Result<std::vector<std::optional<MaterialState>>> Observe(int frame_idx,
                                                            std::span<const MaterialId> points) override {
    std::vector<std::optional<MaterialState>> states;
    for (const MaterialId id : points) {
      const auto& [first, pixel] = starts_[static_cast<std::size_t>(id.value)];
      MaterialState state{At(first, pixel, frame_idx), std::nullopt, MaterialVisibility::kVisible};
      state.pixel = TallCamera().Project(state.point_in_cam);
      if (hidden_.contains(frame_idx)) state.visibility = MaterialVisibility::kOccluded;
      states.emplace_back(state);
    }
    return states;
  }

 private:
  inline static const Eigen::Vector3d kStep{0.4, 0.2, 0};  // mm
  std::set<int> hidden_;
  std::vector<std::pair<int, Eigen::Vector2d>> starts_;
};

// The true track of what is at a pixel in frame `first`, to the end.
Track3d WallTrack(int first, const Eigen::Vector2d& pixel) {
  Track3d track;
  for (int frame_idx = first; frame_idx < kFramesInSpace; ++frame_idx) {
    const Eigen::Vector3d point_in_cam = TiltedWall::At(first, pixel, frame_idx);
    track.points.push_back({frame_idx, *TallCamera().Project(point_in_cam), point_in_cam});
  }
  return track;
}

std::vector<Track3d> WallTracks() {
  std::vector<Track3d> tracks;
  for (const double x : {20, 130, 250, 370, 490}) tracks.push_back(WallTrack(0, {x, 300}));
  return tracks;
}

std::vector<Track3d> Scaled(std::vector<Track3d> tracks, double factor) {
  for (Track3d& track : tracks)
    for (TrackPoint3d& point : track.points) point.point_in_cam *= factor;
  return tracks;
}

Result<TrackError3d> ErrorInSpace(const std::vector<Track3d>& tracks, std::set<int> hidden = {},
                                  ErrorScale scale = ErrorScale::kGlobal) {
  std::vector<int> frames(kFramesInSpace);
  std::iota(frames.begin(), frames.end(), 0);
  TiltedWall truth(std::move(hidden));
  return ComputeTrackError3d(tracks, frames, TallCamera(), truth, scale);
}

TEST(TrackError3d, TrueTracksArePerfectAtAnyScale) {
  for (const double scale : {1.0, 7.0}) {
    const auto error = ErrorInSpace(Scaled({WallTrack(0, {100, 300}), WallTrack(3, {400, 200})}, 1 / scale));
    ASSERT_TRUE(error.ok()) << error.status().message();
    EXPECT_EQ(error->tracks, 2);
    EXPECT_EQ(error->without_truth, 0);
    EXPECT_EQ(error->points, 6 + 3);  // the first frame of a track counts: its depth is not given
    EXPECT_EQ(error->visible, 6 + 3);
    EXPECT_NEAR(error->scale, scale, kRoundOff * scale * scale);
    EXPECT_NEAR(error->average_within, 1, kRoundOff);
    EXPECT_NEAR(error->average_jaccard, 1, kRoundOff);
    EXPECT_EQ(error->occlusion_accuracy, 1);
    EXPECT_NEAR(error->median_mm, 0, kLengthRoundOff_mm);
  }
}

TEST(TrackError3d, DistancesArePixelsAtTheTrueDepthInAnImageOf256Pixels) {
  Track3d track = WallTrack(0, {256, 300});
  const std::vector<double> off_px = {0, 0.9, 1.1, 7.9, 8.1, 17};
  for (std::size_t i = 0; i < off_px.size(); ++i) {
    Eigen::Vector3d& point = track.points[i].point_in_cam;
    point.z() += off_px[i] * point.z() / kScoredFocal_px;
  }
  const auto error = ErrorInSpace({track}, {}, ErrorScale::kNone);
  ASSERT_TRUE(error.ok());
  EXPECT_THAT(error->within, testing::ElementsAre(2 / 6.0, 3 / 6.0, 3 / 6.0, 4 / 6.0, 5 / 6.0));
  EXPECT_NEAR(error->average_within, 17 / 30.0, kRoundOff);
  // At 1 px: two true positives, four false ones, six visible.
  EXPECT_NEAR(error->jaccard[0], 2 / 10.0, kRoundOff);
  EXPECT_NEAR(error->jaccard[4], 5 / 7.0, kRoundOff);
}

TEST(TrackError3d, ARunLostInHalfOfTheFramesMissesItsPointsThere) {
  std::vector<Track3d> tracks = WallTracks();
  for (Track3d& track : tracks) std::erase_if(track.points, [](const auto& p) { return p.frame_idx % 2 == 1; });
  const auto error = ErrorInSpace(tracks);
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->visible, 30);
  EXPECT_NEAR(error->average_within, 0.5, kRoundOff);
  EXPECT_NEAR(error->average_jaccard, 0.5, kRoundOff);
  EXPECT_EQ(error->occlusion_accuracy, 0.5);
}

TEST(TrackError3d, AVisiblePointWhoseTrackHasEndedIsMissed) {
  std::vector<Track3d> tracks = WallTracks();
  tracks[0].points.resize(2);
  const auto error = ErrorInSpace(tracks);
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->visible, 30);
  EXPECT_NEAR(error->average_within, 26 / 30.0, kRoundOff);
  EXPECT_NEAR(error->average_jaccard, 26 / 30.0, kRoundOff);
}

TEST(TrackError3d, APointSeenWhereItIsHiddenIsAFalsePositive) {
  const auto error = ErrorInSpace(WallTracks(), {2});
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->points, 30);
  EXPECT_EQ(error->visible, 25);
  EXPECT_NEAR(error->average_within, 1, kRoundOff);
  EXPECT_NEAR(error->average_jaccard, 25 / 30.0, kRoundOff);
  EXPECT_NEAR(error->occlusion_accuracy, 25 / 30.0, kRoundOff);
}

TEST(TrackError3d, AMissingPointThatIsHiddenIsRight) {
  std::vector<Track3d> tracks = WallTracks();
  for (Track3d& track : tracks) std::erase_if(track.points, [](const auto& p) { return p.frame_idx == 2; });
  const auto error = ErrorInSpace(tracks, {2});
  ASSERT_TRUE(error.ok());
  EXPECT_NEAR(error->average_jaccard, 1, kRoundOff);
  EXPECT_EQ(error->occlusion_accuracy, 1);
}

TEST(TrackError3d, OneConstantDepthIsTheNull) {
  std::vector<Track3d> tracks = WallTracks();
  const auto perfect = ErrorInSpace(tracks);
  for (Track3d& track : tracks)
    for (TrackPoint3d& point : track.points) point.point_in_cam /= point.point_in_cam.z();
  const auto flat = ErrorInSpace(tracks);
  ASSERT_TRUE(perfect.ok() && flat.ok());
  EXPECT_LT(flat->average_within, kFewPoints);
  EXPECT_LT(flat->average_jaccard, flat->average_within);
  for (const TrackScores& null : {flat->null, perfect->null}) {
    EXPECT_NEAR(null.average_within, flat->average_within, kRoundOff);
    EXPECT_NEAR(null.average_jaccard, flat->average_jaccard, kRoundOff);
  }
}

TEST(TrackError3d, TheScaleIsTheQuotientOfTheMedians) {
  const std::vector<double> factors = {1.0 / 4, 1.0 / 8, 1};  // the median of the quotients is 4
  std::vector<Track3d> tracks;
  std::vector<double> distances;
  for (const double factor : factors) {
    const Eigen::Vector2d pixel(100 + 150 * static_cast<double>(tracks.size()), 320);
    Eigen::Vector3d& point = tracks.emplace_back(WallTrack(kFramesInSpace - 1, pixel)).points.front().point_in_cam;
    distances.push_back(point.norm());
    point *= factor;
  }
  ASSERT_TRUE(std::ranges::is_sorted(distances));
  const auto error = ErrorInSpace(tracks);
  ASSERT_TRUE(error.ok());
  EXPECT_NEAR(error->scale, distances[1] / (distances[0] / 4), kRoundOff);
}

TEST(TrackError3d, WhatClaimsMillimetersIsNotScaled) {
  const auto error = ErrorInSpace(Scaled(WallTracks(), 2), {}, ErrorScale::kNone);
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->scale, 1);
  EXPECT_EQ(error->average_within, 0);
  EXPECT_GT(error->null.average_within, 0);  // it gets its best depth all the same
}

TEST(TrackError3d, APointThatIsNoNumberIsNotNear) {
  std::vector<Track3d> tracks = WallTracks();
  tracks[0].points[3].point_in_cam.x() = std::nan("");
  const auto error = ErrorInSpace(tracks);
  ASSERT_TRUE(error.ok());
  EXPECT_NEAR(error->scale, 1, kRoundOff);
  EXPECT_NEAR(error->average_within, 29 / 30.0, kRoundOff);
  EXPECT_NEAR(error->average_jaccard, 29 / 31.0, kRoundOff);
}

TEST(TrackError3d, TracksWithoutTruthAreLeftOut) {
  const Track3d nowhere{{{0, {-1, 5}, {0, 0, 50}}}};
  const auto error = ErrorInSpace({WallTrack(0, {100, 300}), nowhere});
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->tracks, 1);
  EXPECT_EQ(error->without_truth, 1);
  EXPECT_EQ(error->points, 6);
  const auto none = ErrorInSpace({nowhere});
  EXPECT_EQ(none.status().code(), ErrorCode::kInsufficient);
  EXPECT_THAT(none.status().message(), HasSubstr("none of the 1 tracks in space"));
}

}  // namespace
}  // namespace pliant
