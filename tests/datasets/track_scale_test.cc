// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/track_scale.h"

#include <cstdint>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "datasets/opened_sequence.h"
#include "pliant/datasets/sequence_tracks.h"

namespace pliant {
namespace {

using testing::HasSubstr;

constexpr int kFilmWidth = 320;
constexpr int kFilmHeight = 240;
constexpr int kFilmFrames = 61;
const cv::Point2d kMotion_px{0.9, 0.8};  // from one frame to the next

// A texture of blobs of a few pixels that moves past the camera.
cv::Mat TextureAt(int frame_idx) {
  cv::Mat noise(2 * kFilmHeight, 2 * kFilmWidth, CV_8UC1);
  cv::RNG random(11);
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(noise, noise, {}, 2.0);
  cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
  cv::Mat image;
  const cv::Point2d center(kFilmWidth - kMotion_px.x * frame_idx, kFilmHeight - kMotion_px.y * frame_idx);
  cv::getRectSubPix(noise, {kFilmWidth, kFilmHeight}, center, image);
  return image;
}

// By frame, every fifth.
std::map<int, cv::Mat> Film(const std::function<cv::Mat(int)>& image_at) {
  std::map<int, cv::Mat> film;
  for (int frame_idx = 0; frame_idx < kFilmFrames; frame_idx += 5) film.emplace(frame_idx, image_at(frame_idx));
  return film;
}

// Points of the texture on a grid, in images resized to this size.
std::vector<PixelTrack> Followed(double width, double height) {
  std::vector<PixelTrack> tracks;
  for (int k = 0; k < 108; ++k) {
    PixelTrack track{PointId{k}, {}};
    for (int frame_idx = 0; frame_idx < kFilmFrames; ++frame_idx) {
      const cv::Point2d at = cv::Point2d(cv::Point(20 + 20 * (k % 12), 15 + 20 * (k / 12))) + frame_idx * kMotion_px;
      track.pixels.push_back(
          {frame_idx, {(at.x + 0.5) * width / kFilmWidth - 0.5, (at.y + 0.5) * height / kFilmHeight - 0.5}});
    }
    tracks.push_back(track);
  }
  return tracks;
}

TEST(TrackScale, OfAnotherSizeIsFoundOnEachAxis) {
  const auto film = Film(TextureAt);
  for (const auto& [width, height] :
       {std::pair(256, 192), std::pair(256, 256), std::pair(400, 300), std::pair(kFilmWidth, 160)}) {
    const auto scale = FindOtherTrackScale(Followed(width, height), film);
    ASSERT_TRUE(scale.has_value()) << width << "x" << height;
    EXPECT_EQ(scale->width, width);
    EXPECT_EQ(scale->height, height);
    EXPECT_TRUE(scale->is_clear);
    EXPECT_GT(scale->correlation, 0.9);  // the same texture, between pixels
  }
}

TEST(TrackScale, OfTheImagesIsRight) {
  const std::vector<PixelTrack> tracks = Followed(kFilmWidth, kFilmHeight);
  const auto noisy = [](int frame_idx) {
    cv::Mat image = TextureAt(frame_idx);
    cv::Mat noise(image.size(), CV_8UC1);
    cv::RNG random(static_cast<std::uint64_t>(frame_idx) + 1);
    random.fill(noise, cv::RNG::NORMAL, 128, 60);
    cv::addWeighted(image, 1, noise, 1, -128, image);
    return image;
  };
  const auto blurred = [](int frame_idx) {
    cv::Mat image = TextureAt(frame_idx);
    cv::GaussianBlur(image, image, {}, 6.0);
    return image;
  };
  EXPECT_FALSE(FindOtherTrackScale(tracks, Film(TextureAt)).has_value());
  EXPECT_FALSE(FindOtherTrackScale(tracks, Film(noisy)).has_value());
  EXPECT_FALSE(FindOtherTrackScale(tracks, Film(blurred)).has_value());
}

TEST(TrackScale, IsNotKnownOfImagesThatDoNotTell) {
  const auto still = [](int) { return TextureAt(0); };
  const auto flat = [](int frame_idx) { return cv::Mat(kFilmHeight, kFilmWidth, CV_8UC1, cv::Scalar(2 * frame_idx)); };
  for (const double size : {1.0, 0.8}) {
    const std::vector<PixelTrack> moving = Followed(size * kFilmWidth, size * kFilmHeight);
    EXPECT_FALSE(FindOtherTrackScale(moving, Film(still)).has_value());
    EXPECT_FALSE(FindOtherTrackScale(moving, Film(flat)).has_value());
    std::vector<PixelTrack> resting = moving;
    for (PixelTrack& track : resting)
      for (TrackPixel& seen : track.pixels) seen.pixel = track.pixels.front().pixel;
    EXPECT_FALSE(FindOtherTrackScale(resting, Film(still)).has_value());
  }
  EXPECT_FALSE(FindOtherTrackScale({}, {}).has_value());
}

class TrackScaleOfSequence : public OpenSequenceTest {};

TEST_F(TrackScaleOfSequence, IsRefusedWithTheFactorsWhereItIsAnother) {
  Text("camera.yaml", "model: PINHOLE\nwidth: 320\nheight: 240\nparams: [300, 300, 159.5, 119.5]\nfps: 20\nunit: mm\n");
  for (int frame_idx = 0; frame_idx < kFilmFrames; ++frame_idx)
    Write("images/" + Name(frame_idx), TextureAt(frame_idx));
  const auto read = [&](double width, double height) {
    std::ofstream file(Path("tracks.csv"));
    file << "frame,track_id,u_px,v_px\n";
    for (const PixelTrack& track : Followed(width, height))
      for (const TrackPixel& seen : track.pixels)
        file << seen.frame_idx << ',' << track.id.value << ',' << seen.pixel.x() << ',' << seen.pixel.y() << '\n';
    file.close();
    return ReadTracksOfSequence({.path = Path("tracks.csv").string()}, Request()).status();
  };
  EXPECT_TRUE(read(kFilmWidth, kFilmHeight).ok());
  const Status status = read(256, 192);
  EXPECT_EQ(status.code(), ErrorCode::kMismatch);
  EXPECT_THAT(status.message(), HasSubstr("fit images of about 256x192 pixels, not these of 320x240"));
  EXPECT_THAT(status.message(), HasSubstr("multiply x by about 1.250 and y by 1.250"));
}

}  // namespace
}  // namespace pliant
