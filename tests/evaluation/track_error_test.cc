// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/track_error.h"

#include <numeric>
#include <set>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/tolerances.h"

namespace pliant {
namespace {

using testing::HasSubstr;

constexpr int kTrackFrames = 5;

// Images of twice the scored size: a pixel of the image is half a scored one, each way.
Camera TwiceTheScoredSize() {
  return Camera::Create("PINHOLE", 512, 512, std::vector<double>{500, 500, 255.5, 255.5}).value();
}

// Every point moves by (2, 1) px a frame, and is hidden in the frames that are said.
class MovingMaterial final : public MaterialTruth {
 public:
  explicit MovingMaterial(std::set<int> hidden = {}) : hidden_(std::move(hidden)) {}

  static Eigen::Vector2d At(int frame_idx) { return {100.0 + 2 * frame_idx, 50.0 + frame_idx}; }

  Result<std::vector<std::optional<MaterialId>>> PointsAt(int frame_idx,
                                                          std::span<const Eigen::Vector2d> pixels) override {
    std::vector<std::optional<MaterialId>> ids;
    for (const Eigen::Vector2d& pixel : pixels) {
      ids.emplace_back();
      if (pixel.x() < 0) continue;  // nothing is seen there
      ids.back() = MaterialId{static_cast<std::int64_t>(offsets_.size())};
      offsets_.emplace_back(pixel - At(frame_idx));
    }
    return ids;
  }
  Result<std::vector<std::optional<MaterialState>>> Observe(int frame_idx,
                                                            std::span<const MaterialId> points) override {
    std::vector<std::optional<MaterialState>> states;
    for (const MaterialId id : points) {
      MaterialState state{Eigen::Vector3d(0, 0, 50), At(frame_idx) + offsets_[static_cast<std::size_t>(id.value)],
                          MaterialVisibility::kVisible};
      if (hidden_.contains(frame_idx)) state.visibility = MaterialVisibility::kOccluded;
      states.emplace_back(state);
    }
    return states;
  }

 private:
  std::set<int> hidden_;
  std::vector<Eigen::Vector2d> offsets_;
};

// A track from frame `first` on, off its material by off_px[k] in its k-th later frame.
PixelTrack TrackOf(int id, int first, const std::vector<double>& off_px) {
  PixelTrack track{PointId{id}, {{first, MovingMaterial::At(first)}}};
  for (const double off : off_px) {
    const int frame_idx = track.pixels.back().frame_idx + 1;
    track.pixels.push_back({frame_idx, MovingMaterial::At(frame_idx) + Eigen::Vector2d(off, 0)});
  }
  return track;
}

Result<TrackError> Compute(const std::vector<PixelTrack>& tracks, std::set<int> hidden = {}) {
  std::vector<int> frames(kTrackFrames);
  std::iota(frames.begin(), frames.end(), 0);
  MovingMaterial truth(std::move(hidden));
  return ComputeTrackError(tracks, frames, TwiceTheScoredSize(), truth);
}

TEST(TrackError, TrueTracksArePerfect) {
  const auto error = Compute({TrackOf(0, 0, {0, 0, 0, 0}), TrackOf(1, 2, {0, 0})});
  ASSERT_TRUE(error.ok()) << error.status().message();
  EXPECT_EQ(error->tracks, 2);
  EXPECT_EQ(error->points, 4 + 2);
  EXPECT_EQ(error->visible, 4 + 2);
  EXPECT_NEAR(error->average_within, 1, kRoundOff);
  EXPECT_NEAR(error->average_jaccard, 1, kRoundOff);
  EXPECT_EQ(error->occlusion_accuracy, 1);
  EXPECT_EQ(error->survival, 1);
  EXPECT_EQ(error->median_px, 0);
}

TEST(TrackError, DistancesAreThoseOfImagesOf256Pixels) {
  // 1, 3, 10 and 40 px of the image are 0.5, 1.5, 5 and 20 scored ones.
  const auto error = Compute({TrackOf(0, 0, {1, 3, 10, 40})});
  ASSERT_TRUE(error.ok());
  EXPECT_THAT(error->within, testing::ElementsAre(0.25, 0.5, 0.5, 0.75, 0.75));
  EXPECT_NEAR(error->average_within, 0.55, kRoundOff);
  // At 1 px: one true positive, three false ones, four visible.
  EXPECT_NEAR(error->jaccard[0], 1.0 / 7, kRoundOff);
  EXPECT_NEAR(error->jaccard[4], 3.0 / 5, kRoundOff);
  EXPECT_EQ(error->survival, 1);
  EXPECT_EQ(error->median_px, 6.5);
}

TEST(TrackError, SeenWhereHiddenAndMissedWhereVisibleCountAgainstIt) {
  // Seen in frames 1 to 3, missing in 4; the truth is hidden in frame 2.
  const auto error = Compute({TrackOf(0, 0, {0, 0, 0})}, {2});
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->visible, 3);
  EXPECT_EQ(error->occlusion_accuracy, 0.5);
  EXPECT_NEAR(error->within[0], 2.0 / 3, kRoundOff);
  EXPECT_NEAR(error->jaccard[0], 2.0 / 4, kRoundOff);
  EXPECT_EQ(error->survival, 0.75);
}

TEST(TrackError, AHiddenPixelCountsForItsPositionAlone) {
  PixelTrack track = TrackOf(0, 0, {0, 0, 0, 0});
  track.pixels[1].visible = false;
  const auto error = Compute({track});
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->within[0], 1);
  EXPECT_EQ(error->jaccard[0], 0.75);
  EXPECT_EQ(error->occlusion_accuracy, 0.75);
  EXPECT_EQ(error->survival, 1);
}

TEST(TrackError, ATrackFailsWhenItIsFiftyPixelsOff) {
  const auto error = Compute({TrackOf(0, 0, {0, 99, 101, 0})});
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->survival, 0.5);
}

TEST(TrackError, TracksWithoutTruthAreLeftOut) {
  PixelTrack nowhere{PointId{1}, {{0, {-1, 5}}, {1, {-1, 5}}}};
  const auto error = Compute({TrackOf(0, 0, {0, 0, 0, 0}), nowhere, TrackOf(2, kTrackFrames - 1, {})});
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->tracks, 1);
  EXPECT_EQ(error->without_truth, 2);
  const auto none = Compute({nowhere});
  EXPECT_EQ(none.status().code(), ErrorCode::kInsufficient);
  EXPECT_THAT(none.status().message(), HasSubstr("none of the 1 tracks"));
}

}  // namespace
}  // namespace pliant
