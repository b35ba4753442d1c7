// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/exr_file.h"

#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "support/test_folder.h"

namespace pliant {
namespace {

cv::Mat SomeDepth() {
  cv::Mat depth(37, 53, CV_32F);
  cv::RNG(3).fill(depth, cv::RNG::UNIFORM, 0.001, 1000.0);
  depth.at<float>(5, 7) = 0;
  return depth;
}

TEST(DepthExr, HoldsTheFloatsAsTheyAre) {
  const TestFolder folder;
  const cv::Mat depth = SomeDepth();
  ASSERT_TRUE(WriteDepthExr(folder.Path("depth.exr"), depth).ok());

  Imf::InputFile file(folder.Path("depth.exr").c_str());
  ASSERT_NE(file.header().channels().findChannel("Y"), nullptr);
  EXPECT_EQ(file.header().channels().findChannel("Y")->type, Imf::FLOAT);
  cv::Mat read(37, 53, CV_32F);
  Imf::FrameBuffer pixels;
  pixels.insert("Y", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(read.data), sizeof(float), read.step[0]));
  file.setFrameBuffer(pixels);
  file.readPixels(0, 36);
  EXPECT_EQ(cv::countNonZero(read != depth), 0);
}

TEST(DepthExr, IsReadByOpenCv) {
  const TestFolder folder;
  const cv::Mat depth = SomeDepth();
  ASSERT_TRUE(WriteDepthExr(folder.Path("depth.exr"), depth).ok());
  setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 0);
  const cv::Mat read = cv::imread(folder.Path("depth.exr"), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(read.type(), CV_32FC1);
  ASSERT_EQ(read.size(), depth.size());
  EXPECT_EQ(std::memcmp(read.data, depth.data, depth.total() * depth.elemSize()), 0);
}

TEST(DepthExr, AFolderThatIsNotThereIsNamed) {
  const TestFolder folder;
  const Status status = WriteDepthExr(folder.Path("nowhere/depth.exr"), cv::Mat(4, 4, CV_32F, cv::Scalar(1)));
  EXPECT_EQ(status.code(), ErrorCode::kUnwritable);
  EXPECT_NE(status.message().find("nowhere"), std::string::npos);
}

}  // namespace
}  // namespace pliant
