// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/calibration/calibrate_camera.h"

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/board_views.h"

namespace pliant {
namespace {

struct Lens {
  ModelChoice choice;
  std::string model;
  std::vector<double> params;
};

// A narrow, a wide and a very wide lens among them.
const std::vector<Lens> kLenses = {
    {ModelChoice::kSimplePinhole, "SIMPLE_PINHOLE", {520, 321, 238}},
    {ModelChoice::kPinhole, "PINHOLE", {900, 880, 310, 251}},
    {ModelChoice::kSimpleRadial, "SIMPLE_RADIAL", {480, 330, 236, -0.15}},
    {ModelChoice::kRadial, "RADIAL", {450, 315, 244, -0.28, 0.07}},
    {ModelChoice::kOpenCv, "OPENCV", {470, 465, 325, 231, -0.25, 0.06, 0.001, -0.0008}},
    {ModelChoice::kOpenCvFisheye, "OPENCV_FISHEYE", {260, 262, 322, 243, -0.02, 0.004, -0.001, 0.0002}},
};

Camera Make(const Lens& lens) { return Camera::Create(lens.model, 640, 480, lens.params).value(); }

std::vector<BoardView> Views(const Camera& camera, int count, double noise_px, std::uint64_t seed) {
  return ViewsOf(kChessboard9x6, camera, VariedBoardPoses(kChessboard9x6, camera, count, seed), noise_px, seed + 1);
}

// The largest distance between what two cameras make of the rays of pixels of the first one, within the circle
// inscribed in the image.
double LargestDifference(const Camera& camera, const Camera& other) {
  double largest = 0;
  for (double y = 10; y < camera.height(); y += 20) {
    for (double x = 10; x < camera.width(); x += 20) {
      const Eigen::Vector2d pixel(x, y);
      if ((pixel - Eigen::Vector2d(320, 240)).norm() > 230) continue;
      const auto ray = camera.Unproject(pixel);
      const auto seen = ray ? other.Project(*ray) : std::nullopt;
      if (!seen) return std::numeric_limits<double>::infinity();
      largest = std::max(largest, (*seen - pixel).norm());
    }
  }
  return largest;
}

TEST(CalibrateCamera, RecoversEveryModelExactlyWithoutNoise) {
  for (const Lens& lens : kLenses) {
    const Camera camera = Make(lens);
    const std::vector<BoardView> views = Views(camera, 14, 0, 3);
    const auto calibration = CalibrateCamera(kChessboard9x6, views, 640, 480, lens.choice, 2);
    ASSERT_TRUE(calibration.ok()) << lens.model << ": " << calibration.status().message();
    EXPECT_EQ(calibration->camera.model_name(), lens.model);
    EXPECT_LT(LargestDifference(camera, calibration->camera), 1e-3) << lens.model;
    EXPECT_LT(calibration->rms_px, 1e-4) << lens.model;
  }
}

TEST(CalibrateCamera, KnowsHowFarItIsOff) {
  // Errors by their standard deviations: at most three, and about one in the mean over lenses and parameters.
  double sum = 0;
  int count = 0;
  for (const Lens& lens : kLenses) {
    const Camera camera = Make(lens);
    const std::vector<BoardView> views = Views(camera, 20, 0.1, 11);
    const auto calibration = CalibrateCamera(kChessboard9x6, views, 640, 480, lens.choice, 2);
    ASSERT_TRUE(calibration.ok()) << lens.model;
    // Of a fisheye the last coefficients may be left at 0, and the others of the distortion then differ from the truth.
    const std::size_t compared = lens.choice == ModelChoice::kOpenCvFisheye ? 4 : lens.params.size();
    for (std::size_t i = 0; i < compared; ++i) {
      const double error = (calibration->camera.params()[i] - lens.params[i]) / calibration->sigmas[i];
      EXPECT_LT(std::abs(error), 4) << lens.model << " " << i;
      sum += error * error;
      ++count;
    }
  }
  const double rms = std::sqrt(sum / count);
  EXPECT_GT(rms, 0.3);
  EXPECT_LT(rms, 1.5);
}

TEST(CalibrateCamera, ChoosesAModelThatDescribesTheLens) {
  for (const Lens& lens : kLenses) {
    const Camera camera = Make(lens);
    const auto calibration =
        CalibrateCamera(kChessboard9x6, Views(camera, 20, 0.1, 5), 640, 480, ModelChoice::kAuto, 2);
    ASSERT_TRUE(calibration.ok()) << lens.model << ": " << calibration.status().message();
    // About three standard deviations of what 20 views with this noise determine at the border.
    EXPECT_LT(LargestDifference(camera, calibration->camera), 1.0)
        << lens.model << " as " << calibration->camera.model_name();
  }
}

TEST(CalibrateCamera, TakesNoMoreParametersThanItNeeds) {
  const Camera camera = Make(kLenses[0]);
  const auto calibration = CalibrateCamera(kChessboard9x6, Views(camera, 20, 0.1, 5), 640, 480, ModelChoice::kAuto, 2);
  ASSERT_TRUE(calibration.ok());
  EXPECT_EQ(calibration->camera.model_id(), CameraModelId::kSimplePinhole);
}

// A detector whose corners are drawn by a tenth of a pixel towards the image's border makes no other lens.
TEST(CalibrateCamera, TakesNoMoreParametersForWhatTheDetectorDoes) {
  constexpr double kDrawn_px = 0.12;
  const Camera camera = Make(kLenses[1]);
  std::vector<BoardView> views = Views(camera, 20, 0.05, 5);
  for (BoardView& view : views)
    for (Eigen::Vector2d& pixel : view.pixels) {
      const Eigen::Vector2d from_center = (pixel - Eigen::Vector2d(320, 240)) / 400;
      pixel += kDrawn_px * from_center.squaredNorm() * from_center;
    }
  const auto calibration = CalibrateCamera(kChessboard9x6, views, 640, 480, ModelChoice::kAuto, 2);
  ASSERT_TRUE(calibration.ok());
  EXPECT_EQ(calibration->camera.model_id(), CameraModelId::kPinhole);
}

TEST(CalibrateCamera, LeavesOutAViewThatFitsBadly) {
  const Camera camera = Make(kLenses[3]);
  std::vector<BoardView> views = Views(camera, 14, 0.05, 5);
  Random random(2);
  for (Eigen::Vector2d& pixel : views[4].pixels) pixel += Eigen::Vector2d(random.Normal(3), random.Normal(3));
  const auto calibration = CalibrateCamera(kChessboard9x6, views, 640, 480, ModelChoice::kRadial, 2);
  ASSERT_TRUE(calibration.ok());
  for (std::size_t i = 0; i < views.size(); ++i) EXPECT_EQ(calibration->views[i].is_outlier, i == 4) << i;
  EXPECT_LT(LargestDifference(camera, calibration->camera), 0.7);
}

TEST(CalibrateCamera, IsTheSameWithOneThreadAndWithTwo) {
  const std::vector<BoardView> views = Views(Make(kLenses[4]), 12, 0.1, 5);
  const auto one = CalibrateCamera(kChessboard9x6, views, 640, 480, ModelChoice::kAuto, 1);
  const auto two = CalibrateCamera(kChessboard9x6, views, 640, 480, ModelChoice::kAuto, 2);
  ASSERT_TRUE(one.ok() && two.ok());
  ASSERT_EQ(one->camera.model_id(), two->camera.model_id());
  for (std::size_t i = 0; i < one->sigmas.size(); ++i) {
    EXPECT_EQ(one->camera.params()[i], two->camera.params()[i]);
    EXPECT_EQ(one->sigmas[i], two->sigmas[i]);
  }
}

TEST(CalibrateCamera, RefusesViewsOfOnePose) {
  const Camera camera = Make(kLenses[0]);
  const Rigid3 pose = BoardPoseAt(kChessboard9x6, {0, 0, 25}, 0, 0);
  const std::vector<BoardView> views = ViewsOf(kChessboard9x6, camera, std::vector<Rigid3>(10, pose), 0.1, 5);
  const auto calibration = CalibrateCamera(kChessboard9x6, views, 640, 480, ModelChoice::kAuto, 2);
  ASSERT_FALSE(calibration.ok());
  EXPECT_EQ(calibration.status().code(), ErrorCode::kInsufficient);
  EXPECT_THAT(calibration.status().message(), testing::HasSubstr("tilted"));
}

// Of a lens with distortion, whose curve a fisheye model takes for its own.
TEST(CalibrateCamera, RefusesViewsOfABoardThatIsNeverTilted) {
  const Camera camera = Camera::Create("RADIAL", 640, 480, std::vector<double>{500, 323.5, 236.5, -0.25, 0.08}).value();
  Random random(3);
  std::vector<Rigid3> poses;
  while (poses.size() < 16) {
    const Eigen::Vector3d center(random.Uniform(-8.0, 8.0), random.Uniform(-6.0, 6.0), random.Uniform(24.0, 40.0));
    const Rigid3 pose = BoardPoseAt(kChessboard9x6, center, random.Uniform(0.0, 0.03), random.Uniform(0.0, 6.28));
    const auto points = kChessboard9x6.Points();
    if (std::ranges::all_of(points, [&](const Eigen::Vector3d& point) {
          const auto pixel = camera.Project(pose * point);
          return pixel && camera.Contains(*pixel, 4);
        }))
      poses.push_back(pose);
  }
  const auto calibration =
      CalibrateCamera(kChessboard9x6, ViewsOf(kChessboard9x6, camera, poses, 0.02, 5), 640, 480, ModelChoice::kAuto, 2);
  ASSERT_FALSE(calibration.ok()) << calibration->camera.MeanFocalLengthPx();
  EXPECT_THAT(calibration.status().message(), testing::HasSubstr("tilted"));
}

TEST(CalibrateCamera, RefusesTooFewViews) {
  const auto calibration =
      CalibrateCamera(kChessboard9x6, Views(Make(kLenses[0]), 2, 0.1, 5), 640, 480, ModelChoice::kPinhole, 1);
  ASSERT_FALSE(calibration.ok());
  EXPECT_EQ(calibration.status().code(), ErrorCode::kInsufficient);
}

}  // namespace
}  // namespace pliant
