// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What sequences give: images, masks, truth.
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "datasets/opened_sequence.h"

namespace pliant {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

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

// How images are stored is the sequence's own, whatever the lens.
TEST_F(OpenSequenceTest, TakesFromItsOwnCalibrationWhatAnotherDoesNotSay) {
  WriteNative(3);
  for (int idx = 0; idx < 3; ++idx) Write("depth/" + Name(idx), cv::Mat(kHeight, kWidth, CV_16UC1, cv::Scalar(100)));
  Text("other.yaml", "model: PINHOLE\nwidth: 64\nheight: 48\nparams: [70, 70, 31.5, 23.5]\n");
  SequenceRequest request = Request();
  request.camera_path = Path("other.yaml");
  const auto sequence = Open(request);
  ASSERT_NE(sequence, nullptr);
  EXPECT_EQ(sequence->camera().params()[0], 70);
  ASSERT_TRUE(sequence->Next().ok());
  EXPECT_DOUBLE_EQ((*sequence->Next())->timestamp_s, 1 / 20.0);
  EXPECT_FLOAT_EQ((**sequence->Depth(0)).at<float>(0, 0), 50);
}

TEST_F(OpenSequenceTest, AVideosNameMayHaveAColon) {
  WriteCamera();
  WriteVideo("clip:1.avi", 2);
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(root_);
  const auto sequence = Open({.image_path = "clip:1.avi"});
  std::filesystem::current_path(before);
  ASSERT_NE(sequence, nullptr);
  EXPECT_THAT(Indices(*sequence), ElementsAre(0, 1));
}

TEST_F(OpenSequenceTest, TellsWhenAVideoEndsBeforeTheStart) {
  WriteCamera();
  WriteVideo("clip.avi", 4);
  SequenceRequest request = Request("clip.avi");
  request.start = 9;
  ExpectRefused(request, ErrorCode::kInvalidArgument, "start is 9");
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

TEST_F(OpenSequenceTest, WarnsOf16BitImagesThatUseFewOfTheirValues) {
  WriteCamera();
  const auto warnings_of = [&](int level, int type) {
    for (int idx = 0; idx < 4; ++idx)
      Write("images/" + Name(idx), cv::Mat(kHeight, kWidth, type, cv::Scalar(level - idx, level, level, 65535)));
    const auto sequence = Open(Request());
    return sequence ? sequence->Warnings() : std::vector<std::string>{"it does not open"};
  };
  for (const int type : {CV_16UC1, CV_16UC3, CV_16UC4})
    EXPECT_THAT(warnings_of(4080, type), ElementsAre(HasSubstr("use only values up to 4080 of 65535"))) << type;
  EXPECT_THAT(warnings_of(1020, CV_16UC3), ElementsAre(HasSubstr("if 1023 is full scale, scale them by 64")));
  EXPECT_THAT(warnings_of(40000, CV_16UC3), testing::IsEmpty());
  EXPECT_THAT(warnings_of(200, CV_8UC3), testing::IsEmpty());
}

TEST_F(OpenSequenceTest, SaysThatSidesAreExchangedWhereACalibrationIsOfTurnedImages) {
  WriteVideo("clip.avi", 2);
  WriteCamera("camera.yaml", kHeight, kWidth);
  ExpectRefused(Request("clip.avi"), ErrorCode::kMismatch, "the rotation in the metadata of a video is applied");
  WriteImages(2, "f");
  SequenceRequest folder = Request("f");
  folder.camera_path = Path("camera.yaml");
  ExpectRefused(folder, ErrorCode::kMismatch, "the EXIF orientation of images is ignored");
  WriteCamera("camera.yaml", kWidth + 8, kHeight);
  EXPECT_THAT(OpenSequence(Request("clip.avi")).status().message(), testing::Not(HasSubstr("rotation")));
}

TEST_F(OpenSequenceTest, WarnsOfAFocalLengthThatIsNoneInPixels) {
  WriteNative(2);
  const auto warnings_of = [&](const std::string& model, const std::string& params) {
    Text("camera.yaml", "model: " + model + "\nwidth: 64\nheight: 48\nparams: [" + params + "]\n");
    const auto sequence = Open(Request());
    return sequence ? sequence->Warnings() : std::vector<std::string>{"it does not open"};
  };
  EXPECT_THAT(warnings_of("PINHOLE", "4, 4, 31.5, 23.5"),
              ElementsAre(testing::AllOf(HasSubstr("a horizontal field of view of 166 degrees"),
                                         HasSubstr("is its focal length in millimeters? it is wanted in pixels"))));
  EXPECT_THAT(warnings_of("PINHOLE", "800, 800, 31.5, 23.5"), ElementsAre(HasSubstr("in millimeters?")));
  EXPECT_THAT(warnings_of("PINHOLE", "60, 80, 31.5, 23.5"), ElementsAre(HasSubstr("differ by more than 30 %")));
  EXPECT_THAT(warnings_of("PINHOLE", "60, 70, 31.5, 23.5"), testing::IsEmpty());
  EXPECT_THAT(warnings_of("OPENCV_FISHEYE", "21, 21, 31.5, 23.5, 0, 0, 0, 0"), testing::IsEmpty()) << "175 degrees";
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

}  // namespace
}  // namespace pliant
