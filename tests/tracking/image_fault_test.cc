// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/image_fault.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace pliant {
namespace {

// A round view of 4 % of an image that is black around it.
struct SmallView {
  cv::Mat gray = cv::Mat(360, 640, CV_8UC1, cv::Scalar(0));
  cv::Mat valid = cv::Mat(360, 640, CV_8UC1, cv::Scalar(0));

  explicit SmallView(double level) {
    cv::circle(valid, {320, 180}, 54, cv::Scalar(255), cv::FILLED);
    cv::Mat noise(gray.size(), CV_8UC1);
    cv::RNG(1).fill(noise, cv::RNG::UNIFORM, 0.5 * level, 1.5 * level);
    noise.copyTo(gray, valid);
  }
};

TEST(Blankness, IsThatOfTheView) {
  const SmallView lit(60);
  EXPECT_EQ(Blankness(lit.gray, SupportMask(lit.valid)), "");
  EXPECT_EQ(Blankness(lit.gray, SupportMask()), "the image is black");
  const SmallView dark(3);
  EXPECT_EQ(Blankness(dark.gray, SupportMask(dark.valid)), "the image is black");
}

// Where nothing is usable: in a white image all is highlight, in a black one nothing is lit.
TEST(Blankness, WithoutAViewIsThatOfTheImage) {
  const SupportMask nothing(cv::Mat::zeros(360, 640, CV_8UC1));
  EXPECT_EQ(Blankness(cv::Mat(360, 640, CV_8UC1, cv::Scalar(255)), nothing), "the image is white");
  EXPECT_EQ(Blankness(cv::Mat(360, 640, CV_8UC1, cv::Scalar(0)), nothing), "the image is black");
  EXPECT_EQ(Blankness(cv::Mat(360, 640, CV_8UC1, cv::Scalar(90)), nothing), "the image is of one color");
}

TEST(ImageFault, OfAnImageThatIsTheOneBefore) {
  PreparedFrame frame;
  frame.gray = SmallView(60).gray;
  EXPECT_EQ(ImageFault(frame, cv::Mat()), "the image is black");
  frame.mask = SupportMask(SmallView(60).valid);
  EXPECT_EQ(ImageFault(frame, frame.gray.clone()), "the image is the same as the one before (frozen)");
  EXPECT_EQ(ImageFault(frame, SmallView(70).gray), "");
}

}  // namespace
}  // namespace pliant
