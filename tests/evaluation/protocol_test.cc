// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/evaluation/protocol.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "pliant/base/random.h"
#include "pliant/evaluation/point_error.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

constexpr double kOutlier_mm = 30.0;      // outliers lie too far by 40 mm and more
constexpr double kPulled = 0.3;           // of a scale of 2, by nearly half of the points
constexpr double kNoiseBeyond = 0.03;     // share: what noise puts beyond 2.5 sigma, and a part of it again
constexpr double kScaleOf100 = 0.02;      // 100 points of 0.5 mm noise some 50 mm away
constexpr double kOutliersIn_mm = 10;     // a tenth of the points, off by tens of millimeters
constexpr double kOutliersOut_mm = 1;     // the noise of 0.5 mm in three coordinates
constexpr double kColonNotFlat_mm = 3;    // the truth is no plane before the camera, so the null has an error
constexpr double kNullScale = 35;         // the null is rays of depth one, the truth lies 40 mm to 60 mm away
constexpr double kOneScaleForTwo_mm = 1;  // submaps of scales 2 and 3 do not fit one

// Points some 50 mm away, estimates that are the truth divided by `scale` with noise, and the first `outliers` of them
// at twice their distance.
std::vector<PointPair> Pairs(int count, double scale, double noise_mm, int outliers, std::uint64_t seed = 5) {
  Random random(seed);
  std::vector<PointPair> pairs;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d ray(random.Uniform(-0.5, 0.5), random.Uniform(-0.5, 0.5), 1);
    const Eigen::Vector3d truth = random.Uniform(40, 60) * ray;
    const Eigen::Vector3d noise(random.Normal(noise_mm), random.Normal(noise_mm), random.Normal(noise_mm));
    pairs.push_back({(i < outliers ? 2.0 : 1.0) * (truth + noise) / scale, truth, ray});
  }
  return pairs;
}

class EveryProtocol : public testing::TestWithParam<ErrorProtocol> {};

TEST_P(EveryProtocol, RecoversAKnownScaleExactlyAndHasNoErrorThere) {
  const std::vector<PointPair> pairs = Pairs(41, 2.5, 0, 0);
  const double scale = ProtocolScale(pairs, GetParam());
  EXPECT_NEAR(scale, 2.5, kLengthRoundOff_mm);
  const ProtocolErrors errors = ApplyProtocol(pairs, 2.5, GetParam(), {});
  ASSERT_FALSE(errors.errors_mm.empty());
  for (const double error : errors.errors_mm) EXPECT_LT(error, kLengthRoundOff_mm);
}

TEST_P(EveryProtocol, TakesOnePointAndPointsThatAreZero) {
  const std::vector<PointPair> one = {{{0, 0, 2}, {0, 1, 6}}};
  EXPECT_NEAR(ProtocolScale(one, GetParam()), 3, kLengthRoundOff_mm);
  EXPECT_EQ(ApplyProtocol(one, 3, GetParam(), {}).errors_mm.size(), 1U);
  const std::vector<PointPair> zero = {{{0, 0, 0}, {0, 0, 5}}};
  EXPECT_EQ(ProtocolScale(zero, GetParam()), 1.0);
  EXPECT_TRUE(ApplyProtocol({}, 1, GetParam(), {}).errors_mm.empty());
}

TEST_P(EveryProtocol, DoesNotDependOnTheOrderOfThePoints) {
  std::vector<PointPair> pairs = Pairs(60, 1, 2, 6);
  const double scale = ProtocolScale(pairs, GetParam());
  std::reverse(pairs.begin(), pairs.end());
  EXPECT_NEAR(ProtocolScale(pairs, GetParam()), scale, kRoundOff);
}

INSTANTIATE_TEST_SUITE_P(Protocols, EveryProtocol,
                         testing::Values(ErrorProtocol::kPaper, ErrorProtocol::kDepthTrimmed, ErrorProtocol::kLmeds),
                         [](const auto& test) { return std::string(EnumName(test.param)); });

TEST(Protocol, PaperTakesTheLeastSquaresScaleAndEveryPoint) {
  const std::vector<PointPair> pairs = {{{1, 0, 2}, {2, 1, 4}}, {{0, 1, 3}, {0, 2, 7}}};
  EXPECT_NEAR(ProtocolScale(pairs, ErrorProtocol::kPaper), (2 + 8 + 2 + 21) / (5.0 + 10.0), kLengthRoundOff_mm);
  const ProtocolErrors errors = ApplyProtocol(Pairs(40, 1, 1, 10), 1, ErrorProtocol::kPaper, {});
  EXPECT_EQ(errors.errors_mm.size(), 40U);
  EXPECT_EQ(errors.left_out, 0);
}

TEST(Protocol, DepthTrimmedTakesTheMedianRatioOfDepthsAndLeavesOutTheWorst) {
  const std::vector<PointPair> pairs = {
      {{9, 0, 1}, {0, 0, 2}}, {{0, 9, 2}, {0, 0, 6}}, {{0, 0, 1}, {0, 0, 9}}, {{0, 0, -4}, {0, 0, 9}}};
  EXPECT_NEAR(ProtocolScale(pairs, ErrorProtocol::kDepthTrimmed), 3,
              kLengthRoundOff_mm);  // ratios 2, 3, 9; one point behind
  const ProtocolErrors errors = ApplyProtocol(Pairs(40, 1, 0, 3), 1, ErrorProtocol::kDepthTrimmed, {});
  EXPECT_EQ(errors.left_out, 2);  // 5 % of 40: one outlier of three stays
  EXPECT_GT(*std::max_element(errors.errors_mm.begin(), errors.errors_mm.end()), kOutlier_mm);
  EXPECT_EQ(ApplyProtocol(Pairs(40, 1, 0, 3), 1, ErrorProtocol::kDepthTrimmed, {.trim_share = 0}).left_out, 0);
}

TEST(Protocol, DepthTrimmedDoesNotSeeWhatIsAcrossTheAxis) {
  const std::vector<PointPair> pairs = {{{7, 0, 10}, {0, 0, 10}}, {{0, 0, 20}, {0, 3, 20}}};
  const ProtocolErrors errors = ApplyProtocol(pairs, 1, ErrorProtocol::kDepthTrimmed, {});
  EXPECT_EQ(errors.errors_mm, (std::vector<double>{0, 0}));
}

TEST(Protocol, LmedsFindsTheScaleOfTheMajorityAndLeavesOutTheRest) {
  const std::vector<PointPair> pairs = Pairs(101, 2, 0, 45);
  EXPECT_NEAR(ProtocolScale(pairs, ErrorProtocol::kLmeds), 2, kLengthRoundOff_mm);
  EXPECT_GT(std::abs(ProtocolScale(pairs, ErrorProtocol::kPaper) - 2), kPulled);
  EXPECT_EQ(ApplyProtocol(pairs, 2, ErrorProtocol::kLmeds, {}).left_out, 45);
}

// The least median of squares by trying every scale at which it can lie: the vertex of one parabola, or where two of
// them meet.
TEST(Protocol, LmedsIsTheLeastMedianOfAllScalesThatThereAre) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const int count = 20 + static_cast<int>(seed);
    const std::vector<PointPair> pairs = Pairs(count, 1, 4, count / 3, seed);
    const auto median = [&](double scale) {
      std::vector<double> squares;
      for (const PointPair& pair : pairs) squares.push_back((scale * pair.estimate - pair.truth).squaredNorm());
      std::sort(squares.begin(), squares.end());
      return squares[squares.size() / 2];
    };
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      for (std::size_t j = i; j < pairs.size(); ++j) {
        const PointPair& p = pairs[i];
        const PointPair& q = pairs[j];
        const double a = p.estimate.squaredNorm() - (i == j ? 0 : q.estimate.squaredNorm());
        const double b = p.estimate.dot(p.truth) - (i == j ? 0 : q.estimate.dot(q.truth));
        const double c = i == j ? 0 : p.truth.squaredNorm() - q.truth.squaredNorm();
        const double root = i == j ? 0 : std::sqrt(std::max(0.0, b * b - a * c));
        for (const double sign : {-1.0, 1.0}) least = std::min(least, median((b + sign * root) / a));
      }
    }
    EXPECT_NEAR(median(ProtocolScale(pairs, ErrorProtocol::kLmeds)), least, kLengthRoundOff_mm * least) << seed;
  }
}

TEST(PointError, EveryProtocolStandsBesideThePlainFigureWithItsNullAndTheShareLeftOut) {
  PointErrorOptions options;
  options.protocols = {ErrorProtocol::kLmeds, ErrorProtocol::kDepthTrimmed};
  const std::vector<PairedFrame> frames = {{0, Pairs(100, 2, 0.5, 10), {}}, {1, Pairs(100, 3, 0.5, 10), {}}};
  const auto error = ComputePointError(frames, options);
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->plain.protocol, ErrorProtocol::kPaper);
  EXPECT_EQ(error->plain.estimate.left_out_share, 0);
  EXPECT_GT(error->plain.estimate.mean_rmse_mm, kOutliersIn_mm);
  ASSERT_EQ(error->protocols.size(), 2U);
  const ProtocolError& trimmed = error->protocols[0];
  const ProtocolError& lmeds = error->protocols[1];
  EXPECT_EQ(trimmed.protocol, ErrorProtocol::kDepthTrimmed);
  EXPECT_NEAR(trimmed.estimate.left_out_share, 0.05, kLengthRoundOff_mm);
  EXPECT_NEAR(trimmed.null.left_out_share, 0.05, kLengthRoundOff_mm);
  EXPECT_NEAR(lmeds.estimate.left_out_share, 0.1, kNoiseBeyond);
  EXPECT_NEAR(lmeds.estimate.max_scale, 3, kScaleOf100);
  EXPECT_LT(lmeds.estimate.mean_rmse_mm, kOutliersOut_mm);
  EXPECT_GT(lmeds.null.mean_rmse_mm, kColonNotFlat_mm);
  EXPECT_GT(trimmed.null.mean_rmse_mm, kColonNotFlat_mm);
}

TEST(PointError, ScaleIsOrthogonalToTheProtocol) {
  const std::vector<PairedFrame> frames = {{0, Pairs(99, 2, 0, 10), {}}, {1, Pairs(99, 2, 0, 10), {}}};
  for (const ErrorScale scale : {ErrorScale::kPerFrame, ErrorScale::kGlobal, ErrorScale::kNone}) {
    PointErrorOptions options;
    options.protocols = {ErrorProtocol::kLmeds};
    options.scale = scale;
    const auto error = ComputePointError(frames, options);
    ASSERT_TRUE(error.ok());
    const double expected = scale == ErrorScale::kNone ? 1 : 2;
    EXPECT_NEAR(error->protocols[0].estimate.min_scale, expected, kLengthRoundOff_mm);
    EXPECT_GT(error->protocols[0].null.min_scale, kNullScale);  // the null gets its best depth in any case
  }
}

// Two maps have a unit each: that is no drift.
TEST(PointError, AGlobalScaleIsOneASubmap) {
  const std::vector<PairedFrame> frames = {
      {0, Pairs(99, 2, 0, 0), {}}, {1, Pairs(99, 2, 0, 0), {}}, {2, Pairs(99, 3, 0, 0), {}, 1}};
  PointErrorOptions options;
  options.scale = ErrorScale::kGlobal;
  const auto error = ComputePointError(frames, options);
  ASSERT_TRUE(error.ok());
  EXPECT_NEAR(error->plain.frames[0].estimate.scale, 2, kLengthRoundOff_mm);
  EXPECT_NEAR(error->plain.frames[2].estimate.scale, 3, kLengthRoundOff_mm);
  EXPECT_LT(error->plain.estimate.mean_rmse_mm, kLengthRoundOff_mm);
  const std::vector<PairedFrame> one_map = {frames[0], frames[1], {2, frames[2].pairs, {}}};
  EXPECT_GT(ComputePointError(one_map, options)->plain.estimate.mean_rmse_mm, kOneScaleForTwo_mm);
}

}  // namespace
}  // namespace pliant
