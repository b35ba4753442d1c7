// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Pairs of images: apart, in one image, raw and rectified.
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "datasets/sequence_files.h"
#include "pliant/datasets/check_sequence.h"
#include "pliant/datasets/convert_sequence.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/io/trajectory.h"
#include "support/rendered_sequence.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using testing::HasSubstr;

constexpr double kRectifiedFocal_px = 0.5;    // of calibrations with six decimals; OpenCV may choose the size anew
constexpr double kTextNumber = 1e-3;          // mm, of a turn and a translation with six decimals each
constexpr double kOtherRow_px = 2.0;          // what a wrong turn of the right camera does
constexpr double kSameRow_px = 0.2;           // matching and two resamplings
constexpr double kNearlyAll = 0.98;           // share; a few matches may be wrong
constexpr double kHeight_px = 3;              // rows are stretched by 1.79, rounded up to whole ones
constexpr double kOtherRectification = 0.02;  // relative; another program chose another focal length
constexpr int kMinMasked = 300;               // a wedge along one side of the turned image
constexpr double kTime_s = 1e-6;              // times have six decimals
constexpr double kStep_mm = 0.011;            // depth images have steps of 0.01 mm, and the rounding of floats
constexpr double kNativePose = 1e-5;          // mm and rad: six decimals of positions, nine of quaternions

class StereoPairs : public SequenceFiles {
 protected:
  static constexpr int kFrames = 14;

  // The scene's pairs in one image each, rows closer together by `squeeze`.
  void WritePairs(bool top_bottom, double squeeze = 1.0) const {
    for (int k = 0; k < kFrames; ++k) {
      const SimulatedFrame& frame = Rendered().frames[static_cast<std::size_t>(k)];
      cv::Mat pair;
      if (top_bottom)
        cv::vconcat(frame.image, frame.right, pair);
      else
        cv::hconcat(frame.image, frame.right, pair);
      if (squeeze != 1.0) cv::resize(pair, pair, {}, 1.0, 1.0 / squeeze, cv::INTER_AREA);
      Write("pairs/" + Name(k), pair);
    }
  }
  // OpenCV's calibration of it; the left camera's center of projection in half an image.
  void WriteStereo(double squeeze = 1.0, const std::string& t = "[-5, 0, 0]", const std::string& more = "") const {
    const auto& p = Rendered().camera.params();
    const std::string matrix = "[" + std::to_string(p[0]) + ", 0, " + std::to_string(p[2]) + ", 0, " +
                               std::to_string(p[1] / squeeze) + ", " + std::to_string((p[3] + 0.5) / squeeze - 0.5) +
                               ", 0, 0, 1]";
    Text("stereo.yaml", "M1: " + matrix + "\nD1: [0, 0, 0, 0]\nM2: " + matrix +
                            "\nD2: [0, 0, 0, 0]\nR: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: " + t + "\n" + more);
  }
  Result<std::unique_ptr<Sequence>> Open() const {
    return OpenSequence({.image_path = Path("pairs"), .camera_path = Path("stereo.yaml")});
  }
  // Frame by frame what the simulator rendered, away from the edge, in gray levels.
  static void ExpectTheScene(Sequence& sequence, double most_difference) {
    const RenderedScene& scene = Rendered();
    EXPECT_EQ(sequence.camera().width(), scene.camera.width());
    EXPECT_EQ(sequence.camera().height(), scene.camera.height());
    for (std::size_t p = 0; p < 4; ++p)
      EXPECT_NEAR(sequence.camera().params()[p], scene.camera.params()[p], kRectifiedFocal_px) << p;
    EXPECT_NEAR(sequence.BaselineMm().value_or(0), scene.baseline_mm, kLengthRoundOff_mm);
    for (int k = 0; k < kFrames; ++k) {
      const auto frame = sequence.Next();
      ASSERT_TRUE(frame.ok() && frame->has_value()) << k << frame.status().message();
      const auto right = sequence.Right();
      ASSERT_TRUE(right.ok() && right->has_value()) << k;
      const cv::Rect inside(8, 8, scene.camera.width() - 16, scene.camera.height() - 16);
      const SimulatedFrame& truth = scene.frames[static_cast<std::size_t>(k)];
      EXPECT_LT(cv::norm((*frame)->image(inside), truth.image(inside), cv::NORM_L1) / inside.area() / 3,
                most_difference);
      EXPECT_LT(cv::norm((**right)(inside), truth.right(inside), cv::NORM_L1) / inside.area() / 3, most_difference);
    }
    const auto end = sequence.Next();
    ASSERT_TRUE(end.ok());
    EXPECT_FALSE(end->has_value());
  }
};

// Drawn on the image that its user has.
TEST_F(StereoPairs, MasksAreRectifiedWithTheirImages) {
  constexpr double kSqueeze = 1.79;
  WritePairs(false, kSqueeze);
  WriteStereo(kSqueeze);
  const cv::Size raw(Rendered().camera.width(), cvRound(Rendered().camera.height() / kSqueeze));
  cv::Mat mask(raw, CV_8U, cv::Scalar(255));
  mask(cv::Rect(40, 20, 30, 10)).setTo(0);
  Write("mask.png", mask);
  const auto sequence =
      OpenSequence({.image_path = Path("pairs"), .camera_path = Path("stereo.yaml"), .mask_path = Path("mask.png")});
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  const auto frame = (*sequence)->Next();
  ASSERT_TRUE(frame.ok() && frame->has_value()) << frame.status().message();
  ASSERT_EQ((*frame)->mask.size(), (*frame)->image.size());
  const cv::Rect there(40, cvRound(20 * kSqueeze), 30, cvRound(10 * kSqueeze));
  const cv::Mat inside = (*frame)->mask(there & cv::Rect({0, 0}, (*frame)->mask.size()));
  EXPECT_LT(cv::countNonZero(inside), 0.2 * there.area());
  const int ignored = (*frame)->mask.size().area() - cv::countNonZero((*frame)->mask);
  EXPECT_LT(ignored, 3 * there.area());
}

TEST_F(StereoPairs, OfANativeSequenceAreItsRightImages) {
  RenderedSequence rendered;
  rendered.mono = false;
  const auto summary = ConvertSequence(rendered, Path("seq"));
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->right, summary->frames);
  auto sequence = OpenSequence({.image_path = Path("seq"), .end = kFrames});
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  ExpectTheScene(**sequence, 1e-9);
}

TEST_F(StereoPairs, SideBySideAreSplitByTheirCalibration) {
  WritePairs(/*top_bottom=*/false);
  WriteStereo();
  auto sequence = Open();
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  ExpectTheScene(**sequence, 1.0);
}

TEST_F(StereoPairs, OneAboveTheOtherAreSplitByTheirCalibration) {
  WritePairs(/*top_bottom=*/true);
  WriteStereo();
  auto sequence = Open();
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  ExpectTheScene(**sequence, 1.0);
}

TEST_F(StereoPairs, WithRowsTooCloseTogetherBecomeAsHighAsTheyAreToBe) {
  WritePairs(/*top_bottom=*/false, 2.0);
  WriteStereo(2.0);
  auto sequence = Open();
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  ExpectTheScene(**sequence, 8.0);  // half of the rows are lost for good
}

TEST_F(StereoPairs, OfCamerasThatLookApartAreRectified) {
  // The right camera turned by 2 degrees about x and 1 about z: its image is that of a homography.
  const Eigen::Matrix3d turn = RotationExp({0.035, 0, 0.0175}).toRotationMatrix();
  const auto& p = Rendered().camera.params();
  const Eigen::Matrix3d k{{p[0], 0, p[2]}, {0, p[1], p[3]}, {0, 0, 1}};
  const Eigen::Matrix3d h = k * turn * k.inverse();
  cv::Matx33d homography;
  for (int row = 0; row < 3; ++row)
    for (int col = 0; col < 3; ++col) homography(row, col) = h(row, col);
  for (int i = 0; i < kFrames; ++i) {
    const SimulatedFrame& frame = Rendered().frames[static_cast<std::size_t>(i)];
    cv::Mat turned;
    cv::warpPerspective(frame.right, turned, homography, frame.right.size());
    cv::Mat pair;
    cv::hconcat(frame.image, turned, pair);
    Write("pairs/" + Name(i), pair);
  }
  const Eigen::Vector3d t = turn * Eigen::Vector3d(-5, 0, 0);
  WriteStereo(1.0, "[" + std::to_string(t.x()) + ", " + std::to_string(t.y()) + ", " + std::to_string(t.z()) + "]");
  const auto unrectified = Open();
  ASSERT_TRUE(unrectified.ok());
  const auto check_unrectified = CheckSequence(**unrectified);
  ASSERT_TRUE(check_unrectified.ok() && check_unrectified->stereo);
  EXPECT_GT(check_unrectified->stereo->median_row_error_px, kOtherRow_px) << "R says that they look alike";

  std::string r;
  for (int row = 0; row < 3; ++row)
    for (int col = 0; col < 3; ++col) r += (r.empty() ? "" : ", ") + std::to_string(turn(row, col));
  const std::string matrix = "[" + std::to_string(p[0]) + ", 0, " + std::to_string(p[2]) + ", 0, " +
                             std::to_string(p[1]) + ", " + std::to_string(p[3]) + ", 0, 0, 1]";
  Text("stereo.yaml", "M1: " + matrix + "\nD1: [0, 0, 0, 0]\nM2: " + matrix + "\nD2: [0, 0, 0, 0]\nR: [" + r +
                          "]\nT: [" + std::to_string(t.x()) + ", " + std::to_string(t.y()) + ", " +
                          std::to_string(t.z()) + "]\n");
  const auto sequence = Open();
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  EXPECT_NEAR((*sequence)->BaselineMm().value(), 5.0, kTextNumber);
  const auto check = CheckSequence(**sequence);
  ASSERT_TRUE(check.ok() && check->stereo);
  EXPECT_LT(check->stereo->median_row_error_px, kSameRow_px);
  EXPECT_GT(check->stereo->share_right_way, kNearlyAll);
}

TEST_F(StereoPairs, OfHamlynsRecordingsAreReadWithTheCalibrationThatIsShipped) {
  for (int k = 0; k < 2; ++k) Write("hamlyn/" + Name(k), Image(k, 1440, 288));
  auto sequence = OpenSequence({.image_path = Path("hamlyn"), .camera_path = PLIANT_HAMLYN_CALIBRATION});
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  const Camera& camera = (*sequence)->camera();
  EXPECT_EQ(camera.width(), 720);
  EXPECT_NEAR(camera.height(), 1.79 * 288, kHeight_px);
  // One published rectification of it: f 747.29, f times baseline 3886.37.
  EXPECT_NEAR(camera.params()[0], 747.29, kOtherRectification * 747.29);
  EXPECT_NEAR(camera.params()[0], camera.params()[1], kLengthRoundOff_mm);
  EXPECT_NEAR(camera.params()[0] * (*sequence)->BaselineMm().value(), 3886.37, kOtherRectification * 3886.37);
}

TEST_F(StereoPairs, AreMaskedWhereTheRawImageHasNothing) {
  WritePairs(/*top_bottom=*/false);
  WriteStereo(1.0, "[-5, 0.6, 0]");  // the rectified cameras are turned
  auto sequence = Open();
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  const auto frame = (*sequence)->Next();
  ASSERT_TRUE(frame.ok() && frame->has_value());
  ASSERT_FALSE((*frame)->mask.empty());
  const int masked = static_cast<int>((*frame)->mask.total()) - cv::countNonZero((*frame)->mask);
  EXPECT_GT(masked, kMinMasked);
  EXPECT_LT(masked, static_cast<int>((*frame)->mask.total()) / 2);
}

TEST_F(StereoPairs, ABaselineInMetersIsUnderstood) {
  WritePairs(/*top_bottom=*/false);
  WriteStereo(1.0, "[-0.005, 0, 0]");
  auto sequence = Open();
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  EXPECT_NEAR((*sequence)->BaselineMm().value(), 5.0, kLengthRoundOff_mm);
}

TEST_F(StereoPairs, ACalibrationThatCannotBeMeantIsRefused) {
  WritePairs(/*top_bottom=*/false);
  struct Case {
    std::string t, more;
    ErrorCode code;
    std::string said;
  };
  for (const Case& wrong : {Case{"[5, 0, 0]", "", ErrorCode::kInvalidArgument, "to the left of the left one"},
                            Case{"[0, 0, 0]", "", ErrorCode::kInvalidArgument, "no baseline"},
                            Case{"[0, -5, 0]", "", ErrorCode::kInvalidArgument, "one above the other"},
                            Case{"[-5, 0]", "", ErrorCode::kInvalidArgument, "9 and 2"},
                            Case{"[.nan, 0, 0]", "", ErrorCode::kInvalidArgument, "not a finite number"},
                            Case{"[-5, 0, 0]", "image_width: 200\nimage_height: 200\n", ErrorCode::kMismatch,
                                 "fits no image of 640x240"}}) {
    WriteStereo(1.0, wrong.t, wrong.more);
    const auto sequence = Open();
    ASSERT_FALSE(sequence.ok()) << wrong.said;
    EXPECT_EQ(sequence.status().code(), wrong.code) << sequence.status().message();
    EXPECT_THAT(sequence.status().message(), HasSubstr(wrong.said));
    EXPECT_THAT(sequence.status().message(), HasSubstr("stereo.yaml"));
  }
}

TEST_F(StereoPairs, ACalibrationOfTwoCamerasWithoutRAndTIsThatOfTheFirst) {
  for (int k = 0; k < 2; ++k) Write("pairs/" + Name(k), Image(k, 320, 240));
  Text("stereo.yaml",
       "M1: [230, 0, 159.5, 0, 230, 119.5, 0, 0, 1]\nD1: [0.1, 0, 0, 0]\nM2: [231, 0, 160, 0, 231, 120, 0, 0, 1]\n"
       "D2: [0, 0, 0, 0]\n");
  auto sequence = Open();
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  EXPECT_EQ((*sequence)->camera().model_name(), "OPENCV");
  EXPECT_FALSE((*sequence)->BaselineMm().has_value());
}

TEST_F(StereoPairs, AnImageOfAnotherSizeIsNamed) {
  WritePairs(/*top_bottom=*/false);
  Write("pairs/" + Name(3), cv::Mat(100, 100, CV_8UC3, cv::Scalar::all(9)));
  WriteStereo();
  auto sequence = Open();
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  for (int k = 0; k < 5; ++k) {
    const auto frame = (*sequence)->Next();
    EXPECT_EQ(frame.ok(), k != 3);
    if (k == 3) {
      EXPECT_THAT(frame.status().message(), HasSubstr("000003.png is 100x100"));
    }
  }
}

TEST_F(StereoPairs, ANativeSequenceWithoutOneOfItsRightImagesIsRefused) {
  RenderedSequence rendered;
  rendered.mono = false;
  ASSERT_TRUE(ConvertSequence(rendered, Path("seq")).ok());
  std::filesystem::remove(Path("seq/right/000007.png"));
  const auto sequence = OpenSequence({.image_path = Path("seq")});
  ASSERT_FALSE(sequence.ok());
  EXPECT_EQ(sequence.status().code(), ErrorCode::kNotFound);
  EXPECT_THAT(sequence.status().message(), HasSubstr("no right for the frame 000007.png"));
}

TEST_F(StereoPairs, AllThatASequenceHasComesBackFromItsNativeCopy) {
  RenderedSequence rendered;
  rendered.mono = false;
  const auto summary = ConvertSequence(rendered, Path("seq"));
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->frames, rendered.size());
  EXPECT_EQ(summary->depths, rendered.size());
  EXPECT_EQ(summary->poses, rendered.size());
  EXPECT_EQ(summary->masks, 0);
  auto sequence = OpenSequence({.image_path = Path("seq")});
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  for (int k = 0; k < rendered.size(); ++k) {
    const auto frame = (*sequence)->Next();
    ASSERT_TRUE(frame.ok() && frame->has_value());
    EXPECT_NEAR((*frame)->timestamp_s, k / 30.0, kTime_s);
    const auto depth = (*sequence)->Depth(k);
    ASSERT_TRUE(depth.ok() && depth->has_value());
    EXPECT_LT(cv::norm(**depth, Rendered().frames[static_cast<std::size_t>(k)].depth, cv::NORM_INF), kStep_mm);
    const Rigid3 error =
        (*sequence)->WorldFromCamera(k)->Inverse() * Rendered().world_from_cam[static_cast<std::size_t>(k)];
    EXPECT_LT(error.translation.norm() + RotationAngle(error.rotation), kNativePose);
  }
  // Poses with gaps keep their images.
  const std::filesystem::path file = Path("seq/groundtruth.txt");
  std::vector<TimedPose> poses = ReadTumTrajectory(file.string()).value();
  poses.erase(poses.begin() + 5, poses.begin() + 8);
  ASSERT_TRUE(WriteTumTrajectory(file.string(), poses).ok());
  sequence = OpenSequence({.image_path = Path("seq")});
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  const auto with_gaps = ConvertSequence(**sequence, Path("gaps"));
  ASSERT_TRUE(with_gaps.ok());
  EXPECT_EQ(with_gaps->poses, rendered.size() - 3);
  const auto read = OpenSequence({.image_path = Path("gaps")});
  ASSERT_TRUE(read.ok()) << read.status().message();
  for (int k = 0; k < rendered.size(); ++k) {
    const auto pose = (*read)->WorldFromCamera(k);
    ASSERT_EQ(pose.has_value(), k < 5 || k >= 8) << k;
    if (!pose) continue;
    EXPECT_LT((pose->translation - Rendered().world_from_cam[static_cast<std::size_t>(k)].translation).norm(),
              kNativePose);
  }

  const auto again = ConvertSequence(**sequence, Path("seq"));
  EXPECT_EQ(again.status().code(), ErrorCode::kInvalidArgument) << "the folder is not empty";
}

}  // namespace
}  // namespace pliant
