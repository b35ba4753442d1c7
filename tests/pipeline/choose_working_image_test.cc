// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/choose_working_image.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "pipeline/working_frame.h"
#include "pliant/datasets/native_writer.h"
#include "pliant/photometric/patch.h"
#include "support/test_folder.h"

namespace pliant {
namespace {

constexpr int kImages = 16;
constexpr int kWidth = 1600;
constexpr int kHeight = 1200;
constexpr double kBlob_px = 3;       // of the texture: nothing in it is finer
constexpr double kContrast = 25;     // standard deviation, gray levels
constexpr double kStrongNoise = 25;  // standard deviation, gray levels, of every pixel by itself
constexpr double kVeryStrongNoise = 80;
constexpr int kStep_px = 3;       // the texture moves on by this, a frame
constexpr int kFieldStep_px = 2;  // of it, until the odd rows of an interlaced image are exposed

// A smooth texture that moves sideways, with noise that is new in every frame.
class MovingTexture : public testing::Test {
 protected:
  void Write(double noise, int field_step_px = 0) {
    const auto camera =
        Camera::Create(CameraModelId::kSimplePinhole, kWidth, kHeight, std::array{1200.0, kWidth / 2.0, kHeight / 2.0});
    ASSERT_TRUE(camera.ok());
    auto writer = NativeWriter::Create(folder_.Path("sequence"), {.camera = *camera, .fps = 25});
    ASSERT_TRUE(writer.ok()) << writer.status().message();
    cv::RNG random(7);
    cv::Mat texture(kHeight, kWidth + (kImages + 1) * kStep_px, CV_32FC1);
    random.fill(texture, cv::RNG::NORMAL, 0, 1);
    cv::GaussianBlur(texture, texture, {}, kBlob_px);
    cv::Scalar mean;
    cv::Scalar deviation;
    cv::meanStdDev(texture, mean, deviation);
    texture = 128 + kContrast / deviation[0] * texture;
    for (int k = 0; k < kImages; ++k) {
      cv::Mat grain(kHeight, kWidth, CV_32FC1);
      random.fill(grain, cv::RNG::NORMAL, 0, noise);
      cv::Mat shown = texture.colRange(k * kStep_px, k * kStep_px + kWidth).clone();
      const int later_px = k * kStep_px + field_step_px;
      for (int y = 1; y < kHeight; y += 2) texture.row(y).colRange(later_px, later_px + kWidth).copyTo(shown.row(y));
      cv::Mat image;
      cv::Mat(shown + grain).convertTo(image, CV_8UC1);
      cv::cvtColor(image, image, cv::COLOR_GRAY2BGR);
      const Status written = writer->Write({.timestamp_s = k / 25.0, .image = image});
      ASSERT_TRUE(written.ok()) << written.message();
    }
  }

  WorkingImage Chosen(const TrackOptions& options = {}) const {
    SequenceRequest request;
    request.image_path = folder_.Path("sequence");
    return ChooseWorkingImage(ReadFirstRuns(request), options);
  }

  TestFolder folder_;
};

TEST_F(MovingTexture, CleanImagesAreUsedAsTheyAre) {
  Write(0.3);
  EXPECT_TRUE(Chosen().IsSource());
  EXPECT_EQ(Chosen().patch_scale, 1);
}

TEST_F(MovingTexture, OfInterlacedOnesTheOddRowsAreLeftOut) {
  Write(0.3, kFieldStep_px);
  EXPECT_EQ(Chosen(), WorkingImage{.interlaced = true});
  TrackOptions options;
  options.image.working = WorkingImageMode::kFixed;
  EXPECT_EQ(Chosen(options), WorkingImage{}) << "images are taken as they are";
  options.image.interlaced = Interlacing::kOn;
  EXPECT_EQ(Chosen(options), WorkingImage{.interlaced = true});
}

TEST_F(MovingTexture, OddRowsAreLeftOutWhereThatIsAskedFor) {
  Write(0.3);
  EXPECT_FALSE(Chosen().interlaced);
  TrackOptions options;
  options.image.interlaced = Interlacing::kOn;
  EXPECT_TRUE(Chosen(options).interlaced);
  Write(0.3, kFieldStep_px);
  options.image.interlaced = Interlacing::kOff;
  EXPECT_FALSE(Chosen(options).interlaced);
}

TEST_F(MovingTexture, NoisyOnesAreMadeSmallerOrSmoother) {
  Write(kStrongNoise);
  const WorkingImage chosen = Chosen();
  EXPECT_TRUE(chosen.scale < 1 || chosen.smoothing_px > 0) << chosen.scale << ", " << chosen.smoothing_px;
}

TEST_F(MovingTexture, VeryNoisyOnesTakeLargerPatches) {
  Write(kVeryStrongNoise);
  EXPECT_GT(Chosen().patch_scale, 1);
}

// Small images: so many black ones, so many of a card that stands still, and so many of a texture that moves.
class LeadIn : public testing::Test {
 protected:
  int FirstLookedAt(int black, int card, int moving) const {
    const auto camera = Camera::Create(CameraModelId::kSimplePinhole, 160, 120, std::array{120.0, 80.0, 60.0});
    auto writer = NativeWriter::Create(folder_.Path("sequence"), {.camera = *camera, .fps = 25});
    EXPECT_TRUE(writer.ok()) << writer.status().message();
    cv::Mat texture(120, 160 + kStep_px * moving, CV_8UC3);
    cv::RNG(7).fill(texture, cv::RNG::UNIFORM, 0, 255);
    cv::GaussianBlur(texture, texture, {}, kBlob_px);
    for (int k = 0; k < black + card + moving; ++k) {
      cv::Mat image(120, 160, CV_8UC3, cv::Scalar::all(2));
      if (k >= black) cv::rectangle(image, {40, 40, 80, 30}, cv::Scalar::all(200), cv::FILLED);
      if (k >= black + card)
        texture.colRange((k - black - card) * kStep_px, (k - black - card) * kStep_px + 160).copyTo(image);
      EXPECT_TRUE(writer->Write({.timestamp_s = k / 25.0, .image = image}).ok());
    }
    SequenceRequest request;
    request.image_path = folder_.Path("sequence");
    const std::vector<ImageRun> runs = ReadFirstRuns(request);
    return runs.empty() || runs.front().empty() ? -1 : runs.front().front().frame_idx;
  }

  TestFolder folder_;
};

TEST_F(LeadIn, BlackAndACardArePassedOver) { EXPECT_EQ(FirstLookedAt(20, 25, 12), 45); }
TEST_F(LeadIn, AShortOneIsNot) { EXPECT_EQ(FirstLookedAt(6, 6, 12), 0); }
TEST_F(LeadIn, WhereNothingElseFollowsItIsWhatThereIs) { EXPECT_EQ(FirstLookedAt(0, 40, 0), 0); }

TEST(ChooseWorkingImage, LargeImagesAreMadeSmaller) {
  SequenceFrame frame;
  frame.image = cv::Mat(4000, 5000, CV_8U, cv::Scalar(7));
  const WorkingImage chosen = ChooseWorkingImage({{frame}}, TrackOptions());
  EXPECT_NEAR(chosen.scale, std::sqrt(12.0 / 20.0), 1e-9);
  EXPECT_EQ(chosen.smoothing_px, 0);
}

TEST(WorkingOptions, PatchesGrowUpToTheLargest) {
  TrackerOptions options;
  LucasKanadeOptions& lucas_kanade = options.point_tracker.lucas_kanade;
  lucas_kanade.patch_size = 15;
  EXPECT_EQ(WorkingOptions(options, {}).point_tracker.lucas_kanade.patch_size, 15);
  EXPECT_EQ(WorkingOptions(options, {.patch_scale = 1.4}).point_tracker.lucas_kanade.patch_size, 21);
  lucas_kanade.patch_size = 17;
  EXPECT_EQ(WorkingOptions(options, {.patch_scale = 1.41}).point_tracker.lucas_kanade.patch_size, 25);
  lucas_kanade.patch_size = kMaxPatchSize;
  EXPECT_EQ(WorkingOptions(options, {.patch_scale = 1.4}).point_tracker.lucas_kanade.patch_size, kMaxPatchSize);
}

}  // namespace
}  // namespace pliant
