// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The depth images of a sequence as arrays of NumPy.
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "datasets/opened_sequence.h"
#include "io/npy.h"

namespace pliant {
namespace {

using testing::HasSubstr;

class DepthMapTest : public OpenSequenceTest {
 protected:
  template <class Number>
  static std::string Array(std::string_view type, const std::vector<std::size_t>& shape,
                           const std::vector<Number>& values) {
    return NpyBytes(type, shape, {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Number)});
  }
  void WriteBytes(const std::string& name, const std::string& bytes) const {
    std::filesystem::create_directories(Path(name).parent_path());
    std::ofstream(Path(name), std::ios::binary) << bytes;
  }
};

TEST_F(DepthMapTest, AnArrayIsDepthInMillimetersWhateverTheScaleOfImages) {
  WriteNative(4);
  std::vector<float> singles(kWidth * kHeight, 60.25F);
  singles[1] = 61.5F;  // the second column of the first row
  WriteBytes("depth/000000.npy", Array("<f4", {kHeight, kWidth}, singles));
  std::vector<double> doubles(kWidth * kHeight, 70.5);
  doubles[0] = std::nan("");
  doubles[1] = -1;
  doubles[2] = std::numeric_limits<double>::infinity();
  doubles[3] = 0;
  WriteBytes("depth/000001.npy", Array("<f8", {1, kHeight, kWidth}, doubles));
  Write("depth/000002.png", cv::Mat(kHeight, kWidth, CV_16UC1, cv::Scalar::all(102)));
  const auto sequence = Open(Request());
  ASSERT_NE(sequence, nullptr);
  const cv::Mat first = **sequence->Depth(0);
  EXPECT_EQ(first.type(), CV_32FC1);
  EXPECT_EQ(first.size(), cv::Size(kWidth, kHeight));
  EXPECT_EQ(first.at<float>(0, 1), 61.5F);
  EXPECT_EQ(first.at<float>(5, 7), 60.25F);
  const cv::Mat second = **sequence->Depth(1);
  for (int x = 0; x < 4; ++x) EXPECT_EQ(second.at<float>(0, x), 0.0F) << x;
  EXPECT_EQ(second.at<float>(0, 4), 70.5F);
  EXPECT_EQ((**sequence->Depth(2)).at<float>(0, 0), 51.0F);  // 102 * depth_scale
  EXPECT_FALSE(sequence->Depth(3)->has_value());
}

// What np.save makes of the transpose of an array of (width, height).
TEST_F(DepthMapTest, AnArrayMayBeStoredColumnsFirst) {
  WriteNative(2);
  std::vector<float> columns(kWidth * kHeight);
  for (int x = 0; x < kWidth; ++x)
    for (int y = 0; y < kHeight; ++y)
      columns[static_cast<std::size_t>(x * kHeight + y)] = static_cast<float>(100 * y + x + 1);
  std::string bytes = Array("<f4", {kHeight, kWidth}, columns);
  bytes.replace(bytes.find("'fortran_order': False"), 22, "'fortran_order': True ");
  for (const char* name : {"depth/000000.npy", "depth/000001.npy"}) WriteBytes(name, bytes);
  const auto sequence = Open(Request());
  ASSERT_NE(sequence, nullptr);
  const cv::Mat depth = **sequence->Depth(0);
  ASSERT_EQ(depth.size(), cv::Size(kWidth, kHeight));
  for (const auto& [x, y] : {std::pair(0, 0), std::pair(1, 0), std::pair(0, 1), std::pair(kWidth - 1, kHeight - 2)})
    EXPECT_EQ(depth.at<float>(y, x), static_cast<float>(100 * y + x + 1)) << x << " " << y;
}

TEST_F(DepthMapTest, RefusesWhatIsNoDepthInMillimeters) {
  WriteNative(5);
  const std::vector<float> values(kWidth * kHeight, 60.0F);
  const std::string good = Array("<f4", {kHeight, kWidth}, values);
  WriteBytes("depth/000000.npy", Array("<u2", {kHeight, kWidth}, std::vector<std::uint16_t>(kWidth * kHeight, 60)));
  WriteBytes("depth/000001.npy", Array("<f4", {kHeight, kWidth / 2, 2}, values));
  WriteBytes("depth/000002.npy", good.substr(0, good.size() - 1));
  WriteBytes("depth/000003.npy", Array("<f4", {kWidth, kHeight}, values));
  WriteBytes("depth/000004.npy", "an image");
  const auto sequence = Open(Request());
  ASSERT_NE(sequence, nullptr);
  int idx = 0;
  for (const auto& [code, says] :
       {std::pair(ErrorCode::kMismatch, "numbers of the type <u2; a depth map is an array of float32 or float64"),
        std::pair(ErrorCode::kMismatch, "has the shape (48, 32, 2); a depth map is an array of (height, width)"),
        std::pair(ErrorCode::kUnreadable, "is cut off: its header says (48, 64) numbers"),
        std::pair(ErrorCode::kMismatch, "is 48x64, but the images are 64x48"),
        std::pair(ErrorCode::kUnreadable, "is not an array of NumPy")}) {
    const auto depth = sequence->Depth(idx++);
    ASSERT_FALSE(depth.ok()) << says;
    EXPECT_EQ(depth.status().code(), code) << depth.status().message();
    EXPECT_THAT(depth.status().message(), HasSubstr(says));
  }
}

}  // namespace
}  // namespace pliant
