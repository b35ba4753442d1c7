// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/viewer/calibration_figure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "pliant/base/files.h"
#include "support/board_views.h"
#include "support/temporary_folder.h"

namespace pliant {
namespace {

const CalibrationBoard kBoard = {BoardKind::kChessboard, 9, 6, 2.0};

CalibrateSummary Summary() {
  const Camera camera = Camera::Create("SIMPLE_RADIAL", 640, 480, std::vector<double>{500, 320, 240, -0.1}).value();
  const auto views = ViewsOf(kBoard, camera, VariedBoardPoses(kBoard, camera, 8, 3), 0.3, 1);
  CalibrateSummary summary{.calibration =
                               CalibrateCamera(kBoard, views, 640, 480, ModelChoice::kSimpleRadial, 1).value()};
  summary.views = views;
  return summary;
}

// Pixels in which red stands out, as in the lines of errors.
int CountRed(const cv::Mat& picture) {
  int count = 0;
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const auto& color = picture.at<cv::Vec3b>(y, x);
      count += color[2] > color[0] + 80 && color[2] > color[1] + 60 ? 1 : 0;
    }
  }
  return count;
}

TEST(CalibrationFigure, ShowsTheErrorOfEveryPoint) {
  const TemporaryFolder folder("calibration_figure");
  CalibrateSummary summary = Summary();
  ASSERT_TRUE(WriteCalibrationFigure(summary, folder.Path("with.png")).ok());
  for (FittedView& view : summary.calibration.views)
    for (Eigen::Vector2d& residual : view.residuals_px) residual.setZero();
  ASSERT_TRUE(WriteCalibrationFigure(summary, folder.Path("without.png")).ok());
  const cv::Mat with = cv::imread(folder.Path("with.png"));
  const cv::Mat without = cv::imread(folder.Path("without.png"));
  ASSERT_FALSE(with.empty());
  EXPECT_EQ(with.size(), without.size());
  EXPECT_GT(CountRed(with), 2 * CountRed(without));
}

TEST(CalibrationFigure, IsAlsoAVectorDrawing) {
  const TemporaryFolder folder("calibration_figure_vector");
  ASSERT_TRUE(WriteCalibrationFigure(Summary(), folder.Path("a.svg")).ok());
  EXPECT_THAT(ReadFile(folder.Path("a.svg")).value(), testing::HasSubstr("<svg"));
  ASSERT_TRUE(WriteCalibrationFigure(Summary(), folder.Path("a.pdf")).ok());
  EXPECT_THAT(ReadFile(folder.Path("a.pdf")).value(), testing::StartsWith("%PDF"));
}

// Pixels of the bars that are black: letters.
int CountBlackInBars(const cv::Mat& picture) {
  constexpr int kBarsAndGap = 170;  // without the line of text above
  int count = 0;
  for (int y = picture.rows - kBarsAndGap; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) count += cv::norm(picture.at<cv::Vec3b>(y, x)) < 90 ? 1 : 0;
  return count;
}

TEST(CalibrationFigure, WritesTheErrorOnABarThatIsCut) {
  const TemporaryFolder folder("calibration_figure_bars");
  CalibrateSummary summary = Summary();
  ASSERT_TRUE(WriteCalibrationFigure(summary, folder.Path("whole.png")).ok());
  summary.calibration.views[2].is_outlier = true;
  summary.calibration.views[2].rms_px = 19.52;
  ASSERT_TRUE(WriteCalibrationFigure(summary, folder.Path("cut.png")).ok());
  EXPECT_EQ(CountBlackInBars(cv::imread(folder.Path("whole.png"))), 0);
  EXPECT_GT(CountBlackInBars(cv::imread(folder.Path("cut.png"))), 10);
}

TEST(CalibrationFigure, RefusesAnotherEnding) {
  const Status status = WriteCalibrationFigure(Summary(), "a.gif");
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.code(), ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace pliant
