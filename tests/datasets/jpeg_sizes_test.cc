// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/jpeg_sizes.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace pliant {
namespace {

using Bytes = std::vector<unsigned char>;

// Noise, so that its coded pixels hold all kinds of bytes.
Bytes Jpeg(int width, int height) {
  cv::Mat image(height, width, CV_8UC3);
  cv::randu(image, 0, 256);
  Bytes bytes;
  cv::imencode(".jpg", image, bytes);
  return bytes;
}

// `image` with another one in its head, as cameras store previews.
Bytes WithThumbnail(const Bytes& image, const Bytes& thumbnail) {
  Bytes both = {image[0], image[1], 0xFF, 0xE1};
  const std::size_t length = 2 + thumbnail.size();
  both.push_back(static_cast<unsigned char>(length >> 8));
  both.push_back(static_cast<unsigned char>(length & 0xFF));
  both.insert(both.end(), thumbnail.begin(), thumbnail.end());
  both.insert(both.end(), image.begin() + 2, image.end());
  return both;
}

void Append(Bytes* to, const Bytes& bytes) { to->insert(to->end(), bytes.begin(), bytes.end()); }

// In pieces of so many bytes.
std::size_t CountInPieces(const Bytes& bytes, std::size_t piece, JpegSizes* sizes) {
  std::size_t counted = 0;
  for (std::size_t at = 0; at < bytes.size() && !sizes->change(); at += piece) {
    const std::span<const unsigned char> all(bytes);
    counted += sizes->BytesBeforeChange(all.subspan(at, std::min(piece, bytes.size() - at)));
  }
  return counted;
}

TEST(JpegSizes, FindsTheFirstImageOfAnotherSize) {
  Bytes same;
  for (int k = 0; k < 3; ++k) Append(&same, Jpeg(64, 48));
  Bytes all = same;
  Append(&all, Jpeg(80, 40));
  Append(&all, Jpeg(64, 48));
  for (const std::size_t piece : {all.size(), std::size_t{1000}}) {
    JpegSizes sizes;
    EXPECT_LE(CountInPieces(all, piece, &sizes), same.size());
    ASSERT_TRUE(sizes.change().has_value()) << piece;
    EXPECT_EQ(sizes.change()->from, cv::Size(64, 48));
    EXPECT_EQ(sizes.change()->to, cv::Size(80, 40));
    EXPECT_EQ(sizes.change()->images, 3);
    EXPECT_EQ(sizes.BytesBeforeChange(same), 0U);
  }
  JpegSizes at_once;
  EXPECT_EQ(at_once.BytesBeforeChange(all), same.size());
  JpegSizes byte_by_byte;
  CountInPieces(all, 1, &byte_by_byte);
  EXPECT_EQ(byte_by_byte.change()->images, 3);
}

TEST(JpegSizes, AThumbnailIsNoImage) {
  const Bytes image = WithThumbnail(Jpeg(64, 48), Jpeg(16, 12));
  Bytes all = image;
  Append(&all, image);
  JpegSizes sizes;
  EXPECT_EQ(CountInPieces(all, 777, &sizes), all.size());
  EXPECT_FALSE(sizes.change().has_value());
}

TEST(JpegSizes, OtherStreamsAreLeftAlone) {
  Bytes all = {'Y', 'U', 'V', '4'};
  Append(&all, Jpeg(64, 48));
  Append(&all, Jpeg(80, 40));
  JpegSizes sizes;
  EXPECT_EQ(sizes.BytesBeforeChange(all), all.size());
  EXPECT_FALSE(sizes.change().has_value());
}

TEST(JpegSizes, ADamagedImageIsPassedOver) {
  Bytes damaged = Jpeg(64, 48);
  damaged[2] = 0;  // no marker behind the first one
  Bytes all = damaged;
  Append(&all, Jpeg(64, 48));
  JpegSizes sizes;
  EXPECT_EQ(sizes.BytesBeforeChange(all), all.size());
  Append(&all, Jpeg(80, 40));
  JpegSizes again;
  again.BytesBeforeChange(all);
  ASSERT_TRUE(again.change().has_value());
  EXPECT_EQ(again.change()->images, 1);
}

}  // namespace
}  // namespace pliant
