// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Images of a textured wall that a camera moves along, with the noise of a sensor, and with what may be wrong with
// them.
#include "pliant/datasets/check_images.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "datasets/opened_sequence.h"

namespace pliant {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kColumns = 320;
constexpr int kRows = 240;
constexpr int kFrames = 60;
constexpr int kNear_px = 8;  // of an overlay's rectangle: letters end before their box does

// Smooth spots with edges; large enough for the camera to move along.
cv::Mat Wall() {
  cv::Mat wall(kRows + 200, kColumns + 200, CV_8UC1);
  cv::RNG random(3);
  random.fill(wall, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(wall, wall, {}, 4);
  cv::normalize(wall, wall, 60, 200, cv::NORM_MINMAX);
  return wall;
}

struct Recording {
  double noise = 3;                        // gray levels
  double speed_px = 1.5;                   // an image
  int stops_at = kFrames;                  // the image from which on the camera stands still
  std::vector<int> shown = {};             // which image of the camera each frame shows; empty: one after the other
  void (*burn)(cv::Mat* image) = nullptr;  // after the noise
  cv::Mat mask = {};
  std::vector<double> times_s = {};
  bool round_view = false;
};

// An image as the camera takes it: another noise each time.
cv::Mat Taken(const Recording& recording, int k) {
  static const cv::Mat wall = Wall();
  const double way_px = recording.speed_px * std::min(k, recording.stops_at);
  const cv::Point2f center(static_cast<float>(kColumns / 2.0 + 20 + way_px),
                           static_cast<float>(kRows / 2.0 + 60 + 30 * std::sin(0.2 * way_px)));
  cv::Mat image;
  cv::getRectSubPix(wall, {kColumns, kRows}, center, image);
  if (recording.round_view) {
    cv::Mat view(image.size(), CV_8UC1, cv::Scalar(0));
    cv::circle(view, {kColumns / 2, kRows / 2}, 110, 255, cv::FILLED);
    cv::GaussianBlur(view, view, {}, 2);
    cv::multiply(image, view, image, 1 / 255.0);
  }
  cv::Mat noisy;
  cv::Mat noise(image.size(), CV_16SC1);
  cv::RNG random(static_cast<std::uint64_t>(100 + k));
  random.fill(noise, cv::RNG::NORMAL, 0, recording.noise);
  image.convertTo(noisy, CV_16SC1);
  noisy += noise;
  noisy.convertTo(image, CV_8UC1);
  return image;
}

ImageCheck Checked(const Recording& recording) {
  ImageChecker checker;
  const int frames = recording.shown.empty() ? kFrames : static_cast<int>(recording.shown.size());
  for (int k = 0; k < frames; ++k) {
    SequenceFrame frame;
    frame.frame_idx = k;
    frame.image = Taken(recording, recording.shown.empty() ? k : recording.shown[static_cast<std::size_t>(k)]);
    if (recording.burn != nullptr) recording.burn(&frame.image);
    frame.mask = recording.mask;
    if (!recording.times_s.empty()) frame.recorded_s = recording.times_s[static_cast<std::size_t>(k)];
    checker.Add(frame);
  }
  return checker.Check();
}

TEST(ImageChecker, FindsNothingWrongWithGoodImagesWhateverTheirNoise) {
  for (const double noise : {0.0, 2.0, 10.0})
    for (const double speed_px : {0.3, 4.0 / 3}) {
      const ImageCheck check = Checked({.noise = noise, .speed_px = speed_px});
      EXPECT_THAT(check.wrong, IsEmpty()) << noise << " " << speed_px;
      EXPECT_EQ(check.repeated, 0);
      EXPECT_EQ(check.images, kFrames);
    }
  EXPECT_THAT(Checked({.round_view = true}).wrong, IsEmpty()) << "the rim of the view is no overlay";
}

TEST(ImageChecker, SaysNothingOfACameraThatStandsStill) {
  EXPECT_THAT(Checked({.speed_px = 0}).wrong, IsEmpty());
  EXPECT_THAT(Checked({.noise = 0.7, .stops_at = 30}).wrong, IsEmpty()) << "its noise goes on";
  const ImageCheck frozen = Checked({.noise = 0, .stops_at = 30});
  EXPECT_EQ(frozen.repeated, 29);
  EXPECT_THAT(frozen.wrong, ElementsAre(HasSubstr("the image stands still from frame 30 to 59")));
}

TEST(ImageChecker, FindsRepeatedImagesAndTheStrideThatLeavesThemOut) {
  Recording twice;
  for (int k = 0; k < kFrames; ++k) twice.shown.push_back(k / 2);
  const ImageCheck doubled = Checked(twice);
  EXPECT_EQ(doubled.repeated, kFrames / 2);
  EXPECT_THAT(doubled.wrong, ElementsAre(testing::AllOf(HasSubstr("30 of 60 images (50 %) repeat the one before"),
                                                        HasSubstr("give --stride 2"))));
  Recording converted;  // from 25 to 30 images a second, and what encoding it again leaves
  for (int k = 0; k < kFrames; ++k) converted.shown.push_back(k * 5 / 6);
  converted.burn = [](cv::Mat* image) { image->at<std::uint8_t>(image->at<std::uint8_t>(0, 0) % kRows, 7) ^= 3; };
  const ImageCheck sixth = Checked(converted);
  EXPECT_EQ(sixth.repeated, kFrames / 6);
  EXPECT_THAT(sixth.wrong, ElementsAre(HasSubstr("mkdir -p images && ffmpeg -i VIDEO -vf mpdecimate")));
  Recording dropped;  // one or two lost images are nothing to speak of
  for (int k = 0; k < kFrames; ++k) dropped.shown.push_back(k == 20 || k == 40 ? k - 1 : k);
  EXPECT_EQ(Checked(dropped).repeated, 2);
  EXPECT_THAT(Checked(dropped).wrong, IsEmpty());
}

TEST(ImageChecker, DoesNotTakeASlideForAConversion) {
  Recording recording;
  for (int k = 0; k < kFrames; ++k) recording.shown.push_back(std::max(0, k - 20));
  EXPECT_THAT(Checked(recording).wrong, ElementsAre(HasSubstr("the image stands still from frame 0 to 20")));
}

TEST(ImageChecker, DoesNotTakeAnInterruptionForRepeatedImages) {
  for (const int level : {0, 4}) {
    ImageChecker checker;
    cv::RNG random(5);
    for (int k = 0; k < kFrames; ++k) {
      SequenceFrame frame;
      frame.image = Taken({}, k);
      if (k >= 20 && k < 30) random.fill(frame.image, cv::RNG::UNIFORM, 0, level + 1);  // the light is off
      checker.Add(frame);
    }
    EXPECT_THAT(checker.Check().wrong, IsEmpty()) << level;
  }
}

TEST(ImageChecker, FindsUnevenStepsInTime) {
  Recording even;
  Recording uneven;
  double time_s = 0;
  for (int k = 0; k < kFrames; ++k) {
    even.times_s.push_back(std::round(1000 * k / 30.0) / 1000);  // 33 or 34 ms
    uneven.times_s.push_back(time_s);
    time_s += k % 10 == 4 ? 0.2 : 0.04;
  }
  EXPECT_THAT(Checked(even).wrong, IsEmpty());
  EXPECT_EQ(Checked(even).steps, kFrames - 1);
  EXPECT_THAT(Checked(uneven).wrong, ElementsAre(testing::AllOf(HasSubstr("6 of 59 steps between time stamps (10 %)"),
                                                                HasSubstr("40 ms"), HasSubstr("200 ms"))));
  EXPECT_EQ(Checked({}).steps, 0);
}

void BurnText(cv::Mat* image) { cv::putText(*image, "12:30", {40, 220}, cv::FONT_HERSHEY_SIMPLEX, 0.8, 255, 2); }

TEST(ImageChecker, FindsTextThatIsBurnedInWhereItIs) {
  const ImageCheck check = Checked({.burn = BurnText});
  EXPECT_TRUE(check.tells_overlays);
  ASSERT_TRUE(check.overlay.has_value());
  int baseline = 0;
  const cv::Size size = cv::getTextSize("12:30", cv::FONT_HERSHEY_SIMPLEX, 0.8, 2, &baseline);
  EXPECT_NEAR(check.overlay->x, 40, kNear_px);
  EXPECT_NEAR(check.overlay->y + check.overlay->height, 220, kNear_px);
  EXPECT_NEAR(check.overlay->width, size.width, 2 * kNear_px);
  EXPECT_NEAR(check.overlay->height, size.height, 2 * kNear_px);
  EXPECT_THAT(check.wrong, ElementsAre(HasSubstr("burned in")));

  cv::Mat mask(kRows, kColumns, CV_8UC1, cv::Scalar(255));
  mask(cv::Rect(30, 190, 120, 40)) = 0;
  EXPECT_THAT(Checked({.burn = BurnText, .mask = mask}).wrong, IsEmpty()) << "it is masked out";
}

// As the edge of a picture that was resized: one row of pixels is a third as bright, and sharp.
void DarkenBottom(cv::Mat* image) {
  cv::Mat calm = image->rowRange(200, kRows);  // there the scene has less contrast, as tissue nearby may have
  calm.convertTo(calm, CV_8UC1, 0.35, 0.65 * 130);
  image->row(kRows - 8) *= 0.35;
  image->rowRange(kRows - 7, kRows) = 1;
}

TEST(ImageChecker, SaysNothingOfADarkBarAndItsEdge) { EXPECT_THAT(Checked({.burn = DarkenBottom}).wrong, IsEmpty()); }

TEST(ImageChecker, FindsTextInTheDarkSurroundingsOfTheView) {
  const auto burn = [](cv::Mat* image) { cv::putText(*image, "No 7", {2, 18}, cv::FONT_HERSHEY_SIMPLEX, 0.6, 200, 1); };
  const ImageCheck check = Checked({.burn = burn, .round_view = true});
  ASSERT_TRUE(check.overlay.has_value());
  EXPECT_LT(check.overlay->x + check.overlay->width, 80);
  EXPECT_LT(check.overlay->y + check.overlay->height, 30);
}

TEST(ImageChecker, SaysNothingOfTextInAStillScene) {
  const ImageCheck check = Checked({.noise = 1, .speed_px = 0, .burn = BurnText});
  EXPECT_FALSE(check.tells_overlays);
  EXPECT_FALSE(check.overlay.has_value());
}

TEST(ImageChecker, TellsMasksTheWrongWayRound) {
  cv::Mat mask(kRows, kColumns, CV_8UC1, cv::Scalar(0));
  cv::circle(mask, {kColumns / 2, kRows / 2}, 108, 255, cv::FILLED);
  EXPECT_THAT(Checked({.mask = mask, .round_view = true}).wrong, IsEmpty());
  const ImageCheck inverted = Checked({.noise = 0.5, .mask = ~mask, .round_view = true});
  EXPECT_TRUE(inverted.masks_are_inverted);
  EXPECT_THAT(inverted.wrong, ElementsAre(HasSubstr("the wrong way round")));
  EXPECT_LT(inverted.left_level, inverted.taken_level);
  cv::Mat tool(kRows, kColumns, CV_8UC1, cv::Scalar(255));
  tool(cv::Rect(100, 0, 100, kRows)) = 0;
  EXPECT_THAT(Checked({.mask = tool}).wrong, IsEmpty());
}

TEST(ImageChecker, TellsMasksThatLeaveLittle) {
  cv::Mat tool(kRows, kColumns, CV_8UC1, cv::Scalar(0));
  tool(cv::Rect(100, 0, 32, kRows)) = 255;  // white, as in a segmentation
  const ImageCheck white = Checked({.mask = tool});
  EXPECT_NEAR(white.left_share.value_or(-1), 0.1, 0.01);
  EXPECT_FALSE(white.masks_are_inverted);
  EXPECT_THAT(white.wrong, ElementsAre(testing::AllOf(HasSubstr("the masks leave 10 % of the image"),
                                                      HasSubstr("in a mask 0 is what is ignored"))));
  EXPECT_THAT(Checked({.mask = ~tool}).wrong, IsEmpty());
  const cv::Mat nothing(kRows, kColumns, CV_8UC1, cv::Scalar(0));
  EXPECT_THAT(Checked({.mask = nothing}).wrong, ElementsAre(HasSubstr("the masks leave 0 % of the image")));
  EXPECT_FALSE(Checked({}).left_share.has_value());
}

TEST(ImageChecker, CountsWhatMasksLeaveWithoutTheDarkSurroundings) {
  cv::Mat view(kRows, kColumns, CV_8UC1, cv::Scalar(0));
  cv::circle(view, {kColumns / 2, kRows / 2}, 65, 255, cv::FILLED);  // 17 % of the image, 35 % of the view
  const ImageCheck check = Checked({.mask = view, .round_view = true});
  EXPECT_NEAR(check.left_share.value_or(-1), 0.35, 0.03);
  EXPECT_THAT(check.wrong, IsEmpty());
}

TEST(CheckedSequence, GivesWhatItsSourceGives) {
  class Source final : public Sequence {
   public:
    const Camera& camera() const override { return camera_; }
    int size() const override { return 2; }
    Result<std::optional<SequenceFrame>> Next() override {
      SequenceFrame frame;
      frame.frame_idx = next_;
      frame.image = Image();
      if (next_ == 2) {
        next_ += 2;
        return Status(ErrorCode::kUnreadable, "it is cut off");
      }
      return next_++ < 8 ? std::optional(frame) : std::nullopt;
    }
    Result<std::optional<cv::Mat>> Depth(int) const override { return std::optional<cv::Mat>(); }
    std::optional<Rigid3> WorldFromCamera(int) const override { return std::nullopt; }
    static cv::Mat Image() { return cv::Mat(kRows, kColumns, CV_8UC3, cv::Scalar(1, 2, 3)); }

   private:
    Camera camera_ = *Camera::Create("SIMPLE_PINHOLE", kColumns, kRows, std::vector<double>{100, 160, 120});
    int next_ = 0;
  };
  Source source;
  CheckedSequence checked(source);
  EXPECT_EQ((*checked.Next())->frame_idx, 0);
  EXPECT_EQ((*checked.Next())->frame_idx, 1);
  // What is read ahead behind a failure, at which a run ends, says nothing of the images before.
  EXPECT_FALSE(checked.Next().ok());
  EXPECT_EQ((*checked.Next())->frame_idx, 4);
  EXPECT_EQ(checked.Check().images, 2);
  EXPECT_THAT(checked.Check().wrong, testing::Not(testing::Contains(testing::HasSubstr("are damaged"))));
}

class RecordedTimes : public OpenSequenceTest {};

TEST_F(RecordedTimes, ComeFromTimesTxtAndTheVideoAndNotFromARate) {
  WriteNative(3);
  EXPECT_FALSE((*Open(Request())->Next())->recorded_s.has_value());
  Text("times.txt", "0\n0.5\n0.6\n");
  const auto sequence = Open(Request());
  ASSERT_TRUE(sequence->Next().ok());
  EXPECT_EQ((*sequence->Next())->recorded_s, 0.5);
  WriteVideo("clip.avi", 4);
  WriteCamera("clip.yaml");
  SequenceRequest request = Request("clip.avi");
  request.camera_path = Path("clip.yaml");
  const auto video = Open(request);
  ASSERT_TRUE(video->Next().ok());
  EXPECT_NEAR((*video->Next())->recorded_s.value_or(-1), 1.0 / 25, 1e-3);
}

}  // namespace
}  // namespace pliant
