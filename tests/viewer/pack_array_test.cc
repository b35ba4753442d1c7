// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/pack_array.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "viewer/unpack_array.h"

namespace pliant {
namespace {

using testing::ElementsAre;

constexpr double kHalfStep = 0.51;         // of the step, and the rounding of floats
constexpr double kStepOfFloats = 1e-5;     // the step is computed from floats of up to 30
constexpr double kWithoutTheStray = 1e-3;  // steps of 50 / 65534; with the stray value they would be 15

TEST(Base64, IsThatOfTheStandard) {  // RFC 4648, section 10
  EXPECT_EQ(Base64(""), "");
  EXPECT_EQ(Base64("f"), "Zg==");
  EXPECT_EQ(Base64("fo"), "Zm8=");
  EXPECT_EQ(Base64("foo"), "Zm9v");
  EXPECT_EQ(Base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(Base64("\xff\xfe\x00"), "//4=");
}

TEST(PackArray, WholeNumbersComeBack) {
  for (const auto type : {PackedType::kU8, PackedType::kU16, PackedType::kU32}) {
    const std::vector<std::uint32_t> values = {5, 200, 255, 0, 0, 255, 17, 18};
    EXPECT_THAT(Unpack(PackWhole(values, 2, type)), ElementsAre(5, 200, 255, 0, 0, 255, 17, 18));
  }
  const std::vector<std::uint32_t> large = {0, 4294967295U, 65536, 1};
  EXPECT_THAT(Unpack(PackWhole(large, 1, PackedType::kU32)), ElementsAre(0, 4294967295.0, 65536, 1));
}

TEST(PackArray, QuantizedNumbersComeBackToHalfAStep) {
  std::vector<float> values;
  for (int i = 0; i < 500; ++i) {
    values.push_back(30.0F * std::sin(0.1F * static_cast<float>(i)));
    values.push_back(1e-3F * static_cast<float>(i));
  }
  values[6] = std::numeric_limits<float>::quiet_NaN();
  values[9] = std::numeric_limits<float>::infinity();
  const auto packed = PackQuantized(values, 2, PackedType::kU16);
  const std::vector<double> read = Unpack(packed);
  ASSERT_EQ(read.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i == 6 || i == 9)
      EXPECT_TRUE(std::isnan(read[i]));
    else
      EXPECT_NEAR(read[i], values[i], kHalfStep * packed["step"][i % 2].get<double>());
  }
  EXPECT_NEAR(packed["step"][0].get<double>(), 60.0 / 65534, kStepOfFloats);
}

TEST(PackArray, AStrayValueDoesNotMakeTheOthersCoarse) {
  std::vector<float> values;
  for (int i = 0; i < 1000; ++i) values.push_back(0.05F * static_cast<float>(i));
  values[500] = 1e6F;
  const std::vector<double> read = Unpack(PackQuantized(values, 1, PackedType::kU16));
  ASSERT_EQ(read.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(read[i], values[i], kWithoutTheStray);
}

TEST(PackArray, AConstantAndNothingAtAllComeBack) {
  EXPECT_THAT(Unpack(PackQuantized(std::vector<float>{7, 7}, 1, PackedType::kU8)), ElementsAre(7, 7));
  const std::vector<float> none(2, std::numeric_limits<float>::quiet_NaN());
  const std::vector<double> read = Unpack(PackQuantized(none, 1, PackedType::kU8));
  ASSERT_EQ(read.size(), none.size());
  for (const double value : read) EXPECT_TRUE(std::isnan(value));
  const auto empty = PackQuantized({}, 3, PackedType::kU16);
  EXPECT_EQ(empty["rows"], 0);
  EXPECT_TRUE(Unpack(empty).empty());
}

TEST(PackArray, FloatsComeBackExactly) {
  EXPECT_THAT(Unpack(PackFloats(std::vector<float>{0.1F, -3e7F, 0, 1}, 2)), ElementsAre(0.1F, -3e7F, 0, 1));
  EXPECT_TRUE(std::isnan(Unpack(PackFloats(std::vector<float>{NAN}, 1)).front()));
}

TEST(PackArray, SmoothTracksPackWell) {
  std::vector<float> values;
  for (int i = 0; i < 100000; ++i) values.push_back(std::sin(1e-3F * static_cast<float>(i)));
  EXPECT_LT(PackQuantized(values, 1, PackedType::kU16)["data"].get<std::string>().size(), values.size() / 2);
}

}  // namespace
}  // namespace pliant
