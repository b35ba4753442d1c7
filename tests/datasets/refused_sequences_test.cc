// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What is refused when a sequence is opened.
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "datasets/opened_sequence.h"
#include "support/text_pipe.h"

namespace pliant {
namespace {

TEST_F(OpenSequenceTest, RefusesWhatIsNotThere) {
  ExpectRefused(Request("nowhere"), ErrorCode::kNotFound, "nowhere");
  ExpectRefused(SequenceRequest{}, ErrorCode::kNotFound, "image path");
  std::filesystem::create_directories(Path("empty"));
  ExpectRefused(Request("empty"), ErrorCode::kNotFound, "empty holds no image");
  Text("texts/readme.txt", "hello");
  ExpectRefused(Request("texts"), ErrorCode::kNotFound, "texts holds no image");
  WriteImages(2, "scan");
  ExpectRefused(Request("scan"), ErrorCode::kNotFound, "camera.yaml");
}

TEST_F(OpenSequenceTest, RefusesPathsThatAreNotUtf8) {
  WriteImages(2, "f\xE4lle");
  ExpectRefused(Request("f\xE4lle"), ErrorCode::kInvalidArgument, "is not UTF-8; rename it");
}

TEST_F(OpenSequenceTest, RefusesAFileWhereAFolderBelongs) {
  WriteNative(2);
  Text("depth", "a file");
  ExpectRefused(Request(), ErrorCode::kUnreadable, "depth is a file where a folder");
}

TEST_F(OpenSequenceTest, RefusesAFileThatIsNoVideo) {
  Text("clip.mp4", "this is no video");
  WriteCamera();
  ExpectRefused(Request("clip.mp4"), ErrorCode::kUnreadable, "clip.mp4 as a video");
}

TEST_F(OpenSequenceTest, RefusesRangesThatMakeNoSense) {
  WriteNative(4);
  SequenceRequest request = Request();
  request.start = 4;
  ExpectRefused(request, ErrorCode::kInvalidArgument, "has 4 frames");
  request.start = -1;
  ExpectRefused(request, ErrorCode::kInvalidArgument, "start is -1");
  request.start = 2;
  request.end = 2;
  ExpectRefused(request, ErrorCode::kInvalidArgument, "end is 2");
  request.end = -1;
  request.stride = 0;
  ExpectRefused(request, ErrorCode::kInvalidArgument, "stride is 0");
}

TEST_F(OpenSequenceTest, RefusesACalibrationOfAnotherSize) {
  WriteImages(2);
  WriteCamera("camera.yaml", 32, 24);
  ExpectRefused(Request(), ErrorCode::kMismatch, "32x24");
  ExpectRefused(Request(), ErrorCode::kMismatch, "64x48");
  WriteVideo("clip.avi", 2);
  ExpectRefused(Request("clip.avi"), ErrorCode::kMismatch, "32x24");
}

TEST_F(OpenSequenceTest, RefusesMissingMasksAtOnceAndMasksOfAnotherSize) {
  WriteNative(3);
  const cv::Mat mask(kHeight, kWidth, CV_8UC1, cv::Scalar::all(255));
  Write("masks/000000.png", mask);
  Write("masks/000002.png", mask);
  ExpectRefused(Request(), ErrorCode::kNotFound, "no mask for the frame 000001.png");
  Write("masks/000001.png", cv::Mat(8, 8, CV_8UC1, cv::Scalar::all(255)));
  ExpectBadFrame(*Open(Request()), 3, 1, ErrorCode::kMismatch, "000001.png is 8x8");
  Write("strange/a.png", mask);
  SequenceRequest request = Request();
  request.mask_path = Path("strange");
  ExpectRefused(request, ErrorCode::kMismatch, "1 mask images for 3 frames");
  request.mask_path = Path("nomasks");
  ExpectRefused(request, ErrorCode::kNotFound, "nomasks");
}

TEST_F(OpenSequenceTest, RefusesAGroundTruthThatIsShortOrGarbled) {
  WriteNative(3);
  Text("groundtruth.txt", "0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n");
  ExpectRefused(Request(), ErrorCode::kMismatch, "2 poses for 3 images");
  Text("groundtruth.txt", "0 0 0 0 0 0 0 1\n1 0 0 what 0 0 0 1\n2 0 0 0 0 0 0 1\n");
  ExpectRefused(Request(), ErrorCode::kUnreadable, "groundtruth.txt:2");
}

TEST_F(OpenSequenceTest, RefusesTimesThatAreShortGarbledOrNotGrowing) {
  WriteNative(3);
  Text("times.txt", "0\n1\n");
  ExpectRefused(Request(), ErrorCode::kMismatch, "2 times for 3 images");
  Text("times.txt", "0\nnoon\n2\n");
  ExpectRefused(Request(), ErrorCode::kUnreadable, "times.txt:2");
  Text("times.txt", "0\n1\n1\n");
  ExpectRefused(Request(), ErrorCode::kUnreadable, "times.txt:3");
  Text("times.txt", "0\n0.0000001\n0.0000002\n");
  ExpectRefused(Request(), ErrorCode::kMismatch, "times.txt are the same to a microsecond");
}

TEST_F(OpenSequenceTest, RefusesPipesWhereFilesBelong) {
  WriteNative(3);
  {
    const TextPipe times(Path("times.txt"), "0\n1\n2\nthe end\n");
    ExpectRefused(Request(), ErrorCode::kUnreadable, "times.txt' is a pipe or a device");
    EXPECT_TRUE(times.IsUnread());
  }
  std::filesystem::remove(Path("times.txt"));
  for (int idx = 0; idx < 2; ++idx) Write("masks/" + Name(idx), cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(255)));
  const TextPipe mask(Path("masks/" + Name(2)), "no image");
  ExpectBadFrame(*Open(Request()), 3, 2, ErrorCode::kUnreadable, "000002.png' is a pipe or a device");
  std::filesystem::remove_all(Path("masks"));
  std::filesystem::remove(Path("images/" + Name(1)));
  const TextPipe image(Path("images/" + Name(1)), "no image");
  ExpectBadFrame(*Open(Request()), 3, 1, ErrorCode::kUnreadable, "000001.png' is a pipe or a device");
  EXPECT_TRUE(mask.IsUnread() && image.IsUnread());
}

}  // namespace
}  // namespace pliant
