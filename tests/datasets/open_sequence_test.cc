// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/open_sequence.h"

#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "datasets/image_list.h"
#include "datasets/sequence_files.h"

namespace pliant {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr int kMaxReadable = 18;    // of 20 frames, in 0.6 of the file's bytes
constexpr double kVideoLoss = 3.0;  // gray levels a lossy codec may change a plain image by

class OpenSequenceTest : public SequenceFiles {
 protected:
  SequenceRequest Request(const std::string& name = "") const {
    SequenceRequest request;
    request.image_path = name.empty() ? root_ : Path(name);
    return request;
  }
  static std::unique_ptr<Sequence> Open(const SequenceRequest& request) {
    auto sequence = OpenSequence(request);
    EXPECT_TRUE(sequence.ok()) << sequence.status().message();
    return sequence.ok() ? *std::move(sequence) : nullptr;
  }
  static std::vector<int> Indices(Sequence& sequence) {
    std::vector<int> indices;
    while (true) {
      const auto frame = sequence.Next();
      EXPECT_TRUE(frame.ok()) << frame.status().message();
      if (!frame.ok() || !frame->has_value()) return indices;
      indices.push_back((*frame)->frame_idx);
      EXPECT_NEAR(cv::mean((*frame)->image)[0], Brightness((*frame)->frame_idx), kVideoLoss);
    }
  }
  // Opening fails with this code, and the sentence names this.
  static void ExpectRefused(const SequenceRequest& request, ErrorCode code, const std::string& named) {
    const auto sequence = OpenSequence(request);
    ASSERT_FALSE(sequence.ok());
    EXPECT_EQ(sequence.status().code(), code) << sequence.status().message();
    EXPECT_THAT(sequence.status().message(), HasSubstr(named));
  }
  // Frame `bad` fails so, all others come.
  static void ExpectBadFrame(Sequence& sequence, int count, int bad, ErrorCode code, const std::string& named) {
    for (int idx = 0; idx < count; ++idx) {
      const auto frame = sequence.Next();
      ASSERT_EQ(frame.ok(), idx != bad) << idx << " " << frame.status().message();
      if (idx == bad) {
        EXPECT_EQ(frame.status().code(), code) << frame.status().message();
        EXPECT_THAT(frame.status().message(), HasSubstr(named));
      } else {
        EXPECT_EQ((*frame)->frame_idx, idx);
      }
    }
    const auto end = sequence.Next();
    ASSERT_TRUE(end.ok());
    EXPECT_FALSE(end->has_value());
  }
};

TEST_F(OpenSequenceTest, ReadsANativeSequence) {
  WriteNative(5);
  const auto sequence = Open(Request());
  ASSERT_NE(sequence, nullptr);
  EXPECT_EQ(sequence->size(), 5);
  EXPECT_EQ(sequence->camera().width(), kWidth);
  const auto first = sequence->Next();
  ASSERT_TRUE(first.ok() && first->has_value());
  EXPECT_EQ((*first)->name, "000000.png");
  EXPECT_EQ((*first)->image.type(), CV_8UC3);
  EXPECT_TRUE((*first)->mask.empty());
  const auto second = sequence->Next();
  ASSERT_TRUE(second.ok() && second->has_value());
  EXPECT_DOUBLE_EQ((*second)->timestamp_s, 1 / 20.0);
  EXPECT_THAT(Indices(*sequence), ElementsAre(2, 3, 4));
  EXPECT_FALSE(sequence->WorldFromCamera(0).has_value());
  EXPECT_FALSE(sequence->Depth(0)->has_value());
}

TEST_F(OpenSequenceTest, AppliesStartEndAndStrideToSourceNumbers) {
  WriteNative(10);
  SequenceRequest request = Request();
  request.start = 2;
  request.end = 9;
  request.stride = 3;
  const auto sequence = Open(request);
  ASSERT_NE(sequence, nullptr);
  EXPECT_EQ(sequence->size(), 3);
  EXPECT_THAT(Indices(*sequence), ElementsAre(2, 5, 8));
  EXPECT_DOUBLE_EQ(*sequence->TimestampS(0), 0.0);  // truth is there for the whole source
  EXPECT_FALSE(sequence->TimestampS(10).has_value());
  EXPECT_EQ(sequence->Name(0), Name(0));
  EXPECT_FALSE(sequence->Name(10).has_value());
}

TEST_F(OpenSequenceTest, TakesOneFrameWithTheLargestStride) {
  WriteNative(5);
  WriteVideo("clip.avi", 5);
  for (const char* source : {"", "clip.avi"}) {
    SequenceRequest request = Request(source);
    request.start = 2;
    request.stride = std::numeric_limits<int>::max();
    const auto sequence = Open(request);
    ASSERT_NE(sequence, nullptr);
    EXPECT_EQ(sequence->size(), 1);
    EXPECT_THAT(Indices(*sequence), ElementsAre(2));
  }
}

TEST_F(OpenSequenceTest, ReadsTruthByFrameNumber) {
  WriteNative(3);
  std::string poses = "# timestamp tx ty tz qx qy qz qw\n";
  for (int idx = 0; idx < 3; ++idx) {
    cv::Mat depth(kHeight, kWidth, CV_16UC1, cv::Scalar::all(100 + idx));
    depth.at<std::uint16_t>(0, 0) = 0;
    Write("depth/" + Name(idx), depth);
    poses += std::to_string(idx) + " " + std::to_string(idx) + " 0 7 0 0 0 1\n";
  }
  Text("groundtruth.txt", poses);
  Text("times.txt", "# s\n0.5\n0.75\n2\n");
  const auto sequence = Open(Request());
  ASSERT_NE(sequence, nullptr);
  const auto depth_mm = sequence->Depth(2);
  ASSERT_TRUE(depth_mm.ok() && depth_mm->has_value());
  EXPECT_EQ((*depth_mm)->type(), CV_32FC1);
  EXPECT_FLOAT_EQ((*depth_mm)->at<float>(3, 4), 51.0F);  // 102 * depth_scale
  EXPECT_FLOAT_EQ((*depth_mm)->at<float>(0, 0), 0.0F);
  EXPECT_FALSE(sequence->Depth(3)->has_value());
  EXPECT_DOUBLE_EQ(sequence->WorldFromCamera(2)->translation.x(), 2.0);
  EXPECT_FALSE(sequence->WorldFromCamera(3).has_value());
  EXPECT_DOUBLE_EQ(*sequence->TimestampS(1), 0.75);
}

TEST_F(OpenSequenceTest, ReadsAFolderOfImagesInNaturalOrder) {
  for (int idx = 0; idx < 12; ++idx) Write("scan/frame" + std::to_string(idx) + ".png", Image(idx));
  Write("scan/.hidden.png", Image(0));
  Text("scan/notes.txt", "no image");
  WriteCamera("calibration.yaml");
  SequenceRequest request = Request("scan");
  request.camera_path = Path("calibration.yaml");
  const auto sequence = Open(request);
  ASSERT_NE(sequence, nullptr);
  EXPECT_EQ(Indices(*sequence).size(), 12U);  // Indices compares each frame's content with its number
}

TEST_F(OpenSequenceTest, ReadsAVideoForward) {
  WriteVideo("clip.avi", 8);
  WriteCamera();
  SequenceRequest request = Request("clip.avi");
  request.start = 1;
  request.end = 7;
  request.stride = 2;
  const auto sequence = Open(request);
  ASSERT_NE(sequence, nullptr);
  EXPECT_EQ(sequence->size(), 3);
  const auto frame = sequence->Next();
  ASSERT_TRUE(frame.ok() && frame->has_value());
  EXPECT_EQ((*frame)->name, "000001.png");
  EXPECT_DOUBLE_EQ((*frame)->timestamp_s, 1 / 25.0);  // the container's rate, not the calibration's
  EXPECT_THAT(Indices(*sequence), ElementsAre(3, 5));
  EXPECT_THAT(Indices(*Open(Request("clip.avi"))), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
}

TEST_F(OpenSequenceTest, ReadsEveryKindOfImageFile) {
  WriteCamera();
  int idx = 0;
  for (const char* extension : {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".PNG"}) {
    Write("images/" + Name(idx, extension), Image(idx));
    ++idx;
  }
  EXPECT_THAT(Indices(*Open(Request())), ElementsAre(0, 1, 2, 3, 4, 5, 6));
}

TEST_F(OpenSequenceTest, ConvertsDeepTransparentAndGrayImages) {
  WriteNative(3);
  cv::Mat deep(kHeight, kWidth, CV_16UC1, cv::Scalar::all(200 * 257));
  Write("images/000000.png", deep);
  Write("images/000001.png", cv::Mat(kHeight, kWidth, CV_8UC4, cv::Scalar(10, 20, 30, 0)));
  const auto sequence = Open(Request());
  ASSERT_NE(sequence, nullptr);
  const auto gray = sequence->Next();
  ASSERT_TRUE(gray.ok());
  EXPECT_EQ((*gray)->image.type(), CV_8UC1);
  EXPECT_EQ((*gray)->image.at<unsigned char>(5, 5), 200);
  const auto color = sequence->Next();
  ASSERT_TRUE(color.ok());
  EXPECT_EQ((*color)->image.type(), CV_8UC3);
  EXPECT_EQ((*color)->image.at<cv::Vec3b>(5, 5), cv::Vec3b(10, 20, 30));
}

TEST_F(OpenSequenceTest, PairsMasksByNameByOrderOrOneForAll) {
  WriteNative(2);
  cv::Mat mask(kHeight, kWidth, CV_8UC1, cv::Scalar::all(1));  // anything but 0 counts
  mask.at<unsigned char>(2, 3) = 0;
  Write("masks/000001.png", mask);
  Write("masks/000000.png", cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar(0, 0, 255)));
  Write("other/a.png", cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar::all(255)));
  Write("other/b.png", mask);
  Write("one.png", mask);
  for (const std::string masks : {"", "other", "one.png"}) {
    SequenceRequest request = Request();
    if (!masks.empty()) request.mask_path = Path(masks);
    const auto sequence = Open(request);
    ASSERT_NE(sequence, nullptr);
    const auto first = sequence->Next();
    const auto second = sequence->Next();
    ASSERT_TRUE(first.ok() && second.ok());
    EXPECT_EQ((*first)->mask.type(), CV_8UC1);
    EXPECT_EQ((*first)->mask.at<unsigned char>(2, 3), masks == "one.png" ? 0 : 255) << masks;
    EXPECT_EQ((*second)->mask.at<unsigned char>(2, 3), 0) << masks;
    EXPECT_EQ((*second)->mask.at<unsigned char>(3, 2), 255) << masks;
  }
}

TEST_F(OpenSequenceTest, PairsMasksWithVideoFramesByNumber) {
  WriteVideo("clip.avi", 3);
  WriteCamera();
  for (int idx = 0; idx < 3; ++idx)
    Write("m/" + Name(idx), cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar::all(idx == 1 ? 0 : 255)));
  SequenceRequest request = Request("clip.avi");
  request.mask_path = Path("m");
  request.start = 1;
  const auto sequence = Open(request);
  ASSERT_NE(sequence, nullptr);
  EXPECT_EQ(cv::countNonZero((*sequence->Next())->mask), 0);
  EXPECT_EQ(cv::countNonZero((*sequence->Next())->mask), kWidth * kHeight);
}

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

TEST_F(OpenSequenceTest, TellsWhenTheImageSizeChanges) {
  WriteNative(4);
  Write("images/000002.png", Image(2, 32, 24));
  ExpectBadFrame(*Open(Request()), 4, 2, ErrorCode::kMismatch, "000002.png is 32x24");
  ExpectBadFrame(*Open(Request()), 4, 2, ErrorCode::kMismatch, "64x48");
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

TEST_F(OpenSequenceTest, PosesOfSomeImagesBelongToThoseOfTheirTimes) {
  WriteNative(3);
  Text("times.txt", "0.5\n0.75\n2\n");
  Text("groundtruth.txt", "0.500000 1 0 0 0 0 0 1\n2.0 3 0 0 0 0 0 1\n");
  const auto sequence = Open(Request());
  ASSERT_NE(sequence, nullptr);
  EXPECT_EQ(sequence->WorldFromCamera(0)->translation.x(), 1);
  EXPECT_FALSE(sequence->WorldFromCamera(1).has_value());
  EXPECT_EQ(sequence->WorldFromCamera(2)->translation.x(), 3);
  EXPECT_THAT(sequence->Warnings(), ElementsAre(HasSubstr("1 of 3 images have no pose")));
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
}

TEST(NaturalLess, ComparesNumbersAsNumbers) {
  EXPECT_TRUE(NaturalLess("frame2.png", "frame10.png"));
  EXPECT_TRUE(NaturalLess("a2b3", "a2b10"));
  EXPECT_TRUE(NaturalLess("a", "a1"));
  EXPECT_TRUE(NaturalLess("9", "10000000000000000000000000"));
  EXPECT_FALSE(NaturalLess("x1", "x1"));
  EXPECT_NE(NaturalLess("x01", "x1"), NaturalLess("x1", "x01"));
}

}  // namespace
}  // namespace pliant
