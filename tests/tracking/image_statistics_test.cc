// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/tracks/image_statistics.h"

#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "photometric/synthetic_texture.h"
#include "pliant/base/random.h"
#include "pliant/tracking/tracks/trackability.h"

namespace pliant {
namespace {

constexpr double kNoiseError = 0.1;        // relative
constexpr double kNoiselessLevels = 0.35;  // gray levels: that of an image without noise
constexpr double kTrackNoise = 0.1;        // relative; 500 tracks fix the deviation to 1 %
constexpr double kExact_px = 1e-9;

cv::Mat NoisyField(double sigma) {
  Random random(3);
  cv::Mat gray(200, 300, CV_8UC1);
  for (int y = 0; y < gray.rows; ++y)
    for (int x = 0; x < gray.cols; ++x)
      gray.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(60 + 0.3 * x + 0.2 * y + random.Normal(sigma));
  return gray;
}

TEST(ImageNoise, IsTheDeviationOfWhiteNoise) {
  for (const double sigma : {1.0, 3.0, 8.0}) EXPECT_NEAR(ImageNoise(NoisyField(sigma), {}) / sigma, 1.0, kNoiseError);
}

TEST(ImageNoise, IsThatOfRoundingWhereThereIsNone) {
  EXPECT_LT(ImageNoise(NoisyField(0), {}), kNoiselessLevels);
  const SyntheticTexture texture(2);
  EXPECT_LT(ImageNoise(texture.Render({200, 150}, [](cv::Point2d p) { return p; }), {}), kNoiselessLevels);
}

TEST(ImageNoise, LeavesOutWhatIsMaskedOrSaturated) {
  cv::Mat gray = NoisyField(3);
  cv::Mat valid(gray.size(), CV_8UC1, cv::Scalar(255));
  Random random(8);
  for (int y = 0; y < gray.rows; ++y) {
    for (int x = 0; x < 200; ++x) {
      if (x < 100) {
        gray.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(random.Index(250) + 2);
        valid.at<std::uint8_t>(y, x) = 0;
      } else {
        gray.at<std::uint8_t>(y, x) = 255;
      }
    }
  }
  EXPECT_NEAR(ImageNoise(gray, valid) / 3, 1.0, kNoiseError);
  EXPECT_EQ(ImageNoise(gray, cv::Mat::zeros(gray.size(), CV_8UC1)), 0.0);
}

// Tracks all over an image that moves smoothly, with known noise.
std::vector<std::vector<Eigen::Vector2d>> NoisyTracks(double sigma_px, double bad_share) {
  Random random(5);
  std::vector<std::vector<Eigen::Vector2d>> tracks;
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector2d start(random.Uniform(0, 640), random.Uniform(0, 480));
    const bool bad = random.Uniform() < bad_share;
    std::vector<Eigen::Vector2d> track;
    for (int k = 0; k < kStatisticsRunFrames; ++k) {
      // Accelerated, and with a zoom.
      Eigen::Vector2d pixel = start * (1 + 0.01 * k) + Eigen::Vector2d(0.8 * k * k, -3.0 * k);
      const double sigma = bad ? 20 * sigma_px : sigma_px;
      pixel += Eigen::Vector2d(random.Normal(sigma), random.Normal(sigma));
      track.push_back(pixel);
    }
    if (i % 3 == 0) track.resize(1 + static_cast<std::size_t>(random.Index(kStatisticsRunFrames)));
    tracks.push_back(std::move(track));
  }
  return tracks;
}

TEST(TrackNoise, IsTheDeviationOfTheTracks) {
  for (const double sigma_px : {0.03, 0.2, 1.0})
    EXPECT_NEAR(TrackNoise(TrackResiduals(NoisyTracks(sigma_px, 0))) / sigma_px, 1.0, kTrackNoise);
}

TEST(TrackNoise, OfCommonMotionIsNothingAndOfAFewBadTracksLittle) {
  EXPECT_NEAR(TrackNoise(TrackResiduals(NoisyTracks(0, 0))), 0.0, kExact_px);
  EXPECT_NEAR(TrackNoise(TrackResiduals(NoisyTracks(0.2, 0.05))) / 0.2, 1.0, 2 * kTrackNoise);
}

TEST(TrackNoise, NeedsThirteenTracks) {
  auto tracks = NoisyTracks(0.2, 0);
  std::erase_if(tracks, [](const auto& track) { return track.size() < kStatisticsRunFrames; });
  tracks.resize(12);
  EXPECT_TRUE(TrackResiduals(tracks).empty());
  EXPECT_EQ(TrackNoise({}), 0.0);
}

std::vector<PreparedFrame> MovingFrames(int count, double noise) {
  const SyntheticTexture texture(5);
  std::vector<PreparedFrame> frames;
  for (int k = 0; k < count; ++k) {
    const cv::Mat image = texture.Render(
        {260, 200}, [&](cv::Point2d p) { return cv::Point2d(p.x + 0.7 * k, p.y - 0.4 * k); }, 1, 0, noise, 100 + k);
    frames.push_back(PrepareFrame(k, "", k / 30.0, image, {}, {}));
  }
  return frames;
}

TEST(MeasureImageStatistics, TellsNoiseAndItsEffectOnTracks) {
  const ImageStatistics clean = MeasureImageStatistics(MovingFrames(20, 0), {}, 2);
  const ImageStatistics noisy = MeasureImageStatistics(MovingFrames(20, 6), {}, 2);
  EXPECT_EQ(clean.frames, 20);
  EXPECT_LT(clean.noise_levels, kNoiselessLevels);
  EXPECT_NEAR(noisy.noise_levels / 6, 1.0, kNoiseError);
  EXPECT_GT(clean.corners, 20);
  EXPECT_GE(clean.alive_after_1, clean.alive_after_9);
  EXPECT_GT(clean.alive_after_9, 0.5);  // some leave the image
  EXPECT_GT(noisy.track_noise_px, 2 * clean.track_noise_px);
}

TEST(MeasureImageStatistics, DoesNotDependOnThreadsAndCountsAsTrackabilityDoes) {
  const std::vector<PreparedFrame> frames = MovingFrames(kStatisticsRunFrames, 4);
  const ImageStatistics one = MeasureImageStatistics(frames, {}, 1);
  const ImageStatistics four = MeasureImageStatistics(frames, {}, 4);
  EXPECT_EQ(one.track_noise_px, four.track_noise_px);
  EXPECT_EQ(one.alive_after_9, four.alive_after_9);
  const Trackability counts = MeasureTrackability(frames, {}, 2);
  EXPECT_EQ(one.corners, counts.corners);
  EXPECT_EQ(one.alive_after_9 * one.corners, counts.alive);
}

TEST(Trackability, ExactTracksTellMoreThanMany) {
  const std::vector<Trackability> few{{.corners = 500, .alive = 100, .tracks = NoisyTracks(0.1, 0)}};
  const std::vector<Trackability> many{{.corners = 500, .alive = 150, .tracks = NoisyTracks(0.15, 0)}};
  const double of_few = TrackInformation(few, 1);
  EXPECT_GT(of_few, TrackInformation(many, 1));
  EXPECT_NEAR(of_few * (0.1 * 0.1 + 0.01 * 0.01) / few.front().alive, 1.0, 2 * kTrackNoise);
  // The same pixels of an image of twice the size are half as many of the source.
  EXPECT_NEAR(TrackInformation(few, 2) / of_few, 4.0, 0.2);
  EXPECT_NEAR(TrackInformation(std::vector<Trackability>{few.front(), few.front()}, 1) / of_few, 2.0, 1e-9);
  EXPECT_EQ(TrackInformation({}, 1), 0.0);
}

TEST(Trackability, OfImagesThatRepeatIsFinite) {
  const std::vector<PreparedFrame> one = MovingFrames(1, 0);
  const std::vector<PreparedFrame> still(5, one.front());
  const std::vector<Trackability> runs{MeasureTrackability(still, {}, 1)};
  EXPECT_TRUE(std::isfinite(TrackInformation(runs, 1)));
}

TEST(MeasureImageStatistics, IsNothingForTooFewFrames) {
  EXPECT_EQ(MeasureImageStatistics(MovingFrames(kStatisticsRunFrames - 1, 0), {}, 1).frames, 0);
}

}  // namespace
}  // namespace pliant
