// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/jpeg_images.h"

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
Bytes Jpeg(int width, int height, const std::vector<int>& options = {}) {
  cv::Mat image(height, width, CV_8UC3);
  cv::randu(image, 0, 256);
  Bytes bytes;
  cv::imencode(".jpg", image, bytes, options);
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

Bytes Joined(const std::vector<Bytes>& parts) {
  Bytes all;
  for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

Bytes FirstHalf(const Bytes& bytes) {
  return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2)};
}

std::vector<Bytes> TakeAll(JpegImages* jpegs) {
  std::vector<Bytes> images;
  while (auto image = jpegs->Take()) images.push_back(*std::move(image));
  return images;
}

// Of bytes that come in pieces of this size.
std::vector<Bytes> ImagesIn(const Bytes& bytes, std::size_t piece, JpegImages* jpegs) {
  for (std::size_t at = 0; at < bytes.size(); at += piece)
    jpegs->Add(std::span(bytes).subspan(at, std::min(piece, bytes.size() - at)));
  return TakeAll(jpegs);
}

TEST(JpegImages, AreFoundHoweverTheyAreCutIntoPieces) {
  const std::vector<Bytes> images = {Jpeg(64, 48), Jpeg(80, 40), Jpeg(64, 48, {cv::IMWRITE_JPEG_PROGRESSIVE, 1}),
                                     Jpeg(64, 48, {cv::IMWRITE_JPEG_RST_INTERVAL, 2})};
  for (const std::size_t piece : {std::size_t{1}, std::size_t{777}, std::size_t{1} << 20}) {
    JpegImages jpegs;
    EXPECT_EQ(ImagesIn(Joined(images), piece, &jpegs), images) << piece;
    EXPECT_EQ(jpegs.broken(), 0);
    EXPECT_FALSE(jpegs.IsWithinImage());
  }
}

TEST(JpegImages, OneIsThereWithItsLastByte) {
  const Bytes image = Jpeg(64, 48);
  JpegImages jpegs;
  jpegs.Add(std::span(image).first(image.size() - 1));
  EXPECT_TRUE(jpegs.IsWithinImage());
  EXPECT_FALSE(jpegs.Take());
  jpegs.Add(std::span(image).last(1));
  EXPECT_FALSE(jpegs.IsWithinImage());
  EXPECT_EQ(jpegs.Take(), image);
  EXPECT_FALSE(jpegs.Take());
}

TEST(JpegImages, WhatIsBetweenThemIsPassedOver) {
  const Bytes first = Jpeg(64, 48);
  const Bytes second = Jpeg(64, 48);
  JpegImages jpegs;
  EXPECT_EQ(ImagesIn(Joined({{'-', 0xFF, '\n'}, first, Bytes(500, 0), {0xFF}, second, {'-'}}), 100, &jpegs),
            (std::vector<Bytes>{first, second}));
  EXPECT_EQ(jpegs.broken(), 0);
}

TEST(JpegImages, AThumbnailIsNoImage) {
  const Bytes image = WithThumbnail(Jpeg(64, 48), Jpeg(16, 12));
  JpegImages jpegs;
  EXPECT_EQ(ImagesIn(Joined({image, image}), 777, &jpegs), (std::vector<Bytes>{image, image}));
}

TEST(JpegImages, OneThatIsCutOffIsCountedAndTheNextOneFound) {
  const Bytes whole = Jpeg(64, 48);
  const Bytes in_head = {whole.begin(), whole.begin() + 2};
  JpegImages jpegs;
  EXPECT_EQ(ImagesIn(Joined({FirstHalf(Jpeg(64, 48)), whole, in_head, whole, FirstHalf(whole)}), 300, &jpegs),
            (std::vector<Bytes>{whole, whole}));
  EXPECT_EQ(jpegs.broken(), 2);
  EXPECT_TRUE(jpegs.IsWithinImage()) << "the last one may go on";
}

TEST(JpegImages, ADamagedHeadIsCountedAndTheNextOneFound) {
  const Bytes whole = Jpeg(64, 48);
  for (const Bytes& wrong : {Bytes{0, 0xE0}, Bytes{0xFF, 0xD9}, Bytes{0xFF, 0xE0, 0, 1}}) {
    Bytes damaged = whole;
    std::copy(wrong.begin(), wrong.end(), damaged.begin() + 2);
    JpegImages jpegs;
    EXPECT_EQ(ImagesIn(Joined({damaged, whole}), 1000, &jpegs), std::vector<Bytes>{whole});
    EXPECT_EQ(jpegs.broken(), 1);
  }
}

}  // namespace
}  // namespace pliant
