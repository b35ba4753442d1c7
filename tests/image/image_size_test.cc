// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "image/image_size.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace pliant {
namespace {

constexpr int kStoredWidth = 37;
constexpr int kStoredHeight = 23;

std::vector<unsigned char> Encoded(const std::string& extension, int type) {
  std::vector<unsigned char> file;
  try {
    cv::imencode(extension, cv::Mat(kStoredHeight, kStoredWidth, type, cv::Scalar::all(1)), file);
  } catch (const cv::Exception&) {
    file.clear();  // a format that this OpenCV has not
  }
  return file;
}

TEST(ImageSize, IsTheOneThatIsDecoded) {
  int known = 0;
  for (const auto& [extension, type] :
       {std::pair(".png", CV_8UC3), std::pair(".png", CV_16UC1), std::pair(".jpg", CV_8UC1), std::pair(".bmp", CV_8UC3),
        std::pair(".tiff", CV_16UC3), std::pair(".exr", CV_32FC1), std::pair(".webp", CV_8UC3),
        std::pair(".jp2", CV_8UC3), std::pair(".ppm", CV_8UC3), std::pair(".pgm", CV_8UC1), std::pair(".pam", CV_8UC3),
        std::pair(".pfm", CV_32FC1), std::pair(".hdr", CV_32FC3), std::pair(".ras", CV_8UC3)}) {
    const auto file = Encoded(extension, type);
    if (file.empty()) continue;
    ++known;
    EXPECT_EQ(ImageSizeOf(file), cv::Size(kStoredWidth, kStoredHeight)) << extension;
    for (std::size_t size = 0; size < file.size(); ++size)  // no byte behind the end is looked at
      ImageSizeOf(std::vector(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size)));
  }
  EXPECT_GE(known, 8);
}

TEST(ImageSize, IsThatOfATiffOfEitherByteOrderAndOfBigTiff) {
  const std::string big_endian("MM\0*\0\0\0\x08\0\x02\1\0\0\3\0\0\0\1\0\x25\0\0\1\1\0\4\0\0\0\1\0\0\0\x17\0\0\0\0", 38);
  const std::string big_tiff(
      "II+\0\x08\0\0\0\x10\0\0\0\0\0\0\0\x02\0\0\0\0\0\0\0\0\1\3\0\1\0\0\0\0\0\0\0\x25\0\0\0\0\0\0\0"
      "\1\1\x10\0\1\0\0\0\0\0\0\0\x17\0\0\0\0\0\0\0",
      64);
  for (const std::string& file : {big_endian, big_tiff})
    EXPECT_EQ(ImageSizeOf(std::span(reinterpret_cast<const unsigned char*>(file.data()), file.size())),
              cv::Size(kStoredWidth, kStoredHeight));
}

TEST(ImageSize, OfOtherFilesIsNotKnown) {
  const std::string text = "an image? no, a text";
  EXPECT_EQ(ImageSizeOf(std::span(reinterpret_cast<const unsigned char*>(text.data()), text.size())), std::nullopt);
  EXPECT_EQ(ImageSizeOf({}), std::nullopt);
  EXPECT_EQ(ReadImageSize("/nowhere.png"), std::nullopt);
}

TEST(ImageSize, OfMoreThanFiftyMegapixelsIsRefused) {
  EXPECT_TRUE(CheckPixels({10000, 5000}, "the image a.png").ok());
  const Status large = CheckPixels({2147483647, 2147483647}, "the image a.png");
  EXPECT_EQ(large.code(), ErrorCode::kUnreadable);
  EXPECT_EQ(CheckPixels({10000, 5001}, "the image a.png").message(),
            "the image a.png has 10000x5001 pixels, more than 50 million; scale it down");
  EXPECT_FALSE(CheckPixels({0, 5}, "the image a.png").ok());
}

}  // namespace
}  // namespace pliant
