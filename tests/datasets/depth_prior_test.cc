// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Depth images of other programs: what is read of them, and which image they belong to.
#include <cstdint>
#include <fstream>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "datasets/depth_prior_file.h"
#include "datasets/opened_sequence.h"
#include "io/npy.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

using testing::HasSubstr;

class DepthPriorTest : public OpenSequenceTest {
 protected:
  void WriteArray(const std::string& name, const std::vector<std::size_t>& shape, float value) const {
    std::size_t count = 1;
    for (const std::size_t length : shape) count *= length;
    const std::vector<float> values(count, value);
    std::filesystem::create_directories(Path(name).parent_path());
    std::ofstream(Path(name), std::ios::binary)
        << NpyBytes("<f4", shape, {reinterpret_cast<const char*>(values.data()), count * sizeof(float)});
  }
  Result<cv::Mat> Read(const std::string& name) const { return ReadDepthPrior(Path(name), kWidth, kHeight); }
  SequenceRequest WithPriors() const {
    SequenceRequest request = Request();
    request.depth_prior_path = Path("prior");
    return request;
  }
};

TEST_F(DepthPriorTest, ValuesAreThoseOfTheFile) {
  Write("steps.png", cv::Mat(kHeight, kWidth, CV_16UC1, cv::Scalar::all(40000)));
  Write("bytes.png", cv::Mat(kHeight / 2, kWidth / 2, CV_8UC1, cv::Scalar::all(200)));
  Write("floats.tiff", cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar::all(0.25)));
  WriteArray("array.npy", {kHeight, kWidth}, 1.5F);
  WriteArray("batch.npy", {1, kHeight / 4, kWidth / 4, 1}, 2.5F);
  for (const auto& [name, value] :
       {std::pair("steps.png", 40000.0F), std::pair("bytes.png", 200.0F), std::pair("floats.tiff", 0.25F),
        std::pair("array.npy", 1.5F), std::pair("batch.npy", 2.5F)}) {
    const auto prior = Read(name);
    ASSERT_TRUE(prior.ok()) << prior.status().message();
    EXPECT_EQ(prior->type(), CV_32FC1);
    EXPECT_EQ(prior->at<float>(3, 4), value) << name;
  }
  EXPECT_EQ(Read("batch.npy")->size(), cv::Size(kWidth / 4, kHeight / 4));
}

TEST_F(DepthPriorTest, RefusesWhatIsNoDepthOfTheImage) {
  Write("colors.png", Image(0));
  Write("square.png", cv::Mat(kHeight, kHeight, CV_16UC1, cv::Scalar::all(7)));
  WriteArray("pair.npy", {2, kHeight, kWidth}, 1.0F);
  Text("cut.npy", std::string("\x93NUMPY", 6));
  for (const auto& [name, code, says] :
       {std::tuple("colors.png", ErrorCode::kMismatch, "a picture in colors is no depth"),
        std::tuple("square.png", ErrorCode::kMismatch, "is 48x48, but the images are 64x48"),
        std::tuple("pair.npy", ErrorCode::kMismatch, "has the shape (2, 48, 64)"),
        std::tuple("cut.npy", ErrorCode::kUnreadable, "cut.npy"),
        std::tuple("none.png", ErrorCode::kNotFound, "there is no file")}) {
    const auto prior = Read(name);
    ASSERT_FALSE(prior.ok()) << name;
    EXPECT_EQ(prior.status().code(), code) << prior.status().message();
    EXPECT_THAT(prior.status().message(), HasSubstr(says));
  }
}

TEST_F(DepthPriorTest, BelongsToTheImageOfItsName) {
  WriteNative(4);
  WriteArray("prior/000001.npy", {kHeight, kWidth}, 1.0F);
  WriteArray("prior/000003.npy", {kHeight, kWidth}, 3.0F);
  const auto sequence = Open(WithPriors());
  ASSERT_NE(sequence, nullptr);
  ASSERT_FALSE(sequence->Warnings().empty());
  EXPECT_THAT(sequence->Warnings().front(), HasSubstr("2 of 4 images have no depth prior, the first is 000000.png"));
  for (int idx = 0; idx < 4; ++idx) {
    const auto frame = sequence->Next();
    ASSERT_TRUE(frame.ok() && frame->has_value());
    ASSERT_EQ((*frame)->depth_prior.empty(), idx % 2 == 0) << idx;
    if (idx % 2 == 0) continue;
    EXPECT_EQ((*frame)->depth_prior.at<float>(5, 5), static_cast<float>(idx));
  }
}

TEST_F(DepthPriorTest, OneThatSaysNothingIsWarnedOf) {
  WriteNative(2);
  const auto warned = [&] {
    const auto sequence = OpenSequence(WithPriors());
    return sequence.ok() ? CommaSeparated((*sequence)->Warnings()) : sequence.status().message();
  };
  for (const char* name : {"prior/000000.npy", "prior/000001.npy"}) WriteArray(name, {kHeight, kWidth}, 2.0F);
  EXPECT_THAT(warned(), HasSubstr("000000.npy says nothing of depth: it has one value everywhere; check what"));
  for (const float none : {std::numeric_limits<float>::quiet_NaN(), 0.0F, std::numeric_limits<float>::infinity()}) {
    WriteArray("prior/000000.npy", {kHeight, kWidth}, none);
    EXPECT_THAT(warned(), HasSubstr("000000.npy says nothing of depth: it has no positive number")) << none;
  }
  cv::Mat ramp(kHeight, kWidth, CV_16UC1);
  for (int u = 0; u < kWidth; ++u) ramp.col(u) = 100 + u;
  std::filesystem::remove_all(Path("prior"));
  for (const char* name : {"prior/000000.png", "prior/000001.png"}) Write(name, ramp);
  EXPECT_EQ(warned(), "");
}

TEST_F(DepthPriorTest, BelongsByOrderWhereNoNameAgrees) {
  WriteNative(2);
  WriteArray("prior/a.npy", {kHeight, kWidth}, 1.0F);
  WriteArray("prior/b.npy", {kHeight, kWidth}, 2.0F);
  const auto sequence = Open(WithPriors());
  ASSERT_NE(sequence, nullptr);
  for (const float value : {1.0F, 2.0F}) EXPECT_EQ((**sequence->Next()).depth_prior.at<float>(0, 0), value);
  WriteArray("prior/c.npy", {kHeight, kWidth}, 3.0F);
  const auto refused = OpenSequence(WithPriors());
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.status().message(), HasSubstr("3 depth prior images for 2 frames"));
}

TEST_F(DepthPriorTest, AFileThatCannotBeReadEndsAtItsFrame) {
  WriteNative(2);
  WriteArray("prior/000000.npy", {kHeight, kWidth}, 1.0F);
  Text("prior/000001.npy", "no array");
  const auto sequence = Open(WithPriors());
  ASSERT_NE(sequence, nullptr);
  EXPECT_TRUE(sequence->Next().ok());
  const auto second = sequence->Next();
  ASSERT_FALSE(second.ok());
  EXPECT_THAT(second.status().message(), HasSubstr("000001.npy"));
}

TEST_F(DepthPriorTest, OneFileOrAFolderWithoutDepthsIsRefused) {
  WriteNative(2);
  SequenceRequest one_file = Request();
  WriteArray("prior.npy", {kHeight, kWidth}, 1.0F);
  one_file.depth_prior_path = Path("prior.npy");
  EXPECT_THAT(OpenSequence(one_file).status().message(), HasSubstr("is one file; depth priors are a folder"));
  Text("prior/readme.txt", "later");
  const auto refused = OpenSequence(WithPriors());
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.status().message(), HasSubstr("holds no image (png, tif, tiff, npy, exr)"));
}

}  // namespace
}  // namespace pliant
