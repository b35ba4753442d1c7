// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/camera/photometric_calibration.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "support/tolerances.h"

namespace pliant {
namespace {

const Eigen::Vector3d kAhead = Eigen::Vector3d::UnitZ();
const Eigen::Vector3d kSixtyDegrees(std::sqrt(3.0), 0, 1);

TEST(Photometric, BrightnessFallsWithTheSquareOfTheDistance) {
  const PhotometricCalibration calibration{.gamma = 1.8};
  const auto brightness = [&](double distance) { return 255 * std::pow(10.0 / (distance * distance), 1 / 1.8); };
  EXPECT_NEAR(LogDistanceFromLight(calibration, brightness(20), kAhead) -
                  LogDistanceFromLight(calibration, brightness(10), kSixtyDegrees),
              std::log(2.0), kRoundOff);
  EXPECT_TRUE(std::isnan(LogDistanceFromLight(calibration, 0, kAhead)));
}

TEST(Photometric, ADirectionThatGetsLessLightIsNotFarther) {
  const PhotometricCalibration calibration{.vignetting = 3, .light_spread = 2.5};
  const double share = std::pow(0.5, 3) * std::exp(-2.5 * 0.5);
  EXPECT_NEAR(LogFalloff(calibration, kSixtyDegrees), std::log(share), kRoundOff);
  EXPECT_EQ(LogFalloff(calibration, 7.0 * kAhead), 0.0);
  const auto level = [&](double light) { return 255 * std::pow(light, 1 / calibration.gamma); };
  EXPECT_NEAR(LogDistanceFromLight(calibration, level(0.3 * share), kSixtyDegrees),
              LogDistanceFromLight(calibration, level(0.3), kAhead), kRoundOff);
  EXPECT_TRUE(std::isnan(LogFalloff(calibration, -kAhead)));
}

TEST(Photometric, TheLightMayPointElsewhere) {
  const PhotometricCalibration calibration{.light_spread = 2.5, .light_axis = 3.0 * kSixtyDegrees};
  EXPECT_NEAR(LogFalloff(calibration, kSixtyDegrees), 0.0, kRoundOff);
  EXPECT_NEAR(LogFalloff(calibration, kAhead), -1.25, kRoundOff);
  EXPECT_NEAR(LogFalloff(calibration, -kAhead), -3.75, kRoundOff) << "a fisheye sees behind itself";
}

TEST(Photometric, WhatCannotBeMeantIsRefused) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(CheckPhotometric({}).ok());
  for (const PhotometricCalibration& calibration :
       {PhotometricCalibration{.gamma = 0}, PhotometricCalibration{.gamma = kNan},
        PhotometricCalibration{.vignetting = -1}, PhotometricCalibration{.light_spread = kNan},
        PhotometricCalibration{.light_axis = Eigen::Vector3d::Zero()},
        PhotometricCalibration{.light_axis = {kNan, 0, 1}}})
    EXPECT_EQ(CheckPhotometric(calibration).code(), ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace pliant
