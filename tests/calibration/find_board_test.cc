// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/board/find_board.h"

#include <algorithm>
#include <iterator>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>
#if __has_include(<opencv2/aruco/charuco.hpp>)
#include <opencv2/aruco/charuco.hpp>
#endif

#include "pliant/base/statistics.h"
#include "support/board_views.h"

namespace pliant {
namespace {

const CalibrationBoard kBoardInView = {BoardKind::kChessboard, 7, 5, 2.0};

Camera CameraOf(int width, int height, double focal_px) {
  return Camera::Create("PINHOLE", width, height,
                        std::vector<double>{focal_px, focal_px, 0.5 * (width - 1), 0.5 * (height - 1)})
      .value();
}

// The distance of every corner from where it is; the order may be turned by half a turn.
std::vector<double> Errors(const BoardView& view, const Camera& camera, const Rigid3& cam_from_board) {
  const std::vector<Eigen::Vector3d> points = kBoardInView.Points();
  std::vector<double> forward;
  std::vector<double> backward;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d pixel = *camera.Project(cam_from_board * points[i]);
    forward.push_back((view.pixels[i] - pixel).norm());
    backward.push_back((view.pixels[points.size() - 1 - i] - pixel).norm());
  }
  return forward.front() < backward.front() ? forward : backward;
}

double LargestError(const BoardView& view, const Camera& camera, const Rigid3& cam_from_board) {
  return std::ranges::max(Errors(view, camera, cam_from_board));
}

TEST(FindBoard, FindsCornersToASmallPartOfAPixel) {
  // Of rendered images without noise; in the last one a square is 11 px wide.
  struct Case {
    int width;
    int height;
    double tolerance_px;
  };
  for (const auto& [width, height, tolerance_px] : {Case{640, 480, 0.15}, {1280, 960, 0.15}, {200, 150, 0.3}}) {
    const Camera camera = CameraOf(width, height, 0.8 * width);
    const Rigid3 pose = BoardPoseAt(kBoardInView, {1, -0.5, 22}, 0.4, 0.7);
    const auto view = FindBoard(ImageOf(kBoardInView, camera, pose), kBoardInView);
    ASSERT_TRUE(view.has_value()) << width;
    ASSERT_EQ(view->pixels.size(), 35u);
    EXPECT_LT(LargestError(*view, camera, pose), tolerance_px) << width;
  }
}

// Without noise the edges' rounding to gray levels is left.
TEST(FindBoard, FindsCornersToAFewHundredthsOfAPixelInTheMean) {
  constexpr double kMaxRms_px = 0.05;  // 0.03 px along either axis
  const Camera camera = CameraOf(640, 480, 500);
  std::vector<double> errors;
  for (const Rigid3& pose : VariedBoardPoses(kBoardInView, camera, 4, 3)) {
    const auto view = FindBoard(ImageOf(kBoardInView, camera, pose), kBoardInView);
    ASSERT_TRUE(view.has_value());
    std::ranges::copy(Errors(*view, camera, pose), std::back_inserter(errors));
  }
  EXPECT_LT(Rms(errors), kMaxRms_px);
}

TEST(FindBoard, FindsNothingInAnEmptyImage) {
  EXPECT_FALSE(FindBoard(cv::Mat(240, 320, CV_8UC1, cv::Scalar(0)), kBoardInView).has_value());
  EXPECT_FALSE(LargestChessboard(cv::Mat(240, 320, CV_8UC1, cv::Scalar(128))).has_value());
}

// Of 640 to 960 px, which is searched as it is.
TEST(FindBoard, LeavesTheImageAsItIs) {
  cv::Mat image(600, 800, CV_8UC1);
  cv::RNG(1).fill(image, cv::RNG::UNIFORM, 100, 156);
  const cv::Mat before = image.clone();
  EXPECT_FALSE(FindBoard(image, kBoardInView).has_value());
  EXPECT_EQ(cv::countNonZero(image != before), 0);
}

// OpenCV's search would take hours among them.
TEST(FindBoard, LooksForNoBoardOfCirclesAmongThousandsOfSpots) {
  cv::Mat image(900, 900, CV_8UC1, cv::Scalar(220));
  cv::RNG random(3);
  for (int y = 10; y < image.rows; y += 16)
    for (int x = 10; x < image.cols; x += 16)
      cv::circle(image, {x + random.uniform(-2, 3), y + random.uniform(-2, 3)}, 4, cv::Scalar(20), cv::FILLED);
  EXPECT_FALSE(FindBoard(image, {BoardKind::kCircles, 9, 6, 20.0}).has_value());
}

TEST(FindBoard, TellsHowLargeAChessboardIs) {
  const Camera camera = CameraOf(640, 480, 500);
  const cv::Mat image = ImageOf(kBoardInView, camera, BoardPoseAt(kBoardInView, {0, 0, 22}, 0.3, 0.7));
  EXPECT_EQ(LargestChessboard(image), (ChessboardSize{7, 5}));
}

TEST(FindBoard, TellsHowLargeAChessboardIsByASmallerCopy) {
  const Camera camera = CameraOf(1600, 1200, 1250);
  const cv::Mat large = ImageOf(kBoardInView, camera, BoardPoseAt(kBoardInView, {0, 0, 22}, 0.3, 0.7));
  const cv::Mat smaller = AsSearched(large);
  EXPECT_LT(smaller.total(), large.total() / 2);
  EXPECT_EQ(LargestChessboard(smaller), (ChessboardSize{7, 5}));
  EXPECT_EQ(AsSearched(smaller).size(), smaller.size());
}

TEST(FindBoard, FindsCircles) {
  for (const BoardKind kind : {BoardKind::kCircles, BoardKind::kAsymmetricCircles}) {
    const CalibrationBoard board = {kind, 4, 7, 40.0};
    cv::Mat image(480, 640, CV_8UC1, cv::Scalar(255));
    for (const Eigen::Vector3d& point : board.Points())
      cv::circle(image, cv::Point(120 + static_cast<int>(point.x()), 80 + static_cast<int>(point.y())), 12,
                 cv::Scalar(0), cv::FILLED, cv::LINE_AA);
    const auto view = FindBoard(image, board);
    ASSERT_TRUE(view.has_value()) << EnumName(kind);
    EXPECT_EQ(view->pixels.size(), 28u);
  }
}

TEST(FindBoard, TellsHowLargeAGridOfCirclesIs) {
  const CalibrationBoard board = {BoardKind::kCircles, 5, 7, 40.0};
  cv::Mat image(480, 640, CV_8UC1, cv::Scalar(255));
  for (const Eigen::Vector3d& point : board.Points())
    cv::circle(image, cv::Point(120 + static_cast<int>(point.x()), 80 + static_cast<int>(point.y())), 12, cv::Scalar(0),
               cv::FILLED, cv::LINE_AA);
  const auto larger = LargerCircles(image, {BoardKind::kCircles, 4, 7, 40.0});
  ASSERT_TRUE(larger.has_value());
  EXPECT_EQ(larger->columns, 5);
  EXPECT_EQ(larger->rows, 7);
  EXPECT_FALSE(LargerCircles(image, board).has_value());
}

#if __has_include(<opencv2/aruco/charuco.hpp>)

// 8 x 5 squares of 50 px within a white rim of 40 px.
cv::Mat CharucoImage() {
  const auto pattern =
      cv::aruco::CharucoBoard::create(8, 5, 10, 7, cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_100));
  cv::Mat large;
  pattern->draw({1600, 1000}, large);
  cv::Mat small;
  cv::Mat image;
  cv::resize(large, small, {400, 250}, 0, 0, cv::INTER_AREA);
  cv::copyMakeBorder(small, image, 40, 40, 40, 40, cv::BORDER_CONSTANT, cv::Scalar(255));
  return image;
}

TEST(FindBoard, FindsCornersOfCharucoBoardsWhereTheyAre) {
  const auto view = FindBoard(CharucoImage(), {BoardKind::kCharuco, 7, 4, 10.0, 7.0, "5X5_100"});
  ASSERT_TRUE(view.has_value());
  ASSERT_EQ(view->pixels.size(), 28u);
  for (const Eigen::Vector2d& pixel : view->pixels) {
    const Eigen::Array2d from_first = (pixel.array() - (40 + 50 - 0.5)) / 50;
    EXPECT_LT((50 * (from_first - from_first.round())).abs().maxCoeff(), 0.1) << pixel.transpose();
  }
}

TEST(FindBoard, TellsACharucoBoardOfAnotherSize) {
  const cv::Mat image = CharucoImage();
  for (const auto& [columns, rows] : {std::pair(7, 3), std::pair(4, 7), std::pair(6, 4), std::pair(8, 4)})
    EXPECT_TRUE(ShowsOtherMarkers(image, {BoardKind::kCharuco, columns, rows, 10.0, 7.0, "5X5_100"}))
        << columns << "x" << rows;
  EXPECT_FALSE(ShowsOtherMarkers(image, {BoardKind::kCharuco, 7, 4, 10.0, 7.0, "5X5_100"}));
  EXPECT_FALSE(ShowsOtherMarkers(cv::Mat(300, 300, CV_8UC1, cv::Scalar(200)),
                                 {BoardKind::kCharuco, 7, 4, 10.0, 7.0, "5X5_100"}));
}

TEST(FindBoard, NamesTheCharucoBoardThatIsSeen) {
  const cv::Mat image = CharucoImage();
  for (const auto& [columns, rows] : {std::pair(7, 3), std::pair(4, 7), std::pair(6, 4), std::pair(8, 4)}) {
    const auto seen = SimilarBoard(image, {BoardKind::kCharuco, columns, rows, 10.0, 7.0, "5X5_100"});
    ASSERT_TRUE(seen.has_value()) << columns << "x" << rows;
    EXPECT_EQ(seen->Text(), "charuco:8x5:10:7:5X5_100");
  }
  const auto of_other_markers = SimilarBoard(image, {BoardKind::kCharuco, 7, 4, 10.0, 7.0, "4X4_50"});
  ASSERT_TRUE(of_other_markers.has_value());
  EXPECT_EQ(of_other_markers->Text(), "charuco:8x5:10:7:5X5_50");  // the smallest dictionary that has these markers
  EXPECT_FALSE(SimilarBoard(image, {BoardKind::kCharuco, 7, 4, 10.0, 7.0, "5X5_100"}));
}

#endif

TEST(FindBoard, NamesTheCirclesThatAreSeen) {
  const auto image_of = [](const CalibrationBoard& board) {
    cv::Mat image(480, 640, CV_8UC1, cv::Scalar(255));
    for (const Eigen::Vector3d& point : board.Points())
      cv::circle(image, cv::Point(120 + static_cast<int>(point.x()), 80 + static_cast<int>(point.y())), 12,
                 cv::Scalar(0), cv::FILLED, cv::LINE_AA);
    return image;
  };
  const CalibrationBoard symmetric = {BoardKind::kCircles, 5, 7, 40.0};
  const CalibrationBoard asymmetric = {BoardKind::kAsymmetricCircles, 4, 7, 40.0};
  for (const CalibrationBoard& given : {CalibrationBoard{BoardKind::kAsymmetricCircles, 5, 7, 40.0},
                                        CalibrationBoard{BoardKind::kCircles, 7, 8, 40.0}}) {
    const auto seen = SimilarBoard(image_of(symmetric), given);
    ASSERT_TRUE(seen.has_value()) << given.Title();
    EXPECT_EQ(seen->kind, BoardKind::kCircles) << given.Title();
    EXPECT_EQ(seen->NumPoints(), 35) << given.Title();
  }
  const auto seen = SimilarBoard(image_of(asymmetric), {BoardKind::kAsymmetricCircles, 7, 4, 40.0});
  ASSERT_TRUE(seen.has_value());
  EXPECT_EQ(seen->Text(), "acircles:4x7:40");
}

TEST(FindBoard, NamesTheNearestDictionaryOrAllOfThem) {
  const auto message = [](const std::string& dictionary) {
    return CheckBoardIsSupported({BoardKind::kCharuco, 7, 4, 10.0, 7.0, dictionary}).message();
  };
  const auto no_aruco = testing::HasSubstr("aruco");
  EXPECT_THAT(message("5X5_101"), testing::AnyOf(testing::HasSubstr("did you mean 5X5_100?"), no_aruco));
  EXPECT_THAT(message("FOO"), testing::AnyOf(testing::HasSubstr("give one of 4X4_50, 4X4_100, "), no_aruco));
}

}  // namespace
}  // namespace pliant
