// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/given_images.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pliant/datasets/open_sequence.h"

namespace pliant {
namespace {

using testing::HasSubstr;

class ListedImages final : public ImageSource {
 public:
  ListedImages(std::vector<cv::Mat> images, bool count_is_known)
      : images_(std::move(images)), count_is_known_(count_is_known) {}

  int count() const override { return count_is_known_ ? static_cast<int>(images_.size()) : 0; }
  Result<std::optional<cv::Mat>> Read(int idx) override {
    const auto at = static_cast<std::size_t>(idx);
    return at < images_.size() ? std::optional(images_[at]) : std::nullopt;
  }

 private:
  std::vector<cv::Mat> images_;
  bool count_is_known_;
};

// Images of 8x6 pixels whose gray level is their number.
SequenceRequest RequestOf(int count, bool count_is_known = true) {
  std::vector<cv::Mat> images;
  for (int k = 0; k < count; ++k) images.emplace_back(6, 8, CV_8UC1, cv::Scalar(k));
  const std::vector<double> params = {10, 3.5, 2.5};
  auto given = std::make_shared<GivenImages>(
      GivenImages{.camera = *Camera::Create(CameraModelId::kSimplePinhole, 8, 6, params),
                  .images = std::make_shared<ListedImages>(std::move(images), count_is_known)});
  given->fps = 10;
  return {.given = std::move(given)};
}

TEST(GivenImages, AreReadInOrderWithNamesAndTimes) {
  for (const bool count_is_known : {true, false}) {
    const auto sequence = OpenSequence(RequestOf(3, count_is_known));
    ASSERT_TRUE(sequence.ok()) << sequence.status().message();
    for (int k = 0; k < 3; ++k) {
      const auto frame = (*sequence)->Next();
      ASSERT_TRUE(frame.ok() && frame->has_value());
      EXPECT_EQ((*frame)->frame_idx, k);
      EXPECT_EQ((*frame)->name, "00000" + std::to_string(k) + ".png");
      EXPECT_EQ((*frame)->timestamp_s, k / 10.0);
      EXPECT_EQ((*frame)->image.at<std::uint8_t>(5, 7), k);
    }
    EXPECT_FALSE((*sequence)->Next()->has_value());
  }
}

TEST(GivenImages, APartOfThemKeepsItsNumbers) {
  SequenceRequest request = RequestOf(10);
  request.start = 3;
  request.stride = 4;
  const auto sequence = OpenSequence(request);
  ASSERT_TRUE(sequence.ok());
  EXPECT_EQ((*sequence)->size(), 2);
  EXPECT_EQ((*(*sequence)->Next())->frame_idx, 3);
  EXPECT_EQ((*(*sequence)->Next())->frame_idx, 7);
  request.start = 10;
  EXPECT_THAT(OpenSequence(request).status().message(), HasSubstr("the list of images has 10 frames"));
}

TEST(GivenImages, TimesAreOneAnImage) {
  SequenceRequest request = RequestOf(2);
  auto timed = std::make_shared<GivenImages>(*request.given);
  timed->timestamps_s = {5.0, 7.5};
  request.given = timed;
  auto sequence = OpenSequence(request);
  ASSERT_TRUE(sequence.ok());
  EXPECT_EQ((*(*sequence)->Next())->timestamp_s, 5.0);
  EXPECT_EQ((*(*sequence)->Next())->timestamp_s, 7.5);
  timed->timestamps_s.push_back(9.0);
  const Status status = OpenSequence(request).status();
  EXPECT_EQ(status.code(), ErrorCode::kMismatch);
  EXPECT_THAT(status.message(), HasSubstr("there are 3 timestamps for 2 images"));
}

TEST(GivenImages, OfARateThatNoRunCanWriteAreRefused) {
  SequenceRequest request = RequestOf(2);
  auto fast = std::make_shared<GivenImages>(*request.given);
  fast->fps = 3e6;
  request.given = fast;
  EXPECT_THAT(OpenSequence(request).status().message(), HasSubstr("give frames a second, from 0.001 to 100000"));
}

TEST(GivenImages, OfAnotherSizeThanTheCamerasAreRefused) {
  SequenceRequest request = RequestOf(2);
  auto other = std::make_shared<GivenImages>(*request.given);
  const std::vector<double> params = {10, 7.5, 5.5};
  other->camera = *Camera::Create(CameraModelId::kSimplePinhole, 16, 12, params);
  request.given = other;
  const Status status = OpenSequence(request).status();
  EXPECT_EQ(status.code(), ErrorCode::kMismatch);
  EXPECT_THAT(status.message(), HasSubstr("is for images of 16x12, but image 0 is 8x6"));
}

}  // namespace
}  // namespace pliant
