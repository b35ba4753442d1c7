// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/calibration/calibrate_stereo.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/board_views.h"

namespace pliant {
namespace {

using testing::HasSubstr;

const Camera kLeft =
    Camera::Create("OPENCV", 640, 480, std::vector<double>{520, 523, 322, 236, -0.2, 0.05, 1e-3, -1e-3}).value();
const Camera kRight = Camera::Create("RADIAL", 640, 480, std::vector<double>{515, 310, 245, -0.18, 0.04}).value();
// The right camera's center at (4.2, 0.1, -0.05) mm of the left one.
const Rigid3 kRightFromLeft = [] {
  const Eigen::Quaterniond rotation = RotationExp({0.002, -0.03, 0.01});
  return Rigid3(rotation, rotation * Eigen::Vector3d(-4.2, -0.1, 0.05));
}();

constexpr double kNoise_px = 0.1;
constexpr double kFewSigmas = 5;

struct Pairs {
  std::vector<BoardView> left;
  std::vector<BoardView> right;
};

// Moments in which both cameras see the whole board.
Pairs MakePairs(int count, double noise_px, const Rigid3& right_from_left = kRightFromLeft) {
  Random random(3);
  Pairs pairs;
  for (const Rigid3& pose : VariedBoardPoses(kChessboard9x6, kLeft, 4 * count, 5)) {
    const bool is_seen = std::ranges::all_of(kChessboard9x6.Points(), [&](const Eigen::Vector3d& point) {
      const auto pixel = kRight.Project(right_from_left * (pose * point));
      return pixel && kRight.Contains(*pixel, 2);
    });
    if (!is_seen || static_cast<int>(pairs.left.size()) == count) continue;
    pairs.left.push_back(ViewOf(kChessboard9x6, kLeft, pose, noise_px, &random));
    pairs.right.push_back(ViewOf(kChessboard9x6, kRight, right_from_left * pose, noise_px, &random));
  }
  return pairs;
}

Result<StereoCameras> Calibrate(const Pairs& pairs) {
  return CalibrateStereo(kChessboard9x6, kLeft, kRight, pairs.left, pairs.right, 2);
}

double AngleDeg(const Rigid3& a, const Rigid3& b) {
  return kDegPerRad * RotationAngle(a.rotation * b.rotation.conjugate());
}

TEST(CalibrateStereo, FindsHowTheCamerasAreMounted) {
  const Pairs pairs = MakePairs(14, kNoise_px);
  ASSERT_EQ(pairs.left.size(), 14U);
  const auto stereo = Calibrate(pairs);
  ASSERT_TRUE(stereo.ok()) << stereo.status().message();
  EXPECT_GT(stereo->baseline_sigma_mm, 0);
  EXPECT_LT(stereo->baseline_sigma_mm, 0.05);
  EXPECT_NEAR(stereo->BaselineMm(), kRightFromLeft.translation.norm(), kFewSigmas * stereo->baseline_sigma_mm);
  EXPECT_LT(AngleDeg(stereo->right_from_left, kRightFromLeft), kFewSigmas * stereo->rotation_sigma_deg);
  EXPECT_NEAR(stereo->rms_px, kNoise_px * std::sqrt(2.0), 0.02);
  EXPECT_NEAR(stereo->left.MeanFocalLengthPx(), kLeft.MeanFocalLengthPx(), 2);
  EXPECT_THAT(stereo->is_outlier, testing::Each(false));
}

TEST(CalibrateStereo, ExactViewsGiveTheExactMount) {
  const auto stereo = Calibrate(MakePairs(8, 0));
  ASSERT_TRUE(stereo.ok()) << stereo.status().message();
  EXPECT_LT((stereo->right_from_left.translation - kRightFromLeft.translation).norm(), 1e-4);
  EXPECT_LT(AngleDeg(stereo->right_from_left, kRightFromLeft), 1e-4);
}

// A chessboard looks the same from both ends, and the detector may begin at either.
TEST(CalibrateStereo, TurnsViewsThatBeginAtTheOtherEnd) {
  Pairs pairs = MakePairs(8, kNoise_px);
  for (const std::size_t i : {1U, 2U, 5U}) {
    BoardView& view = pairs.right[i];
    std::reverse(view.pixels.begin(), view.pixels.end());
  }
  const auto stereo = Calibrate(pairs);
  ASSERT_TRUE(stereo.ok()) << stereo.status().message();
  EXPECT_LT((stereo->right_from_left.translation - kRightFromLeft.translation).norm(), 0.2);
}

TEST(CalibrateStereo, LeavesOutAPairOfTwoMoments) {
  Pairs pairs = MakePairs(10, kNoise_px);
  pairs.right[4] = pairs.right[7];
  const auto stereo = Calibrate(pairs);
  ASSERT_TRUE(stereo.ok()) << stereo.status().message();
  EXPECT_TRUE(stereo->is_outlier[4]);
  EXPECT_EQ(std::ranges::count(stereo->is_outlier, true), 1);
  EXPECT_NEAR(stereo->BaselineMm(), kRightFromLeft.translation.norm(), kFewSigmas * stereo->baseline_sigma_mm);
}

// With kInsufficient, and a sentence that says `part`.
void ExpectRefused(const Result<StereoCameras>& stereo, const std::string& part) {
  ASSERT_FALSE(stereo.ok());
  EXPECT_EQ(stereo.status().code(), ErrorCode::kInsufficient);
  EXPECT_THAT(stereo.status().message(), HasSubstr(part));
}

TEST(CalibrateStereo, PairsThatNoMountExplainsAreRefused) {
  Pairs pairs = MakePairs(10, kNoise_px);
  std::rotate(pairs.right.begin(), pairs.right.begin() + 3, pairs.right.end());
  ExpectRefused(Calibrate(pairs), "of the same moment?");
}

TEST(CalibrateStereo, CamerasThatAreExchangedAreRefused) {
  const Pairs pairs = MakePairs(8, kNoise_px);
  ExpectRefused(CalibrateStereo(kChessboard9x6, kRight, kLeft, pairs.right, pairs.left, 1),
                "to the left of the left one by 4.2 mm; exchange the two");
}

TEST(CalibrateStereo, ACameraBelowTheOtherIsRefused) {
  const Rigid3 below(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0, -4, 0));
  ExpectRefused(Calibrate(MakePairs(8, kNoise_px, below)), "above or below");
}

TEST(CalibrateStereo, OneCameraTwiceIsNoPair) {
  const Pairs pairs = MakePairs(8, kNoise_px);
  ExpectRefused(CalibrateStereo(kChessboard9x6, kLeft, kLeft, pairs.left, pairs.left, 1), "at the same place");
}

TEST(CalibrateStereo, TwoPairsAreTooFew) { ExpectRefused(Calibrate(MakePairs(2, kNoise_px)), "in 2 pairs"); }

}  // namespace
}  // namespace pliant
