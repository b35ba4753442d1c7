// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/pipeline/calibrate_images.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "pliant/base/files.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/io/camera_file.h"
#include "support/board_views.h"
#include "support/temporary_folder.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const CalibrationBoard kBoard = {BoardKind::kChessboard, 7, 5, 2.0};
const Camera kCamera = Camera::Create("RADIAL", 480, 360, std::vector<double>{400, 236, 181, -0.2, 0.05}).value();

class CalibrateImagesTest : public testing::Test {
 protected:
  // Images of the board from `count` sides, after which come those that are given.
  CalibrateRequest Request(int count, const std::vector<cv::Mat>& others = {}) {
    std::vector<cv::Mat> images;
    for (const Rigid3& pose : VariedBoardPoses(kBoard, kCamera, count, 7))
      images.push_back(ImageOf(kBoard, kCamera, pose));
    images.insert(images.end(), others.begin(), others.end());
    fs::create_directories(folder_ / "boards");
    int number = 10;
    for (const cv::Mat& image : images)
      cv::imwrite(folder_ / "boards" / ("board_" + std::to_string(number++) + ".png"), image);
    return {folder_ / "boards", kBoard, folder_ / "camera.yaml"};
  }

  static Result<CalibrateSummary> Calibrate(const CalibrateRequest& request, const CalibrateOptions& options = {}) {
    return CalibrateImages(request, options, {});
  }

  // Says `part`, and leaves camera.yaml as it was.
  void ExpectFailure(const CalibrateRequest& request, ErrorCode code, const std::string& part) {
    ASSERT_TRUE(WriteFileAtomically(request.output_path, "before").ok());
    CalibrateRequest overwriting = request;
    overwriting.existing = ExistingFile::kOverwrite;
    const auto summary = Calibrate(overwriting);
    ASSERT_FALSE(summary.ok());
    EXPECT_EQ(summary.status().code(), code);
    EXPECT_THAT(summary.status().message(), HasSubstr(part));
    EXPECT_EQ(ReadFile(request.output_path).value(), "before");
  }

  const TemporaryFolder temporary_ = TemporaryFolder("calibrate");
  const fs::path folder_ = temporary_.Path("");
};

TEST_F(CalibrateImagesTest, WritesTheCamera) {
  const cv::Mat empty(360, 480, CV_8UC1, cv::Scalar(128));
  const auto summary = Calibrate(Request(12, {empty}));
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  const auto file = ReadCameraFile(folder_ / "camera.yaml");
  ASSERT_TRUE(file.ok()) << file.status().message();
  constexpr double kFocalTolerance = 0.003;  // of the focal length
  constexpr double kCenterTolerance_px = 1.0;
  EXPECT_NEAR(file->camera.MeanFocalLengthPx(), 400, 400 * kFocalTolerance);
  const auto center = file->camera.Project(Eigen::Vector3d(0, 0, 1));
  EXPECT_LT((*center - Eigen::Vector2d(236, 181)).norm(), kCenterTolerance_px);
  EXPECT_EQ(summary->images_read, 13);
  ASSERT_EQ(summary->images.size(), 13u);
  EXPECT_EQ(summary->images[0].name, "board_10.png");
  EXPECT_EQ(summary->images[0].use, ImageUse::kUsed);
  EXPECT_EQ(summary->images[12].use, ImageUse::kNoBoard);
  EXPECT_GT(summary->covered_share, 0.4);
}

TEST_F(CalibrateImagesTest, SearchesTheSharpestImageOfEveryStretch) {
  CalibrateRequest request = Request(0);
  int number = 0;
  for (const Rigid3& pose : VariedBoardPoses(kBoard, kCamera, 8, 7)) {
    const cv::Mat sharp = ImageOf(kBoard, kCamera, pose);
    cv::Mat blurred;
    cv::GaussianBlur(sharp, blurred, {}, 3);
    for (int i = 0; i < 4; ++i)
      cv::imwrite(folder_ / "boards" / (std::to_string(100 + number++) + ".png"), i == 2 ? sharp : blurred);
  }
  CalibrateOptions options;
  options.max_images = 8;
  options.model = ModelChoice::kSimpleRadial;
  const auto summary = Calibrate(request, options);
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->images_read, 32);
  ASSERT_EQ(summary->images.size(), 8u);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(summary->images[i].name, std::to_string(102 + 4 * i) + ".png");
}

TEST_F(CalibrateImagesTest, NamesTheSizeOfABoardThatWasGivenTooSmall) {
  CalibrateRequest request = Request(6);
  request.board = {BoardKind::kChessboard, 5, 4, 2.0};
  ExpectFailure(request, ErrorCode::kInsufficient, "chessboard:7x5:2");
}

TEST_F(CalibrateImagesTest, NamesTheSizeOfABoardThatWasGivenTooLarge) {
  CalibrateRequest request = Request(6);
  request.board = {BoardKind::kChessboard, 9, 6, 2.0};
  ExpectFailure(request, ErrorCode::kInsufficient, "chessboard:7x5:2");
}

// Most images fail the search for the wrong size, and show the right one.
TEST_F(CalibrateImagesTest, NamesTheSizeOfABoardThatFewImagesShowAsItWasGiven) {
  CalibrateRequest request = Request(8);
  request.board = {BoardKind::kChessboard, 6, 5, 2.0};
  ExpectFailure(request, ErrorCode::kInsufficient, "chessboard:7x5:2");
}

TEST_F(CalibrateImagesTest, KeepsAFileThatIsThere) {
  const CalibrateRequest request = Request(1);
  ASSERT_TRUE(WriteFileAtomically(request.output_path, "before").ok());
  const auto summary = Calibrate(request);
  ASSERT_FALSE(summary.ok());
  EXPECT_THAT(summary.status().message(), HasSubstr("is there already"));
  EXPECT_EQ(summary.status().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(ReadFile(request.output_path).value(), "before");
  EXPECT_THAT(CheckCalibrationOutput(folder_ / "none/camera.yaml", ExistingFile::kKeep).message(),
              HasSubstr("there is no folder"));
}

TEST_F(CalibrateImagesTest, RefusesImagesWithoutABoard) {
  const CalibrateRequest request = Request(0, {cv::Mat(360, 480, CV_8UC1, cv::Scalar(0))});
  ExpectFailure(request, ErrorCode::kInsufficient,
                "the chessboard of 7x5 inner corners (2 mm apart) is not in the only image of '");
}

TEST_F(CalibrateImagesTest, RefusesOneImage) {
  ExpectFailure(Request(1), ErrorCode::kInsufficient, "add images of the board from other sides");
}

TEST_F(CalibrateImagesTest, RefusesImagesThatAreAllAlike) {
  const Rigid3 pose = BoardPoseAt(kBoard, {0, 0, 22}, 0.3, 0.5);
  const cv::Mat image = ImageOf(kBoard, kCamera, pose);
  ExpectFailure(Request(0, {image, image, image, image, image}), ErrorCode::kInsufficient,
                "in one image, or in images that are alike");
}

TEST_F(CalibrateImagesTest, RefusesImagesOfDifferentSizes) {
  const CalibrateRequest request = Request(3, {cv::Mat(240, 320, CV_8UC1, cv::Scalar(0))});
  ExpectFailure(request, ErrorCode::kMismatch, "is 320x240 and");
}

TEST_F(CalibrateImagesTest, SaysWhereThereIsNothing) {
  const CalibrateRequest request = {folder_ / "none", kBoard, folder_ / "camera.yaml"};
  ExpectFailure(request, ErrorCode::kNotFound, "none");
}

TEST_F(CalibrateImagesTest, EndsOnRequest) {
  const CalibrateRequest request = Request(3);
  for (const std::string_view last : {"search", "size", "start", "fit", "check"}) {
    const auto summary = CalibrateImages(request, {}, [&](std::string_view task, int, int) { return task != last; });
    ASSERT_FALSE(summary.ok()) << last;
    EXPECT_EQ(summary.status().code(), ErrorCode::kInterrupted) << last;
    EXPECT_EQ(summary.status().message(), "stopped on request; nothing was written");
    EXPECT_FALSE(Exists(request.output_path));
  }
}

// Pairs of images, of both cameras, of which the right one is 6 mm to the right.
class CalibratePairsTest : public CalibrateImagesTest {
 protected:
  static constexpr double kBaseline_mm = 6;
  static constexpr std::size_t kPairs = 8;

  struct Images {
    std::vector<cv::Mat> left;
    std::vector<cv::Mat> right;
  };

  // Rendered once for all tests.
  static const Images& AllImages() {
    static const Images images = [] {
      const Rigid3 right_from_left(Eigen::Quaterniond::Identity(), Eigen::Vector3d(-kBaseline_mm, 0, 0));
      Images rendered;
      for (const Rigid3& pose : VariedBoardPoses(kBoard, kCamera, 40, 7)) {
        const auto is_seen = [&](const Eigen::Vector3d& point) {
          const auto pixel = kCamera.Project(right_from_left * (pose * point));
          return pixel && kCamera.Contains(*pixel, 8);
        };
        if (rendered.left.size() == kPairs || !std::ranges::all_of(kBoard.Points(), is_seen)) continue;
        rendered.left.push_back(ImageOf(kBoard, kCamera, pose));
        rendered.right.push_back(ImageOf(kBoard, kCamera, right_from_left * pose));
      }
      return rendered;
    }();
    return images;
  }

  // In left/ and right/, and beside each other in both/.
  void SetUp() override {
    for (const char* name : {"left", "right", "both"}) fs::create_directories(folder_ / name);
    const Images& images = AllImages();
    for (std::size_t i = 0; i < images.left.size(); ++i) {
      cv::Mat both;
      cv::hconcat(images.left[i], images.right[i], both);
      const std::string name = std::to_string(10 + i) + ".png";
      cv::imwrite(folder_ / "left" / name, images.left[i]);
      cv::imwrite(folder_ / "right" / name, images.right[i]);
      cv::imwrite(folder_ / "both" / name, both);
    }
  }

  CalibrateRequest Apart() const {
    return {.image_path = folder_ / "left",
            .board = kBoard,
            .output_path = folder_ / "stereo.yaml",
            .right_path = folder_ / "right"};
  }

  static Result<CalibratePairsSummary> Pairs(const CalibrateRequest& request) {
    return CalibratePairs(request, {.model = ModelChoice::kRadial}, {});
  }
};

TEST_F(CalibratePairsTest, WritesAStereoCalibrationThatSequencesTake) {
  const auto summary = Pairs(Apart());
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_NEAR(summary->stereo.BaselineMm(), kBaseline_mm, 0.05);
  const auto file = ReadStereoCalibration(folder_ / "stereo.yaml");
  ASSERT_TRUE(file.ok()) << file.status().message();
  ASSERT_TRUE(file->has_value());
  EXPECT_LT(((*file)->right_from_left.translation - summary->stereo.right_from_left.translation).norm(), 1e-9);
  EXPECT_NEAR((*file)->left.fx, 400, 1.2);
  EXPECT_EQ((*file)->image_size->width, 480);
  CalibrateRequest both = Apart();
  both.image_path = folder_ / "both";
  both.right_path.clear();
  both.pairs = PairLayout::kLeftRight;
  both.existing = ExistingFile::kOverwrite;
  const auto of_both = Pairs(both);
  ASSERT_TRUE(of_both.ok()) << of_both.status().message();
  EXPECT_EQ(of_both->stereo.BaselineMm(), summary->stereo.BaselineMm());
  const auto sequence = OpenSequence({.image_path = folder_ / "both", .camera_path = folder_ / "stereo.yaml"});
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  ASSERT_TRUE((*sequence)->BaselineMm().has_value());
  EXPECT_NEAR(*(*sequence)->BaselineMm(), kBaseline_mm, 0.05);
}

TEST_F(CalibratePairsTest, WrongPairsAreASentenceAndNoFile) {
  fs::remove(folder_ / "right" / "17.png");
  const auto unequal = Pairs(Apart());
  ASSERT_FALSE(unequal.ok());
  EXPECT_EQ(unequal.status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(unequal.status().message(), HasSubstr("left' has 8 images and "));
  CalibrateRequest exchanged = Apart();
  fs::remove(folder_ / "left" / "17.png");
  std::swap(exchanged.image_path, exchanged.right_path);
  const auto wrong = Pairs(exchanged);
  ASSERT_FALSE(wrong.ok());
  EXPECT_THAT(wrong.status().message(), HasSubstr("exchange the two"));
  EXPECT_FALSE(fs::exists(folder_ / "stereo.yaml"));
}

}  // namespace
}  // namespace pliant
