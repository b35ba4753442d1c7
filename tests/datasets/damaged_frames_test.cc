// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Frames that cannot be read in the middle of a sequence.
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include "datasets/opened_sequence.h"
#include "pliant/datasets/check_images.h"

namespace pliant {
namespace {

using testing::HasSubstr;

constexpr int kMaxReadable = 18;  // of 20 frames, in 0.6 of the file's bytes

TEST_F(OpenSequenceTest, NamesATruncatedPngAndGoesOnAfterIt) {
  WriteNative(5);
  Write("images/000002.png", Noise());
  Truncate("images/000002.png", 0.6);
  testing::internal::CaptureStderr();
  ExpectBadFrame(*Open(Request()), 5, 2, ErrorCode::kUnreadable, "000002.png is truncated");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(OpenSequenceTest, NamesAPngWithAFlippedByteBeforeTheLibraryDoes) {
  WriteNative(5);
  Write("images/000002.png", Noise());
  {
    const std::string path = Request().image_path.string() + "/images/000002.png";
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    const auto middle = static_cast<std::streamoff>(std::filesystem::file_size(path) / 2);
    file.seekg(middle);
    const int byte = file.get();
    file.seekp(middle);
    file.put(static_cast<char>(byte ^ 0x5a));
  }
  testing::internal::CaptureStderr();
  ExpectBadFrame(*Open(Request()), 5, 2, ErrorCode::kUnreadable, "000002.png is damaged");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(OpenSequenceTest, NamesATruncatedJpegEmptyFileAndTextFile) {
  WriteCamera();
  Write("images/000000.jpg", Noise());
  Truncate("images/000000.jpg", 0.5);
  Text("images/000001.png", "");
  Text("images/000002.png", "not a picture");
  const auto sequence = Open(Request());
  ASSERT_NE(sequence, nullptr);
  EXPECT_THAT(sequence->Next().status().message(), HasSubstr("000000.jpg is truncated"));
  EXPECT_THAT(sequence->Next().status().message(), HasSubstr("000001.png is empty"));
  EXPECT_THAT(sequence->Next().status().message(), HasSubstr("000002.png cannot be decoded"));
}

TEST_F(OpenSequenceTest, NamesATruncatedBmpAndTiff) {
  WriteCamera();
  for (const char* extension : {".bmp", ".tif"}) {
    const std::string name = std::string("images/000000") + extension;
    Write(name, Noise());
    Truncate(name, 0.5);
    const auto sequence = Open(Request());
    ASSERT_NE(sequence, nullptr);
    testing::internal::CaptureStderr();
    EXPECT_EQ(sequence->Next().status().code(), ErrorCode::kUnreadable) << extension;
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << extension;
    std::filesystem::remove(Path(name));
  }
}

TEST_F(OpenSequenceTest, RefusesAnImageOfMoreThanFiftyMegapixels) {
  WriteNative(2);
  Write("images/000001.png", cv::Mat(5001, 10000, CV_8U, cv::Scalar(1)));
  ExpectBadFrame(*Open(Request()), 2, 1, ErrorCode::kUnreadable,
                 "000001.png has 10000x5001 pixels, more than 50 million; scale it down");
}

TEST_F(OpenSequenceTest, TellsWhenTheImageSizeChanges) {
  WriteNative(4);
  Write("images/000002.png", Image(2, 32, 24));
  ExpectBadFrame(*Open(Request()), 4, 2, ErrorCode::kMismatch, "000002.png is 32x24");
  ExpectBadFrame(*Open(Request()), 4, 2, ErrorCode::kMismatch, "64x48");
}

TEST_F(OpenSequenceTest, FindsAnImageOfAnotherSizeOrWithoutAHead) {
  for (const char* extension : {".png", ".jpg", ".bmp"}) {
    std::filesystem::remove_all(Path("images"));
    WriteCamera();
    for (int idx = 0; idx < 4; ++idx) Write("images/00000" + std::to_string(idx) + extension, Image(idx));
    EXPECT_TRUE(Open(Request())->CheckFiles().ok()) << extension;
    Write(std::string("images/000002") + extension, Image(2, 32, 24));
    const Status status = Open(Request())->CheckFiles();
    EXPECT_EQ(status.code(), ErrorCode::kMismatch) << extension;
    EXPECT_THAT(status.message(), HasSubstr(std::string("000002") + extension + " is 32x24, but 000000"));
    SequenceRequest before = Request();
    before.end = 2;
    EXPECT_TRUE(Open(before)->CheckFiles().ok()) << extension;
    Truncate(std::string("images/000002") + extension, 0.01);
    const Status without_head = Open(Request())->CheckFiles();
    EXPECT_EQ(without_head.code(), ErrorCode::kUnreadable) << extension;
    EXPECT_THAT(without_head.message(), HasSubstr(std::string("000002") + extension)) << extension;
    EXPECT_TRUE(Open(before)->CheckFiles().ok()) << extension;
    Write(std::string("images/000002") + extension, Image(2));
    EXPECT_TRUE(Open(Request())->CheckFiles().ok()) << extension;
    Truncate(std::string("images/000002") + extension, 0.9);
    const bool tells = extension != std::string(".bmp");  // by an end marker
    EXPECT_THAT(Open(Request())->CheckFiles().message(), HasSubstr(tells ? " is truncated" : "")) << extension;
  }
}

TEST_F(OpenSequenceTest, FindsAMaskOfAnotherSizeOrWithoutAHead) {
  WriteNative(3);
  for (int idx = 0; idx < 3; ++idx)
    Write("masks/00000" + std::to_string(idx) + ".png", cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar::all(255)));
  EXPECT_TRUE(Open(Request())->CheckFiles().ok());
  Write("masks/000002.png", cv::Mat(8, 8, CV_8UC1, cv::Scalar::all(255)));
  EXPECT_THAT(Open(Request())->CheckFiles().message(), HasSubstr("000002.png is 8x8, but the images are 64x48"));
  Truncate("masks/000002.png", 0);
  EXPECT_THAT(Open(Request())->CheckFiles().message(), HasSubstr("000002.png is empty"));
}

TEST_F(OpenSequenceTest, TellsWhenAVideoBreaksOff) {
  WriteVideo("clip.avi", 20);
  WriteCamera();
  Truncate("clip.avi", 0.6);
  const auto sequence = Open(Request("clip.avi"));
  ASSERT_NE(sequence, nullptr);
  int good = 0;
  auto frame = sequence->Next();
  for (; frame.ok() && frame->has_value(); frame = sequence->Next()) ++good;
  EXPECT_GT(good, 0);
  EXPECT_LT(good, kMaxReadable);
  ASSERT_FALSE(frame.ok());
  EXPECT_EQ(frame.status().code(), ErrorCode::kUnreadable);
  EXPECT_THAT(frame.status().message(), HasSubstr("clip.avi breaks off: frame " + std::to_string(good) + " of 20"));
  EXPECT_FALSE(sequence->Next()->has_value());
}

TEST_F(OpenSequenceTest, LeavesADamagedFrameOfAVideoOut) {
  WriteVideo("clip.avi", 20);
  WriteCamera();
  std::fstream file(Path("clip.avi"), std::ios::in | std::ios::out | std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  std::size_t at = 0;
  for (int idx = 0; idx < 11; ++idx) at = bytes.find("00dc", at + 1);
  ASSERT_NE(at, std::string::npos);
  const std::string nothing(bytes.find("00dc", at + 1) - at - 8, '\0');
  file.seekp(static_cast<std::streamoff>(at + 8));
  file.write(nothing.data(), static_cast<std::streamsize>(nothing.size()));
  file.close();
  const auto sequence = Open(Request("clip.avi"));
  ASSERT_NE(sequence, nullptr);
  ImageChecker checker;
  std::vector<int> read;
  auto frame = sequence->Next();
  for (; frame.ok() && frame->has_value(); frame = sequence->Next()) {
    read.push_back((*frame)->frame_idx);
    checker.Add(**frame);
  }
  EXPECT_TRUE(frame.ok()) << frame.status().message();
  // A decoder may tell of the damage one image late.
  ASSERT_EQ(read.size(), 19U);
  EXPECT_THAT(std::vector<int>(read.begin(), read.begin() + 9), testing::ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8));
  EXPECT_THAT(std::vector<int>(read.end() - 9, read.end()), testing::ElementsAre(11, 12, 13, 14, 15, 16, 17, 18, 19));
  EXPECT_EQ(checker.Check().damaged, 1);
  EXPECT_THAT(checker.Check().wrong, testing::Contains(HasSubstr("are damaged and left out, where points jump")));
}

// As a clip that was cut without being coded again: the edit list of an MP4 hides the first frames, which the container
// still counts, and shows so many.
void HideFrames(const std::filesystem::path& path, int coded, int hidden, int shown) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
    return value;
  };
  const auto write = [&](std::size_t at, std::uint32_t value) {
    const std::array<char, 4> four = {static_cast<char>(value >> 24), static_cast<char>(value >> 16),
                                      static_cast<char>(value >> 8), static_cast<char>(value)};
    file.seekp(static_cast<std::streamoff>(at));
    file.write(four.data(), four.size());
  };
  const std::size_t mdhd = bytes.find("mdhd");
  const std::size_t elst = bytes.find("elst");
  ASSERT_TRUE(mdhd != std::string::npos && elst != std::string::npos);
  const auto unsigned_of = [](int count) { return static_cast<std::uint32_t>(count); };
  write(elst + 16, number(mdhd + 16) / 25 * unsigned_of(hidden));  // in units of the media's time
  write(elst + 12, number(elst + 12) / unsigned_of(coded) * unsigned_of(shown));
}

TEST_F(OpenSequenceTest, ReadsAnMp4ThatCountsHiddenFramesToItsEnd) {
  constexpr int kCoded = 60;
  constexpr int kHidden = 20;
  // Cut in the order of coding, a clip lacks some of the last frames that it says to show.
  for (const int lacks : {0, 3}) {
    {
      cv::VideoWriter writer(Path("clip.mp4").string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 25,
                             {kWidth, kHeight});
      if (!writer.isOpened()) GTEST_SKIP() << "OpenCV's FFmpeg has no MPEG-4 encoder";
      for (int idx = 0; idx < kCoded; ++idx) writer.write(Image(idx));
    }
    WriteCamera();
    HideFrames(Path("clip.mp4"), kCoded, kHidden, kCoded - kHidden + lacks);
    const auto sequence = Open(Request("clip.mp4"));
    ASSERT_NE(sequence, nullptr);
    int good = 0;
    auto frame = sequence->Next();
    for (; frame.ok() && frame->has_value(); frame = sequence->Next()) ++good;
    EXPECT_TRUE(frame.ok()) << frame.status().message();
    EXPECT_NEAR(good, kCoded - kHidden, 1);
    EXPECT_EQ(sequence->size(), kCoded) << "the container's word";
  }
}

// The unit of the times of a container, which says no rate.
TEST_F(OpenSequenceTest, DoesNotBelieveARateThatNoCameraHas) {
  WriteVideo("clip.avi", 3);
  std::fstream file(Path("clip.avi"), std::ios::in | std::ios::out | std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const std::size_t stream_header = bytes.find("strh");
  ASSERT_NE(stream_header, std::string::npos);
  constexpr std::array<char, 8> kScaleAndRate = {1, 0, 0, 0, '\x90', '\x5F', 1, 0};  // 90000 a second
  file.seekp(static_cast<std::streamoff>(stream_header + 28));
  file.write(kScaleAndRate.data(), kScaleAndRate.size());
  file.close();
  WriteCamera();
  const auto sequence = Open(Request("clip.avi"));
  ASSERT_NE(sequence, nullptr);
  ASSERT_TRUE(sequence->Next().ok());
  EXPECT_DOUBLE_EQ((*sequence->Next())->timestamp_s, 1 / 20.0) << "that of camera.yaml";
  EXPECT_TRUE(sequence->Next()->has_value());
  const auto end = sequence->Next();
  EXPECT_TRUE(end.ok() && !end->has_value());
}

TEST_F(OpenSequenceTest, TellsWhenAVideoFrameHasNoMask) {
  WriteVideo("clip.avi", 3);
  WriteCamera();
  Write("m/000000.png", cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar::all(255)));
  SequenceRequest request = Request("clip.avi");
  request.mask_path = Path("m");
  const auto sequence = Open(request);
  ASSERT_NE(sequence, nullptr);
  EXPECT_TRUE(sequence->Next().ok());
  EXPECT_THAT(sequence->Next().status().message(), HasSubstr("no mask for the frame 000001.png"));
}

TEST_F(OpenSequenceTest, TellsAtOnceOfAGapInAVideosMasks) {
  WriteVideo("clip.avi", 3);
  WriteCamera();
  for (const char* name : {"m/000000.png", "m/000002.png"})
    Write(name, cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar::all(255)));
  SequenceRequest request = Request("clip.avi");
  request.mask_path = Path("m");
  const auto sequence = OpenSequence(request);
  ASSERT_FALSE(sequence.ok());
  EXPECT_THAT(sequence.status().message(), HasSubstr("no mask for the frame 000001.png"));
}

TEST_F(OpenSequenceTest, TellsWhatIsWrongWithADepthImage) {
  WriteNative(2);
  Write("depth/000000.png", cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar::all(9)));
  Write("depth/000001.png", cv::Mat(8, 8, CV_16UC1, cv::Scalar::all(9)));
  const auto sequence = Open(Request());
  ASSERT_NE(sequence, nullptr);
  EXPECT_EQ(sequence->Depth(0).status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(sequence->Depth(0).status().message(), HasSubstr("8 bits"));
  EXPECT_EQ(sequence->Depth(1).status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(sequence->Depth(1).status().message(), HasSubstr("8x8"));
}

}  // namespace
}  // namespace pliant
