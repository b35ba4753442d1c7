// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/estimation/two_view/relative_pose.h"

#include <cstdlib>
#include <limits>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "pliant/base/options.h"
#include "pliant/base/statistics.h"
#include "pliant/estimation/two_view/two_view_models.h"
#include "pliant/geometry/triangulation.h"
#include "support/synthetic_scene.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

using test::MakeScene;
using test::Motion;
using test::RaysOf;
using test::Scene;
using test::SceneOptions;
using test::Surface;

// Of exact pixels: the solvers' own rounding.
constexpr int kMaxWrong = 15;                 // of about 150: those that fell near their epipolar line by chance
constexpr int kMaxMissed = 90;                // of about 350: a raw five-point motion leaves some beyond the threshold
constexpr double kRaw_rad = 10.0 * kDeg;      // of a five-point motion at 0.3 px, not refined
constexpr double kOfAPlane_rad = 3.0 * kDeg;  // the direction of a plane's motion at 0.1 px
constexpr double kThirdOfAPixel_rad = 0.05 * kDeg;  // outliers keep a pull that falls with their distance
constexpr double kTwoMotions_rad = 1.0 * kDeg;      // an outlier within the threshold may be among the least squares
constexpr double kRefined = 0.7;                    // of the error of a sample
constexpr int kMinInliersSharp = 340;               // of about 350 at 0.1 px
constexpr int kMinInliers = 300;                    // of about 350 without noise, next to 150 outliers
constexpr int kMaxByRotation = 150;                 // of 500 pairs, those far away or at the image's middle
constexpr int kMaxByPlane = 250;                    // of 500 pairs: a tube is no plane, but some of it nearly is
constexpr double kExactRelativeRad = 1e-6;
constexpr double kKneipExactRad = 1e-4;

struct Pair {
  Scene scene;
  SceneOptions options;
  std::vector<Eigen::Vector3d> rays0;
  std::vector<Eigen::Vector3d> rays1;
  const Rigid3& truth() const { return scene.cams_from_world.back(); }
};

Pair MakePair(SceneOptions options) {
  options.num_frames = 2;
  Pair pair{MakeScene(options), options, {}, {}};
  pair.rays0 = RaysOf(pair.scene, options, 0);
  pair.rays1 = RaysOf(pair.scene, options, 1);
  return pair;
}

struct Method {
  RelativePoseSolver solver = RelativePoseSolver::kNister;
  RobustLoop robust = RobustLoop::kRansac;
};

Result<RelativePose> Estimate(const Pair& pair, const Method& method = {}) {
  return EstimateRelativePose(pair.rays0, pair.rays1, pair.options.focal_px, Random(1),
                              {.solver = method.solver, .robust = method.robust});
}

// Every way to an essential matrix.
std::vector<Method> EssentialMethods() {
  std::vector<Method> methods = {{RelativePoseSolver::kOpencvUsac}};
  for (const RelativePoseSolver solver :
       {RelativePoseSolver::kNister, RelativePoseSolver::kStewenius, RelativePoseSolver::kKneip,
        RelativePoseSolver::kSevenPoint, RelativePoseSolver::kEightPoint, RelativePoseSolver::kEigensolver})
    for (const RobustLoop robust : {RobustLoop::kRansac, RobustLoop::kLmeds, RobustLoop::kLocal})
      methods.push_back({solver, robust});
  return methods;
}
std::vector<Method> AllMethods() {
  std::vector<Method> methods = EssentialMethods();
  methods.push_back({RelativePoseSolver::kHomography});
  methods.push_back({RelativePoseSolver::kRotationOnly});
  return methods;
}

// Those that refine on inliers within the loop: local optimization and MAGSAC.
std::vector<Method> RefiningMethods() {
  std::vector<Method> methods = EssentialMethods();
  std::erase_if(methods, [](const Method& method) {
    return method.robust != RobustLoop::kLocal && method.solver != RelativePoseSolver::kOpencvUsac;
  });
  return methods;
}
// Those that draw samples.
std::vector<Method> SamplingMethods() {
  std::vector<Method> methods = AllMethods();
  std::erase_if(methods, [](const Method& method) { return method.solver == RelativePoseSolver::kRotationOnly; });
  return methods;
}

class EveryEssential : public testing::TestWithParam<Method> {};
class EveryRefiningLoop : public testing::TestWithParam<Method> {};
class EveryRelativePose : public testing::TestWithParam<Method> {};
class EverySampler : public testing::TestWithParam<Method> {};
const auto kMethodName = [](const testing::TestParamInfo<Method>& info) {
  return std::string(EnumName(info.param.solver)) + "_" + std::string(EnumName(info.param.robust));
};
INSTANTIATE_TEST_SUITE_P(RelativePose, EveryEssential, testing::ValuesIn(EssentialMethods()), kMethodName);
INSTANTIATE_TEST_SUITE_P(RelativePose, EveryRefiningLoop, testing::ValuesIn(RefiningMethods()), kMethodName);
INSTANTIATE_TEST_SUITE_P(RelativePose, EveryRelativePose, testing::ValuesIn(AllMethods()), kMethodName);
INSTANTIATE_TEST_SUITE_P(RelativePose, EverySampler, testing::ValuesIn(SamplingMethods()), kMethodName);

TEST_P(EveryEssential, IsExactWithoutNoise) {
  const double exact_rad = GetParam().solver == RelativePoseSolver::kKneip ? kKneipExactRad : kExactRelativeRad;
  for (const Motion motion : {Motion::kForward, Motion::kSideways}) {
    const Pair pair = MakePair({.motion = motion});
    const auto pose = Estimate(pair, GetParam());
    ASSERT_TRUE(pose.ok()) << pose.status().message();
    EXPECT_NEAR(pose->cam1_from_cam0.translation.norm(), 1.0, kRoundOff);
    EXPECT_LT(AngleBetween(pose->cam1_from_cam0.translation, pair.truth().translation), exact_rad);
    EXPECT_LT(RotationAngle(pose->cam1_from_cam0.rotation * pair.truth().rotation.conjugate()), exact_rad);
    EXPECT_EQ(pose->num_inliers, 500);
  }
}

TEST_P(EveryEssential, SortsOutThirtyPercentOutliers) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Pair pair = MakePair({.noise_px = 0.3, .outlier_share = 0.3, .seed = seed});
    const auto pose = Estimate(pair, GetParam());
    ASSERT_TRUE(pose.ok()) << pose.status().message();
    int wrong = 0;
    int missed = 0;
    for (std::size_t i = 0; i < pair.rays0.size(); ++i) {
      wrong += pose->inliers[i] != 0 && pair.scene.is_outlier[i] != 0 ? 1 : 0;
      missed += pose->inliers[i] == 0 && pair.scene.is_outlier[i] == 0 ? 1 : 0;
    }
    EXPECT_LT(wrong, kMaxWrong);
    EXPECT_LT(missed, kMaxMissed);
    EXPECT_LT(AngleBetween(pose->cam1_from_cam0.translation, pair.truth().translation), kRaw_rad);
  }
}

TEST_P(EveryRelativePose, RepeatsBitForBit) {
  const Pair pair = MakePair({.motion = Motion::kSideways, .noise_px = 0.3, .outlier_share = 0.3});
  const auto a = Estimate(pair, GetParam());
  std::srand(7);  // a host's own use of the C library's generator
  const auto b = Estimate(pair, GetParam());
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_EQ(a->inliers, b->inliers);
  EXPECT_EQ(a->cam1_from_cam0.translation, b->cam1_from_cam0.translation);
  EXPECT_EQ(a->cam1_from_cam0.rotation.coeffs(), b->cam1_from_cam0.rotation.coeffs());
}

TEST(RelativePose, DrawsItsSamplesFromTheGenerator) {
  const Pair pair = MakePair({.noise_px = 0.3, .outlier_share = 0.3});
  const auto a = Estimate(pair);
  const auto other = EstimateRelativePose(pair.rays0, pair.rays1, pair.options.focal_px, Random(2), {});
  ASSERT_TRUE(a.ok() && other.ok());
  EXPECT_NE(a->cam1_from_cam0.translation, other->cam1_from_cam0.translation);  // the generator has a say
}

TEST(RelativePose, LeavesTheHostsGeneratorAlone) {
  std::srand(5);
  const int next = std::rand();
  std::srand(5);
  ASSERT_TRUE(Estimate(MakePair({.noise_px = 0.3}), {RelativePoseSolver::kEigensolver}).ok());
  EXPECT_EQ(std::rand(), next);
}

TEST_P(EveryRefiningLoop, IsBetterForRefinementOnInliers) {
  std::vector<double> errors;
  std::vector<double> errors_of_samples;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Pair pair = MakePair({.motion = Motion::kSideways, .noise_px = 0.3, .outlier_share = 0.3, .seed = seed});
    const auto of = [&](const Method& method) {
      return AngleBetween(Estimate(pair, method).value().cam1_from_cam0.translation, pair.truth().translation);
    };
    errors.push_back(of(GetParam()));
    errors_of_samples.push_back(
        of({GetParam().solver == RelativePoseSolver::kOpencvUsac ? RelativePoseSolver::kNister : GetParam().solver,
            RobustLoop::kRansac}));
  }
  EXPECT_LT(Median(errors), kRefined * Median(errors_of_samples));
}

TEST(RelativePose, HomographyFindsThePlanesMotion) {
  for (const Motion motion : {Motion::kForward, Motion::kSideways}) {
    const Pair pair = MakePair({.surface = Surface::kPlane, .motion = motion, .noise_px = 0.1, .outlier_share = 0.3});
    const auto pose = Estimate(pair, {RelativePoseSolver::kHomography});
    ASSERT_TRUE(pose.ok()) << pose.status().message();
    EXPECT_LT(AngleBetween(pose->cam1_from_cam0.translation, pair.truth().translation), kOfAPlane_rad);
    EXPECT_GT(pose->num_inliers, kMinInliersSharp);
  }
}

TEST(RelativePose, RotationOnlyFindsARotationAndNoTranslation) {
  const Pair pair = MakePair({.motion = Motion::kRotation, .rotation_deg = 5.0, .noise_px = 0.1, .outlier_share = 0.3});
  const auto pose = Estimate(pair, {RelativePoseSolver::kRotationOnly});
  ASSERT_TRUE(pose.ok()) << pose.status().message();
  EXPECT_EQ(pose->cam1_from_cam0.translation, Eigen::Vector3d::Zero());
  EXPECT_LT(RotationAngle(pose->cam1_from_cam0.rotation * pair.truth().rotation.conjugate()), kThirdOfAPixel_rad);
  EXPECT_GT(pose->num_inliers, kMinInliersSharp);
}

// Repeated, three pairs are as many as wanted, and determine no more than three.
TEST_P(EveryRelativePose, RefusesFewPairsThatComeManyTimes) {
  Pair pair = MakePair({.num_points = 60});
  for (std::size_t i = 3; i < pair.rays0.size(); ++i) {
    pair.rays0[i] = pair.rays0[i % 3];
    pair.rays1[i] = pair.rays1[i % 3];
  }
  const Status status = Estimate(pair, GetParam()).status();
  EXPECT_EQ(status.code(), ErrorCode::kDegenerate);
  EXPECT_NE(status.message().find("only 3 of the"), std::string::npos) << status.message();
}

// Many motions with a translation explain points on a line, exact or with noise below the error that is allowed.
TEST_P(EverySampler, RefusesPointsOnALine) {
  Pair pair = MakePair({.num_points = 30});
  for (const double off_px : {0.0, 0.5})
    for (const double moved : {0.1, 0.0}) {
      for (std::size_t i = 0; i < pair.rays0.size(); ++i) {
        const double along = -1.0 + static_cast<double>(i) / 15.0;
        const double off = (i % 2 == 0 ? off_px : -off_px) / pair.options.focal_px;
        pair.rays0[i] = Eigen::Vector3d(along, off, 1).normalized();
        pair.rays1[i] = Eigen::Vector3d(along + moved + 0.01 * along * along, off, 1).normalized();
      }
      const auto pose = Estimate(pair, GetParam());
      EXPECT_FALSE(pose.ok()) << pose->num_inliers << " inliers, " << off_px << " px off, moved " << moved;
    }
}

// With nine tenths outliers 300 samples of five pairs hold a clean one once in 300 times. A few pairs agree with any
// motion, and the best of many motions is no answer.
TEST_P(EverySampler, RefusesWhatItsSamplesCannotFind) {
  for (const Surface surface : {Surface::kTube, Surface::kBlob})
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      const Pair pair = MakePair({.surface = surface, .noise_px = 0.3, .outlier_share = 0.9, .seed = seed});
      const auto pose = Estimate(pair, GetParam());
      EXPECT_FALSE(pose.ok()) << pose->num_inliers << " inliers";
    }
}

TEST_P(EveryRelativePose, RefusesBadInputQuietly) {
  Pair pair = MakePair({.num_points = 20});
  const auto code = [&] { return Estimate(pair, GetParam()).status().code(); };
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  Pair good = pair;
  pair.rays0.resize(7);
  pair.rays1.resize(7);
  EXPECT_EQ(code(), ErrorCode::kInsufficient);
  pair.rays1.pop_back();
  EXPECT_EQ(code(), ErrorCode::kInvalidArgument);
  pair = good;
  pair.rays1[3].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code(), ErrorCode::kInvalidArgument);
  pair = good;
  pair.rays0.assign(20, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(code(), ErrorCode::kDegenerate);
  pair = good;
  pair.rays1 = pair.rays0;
  EXPECT_EQ(code(), ErrorCode::kDegenerate);
  pair.rays0.clear();
  pair.rays1.clear();
  EXPECT_EQ(code(), ErrorCode::kInsufficient);
  // Nine tenths outliers, a still camera with noise, a plane, points along one line: an answer or a reason, never a
  // word.
  for (const SceneOptions& options : {SceneOptions{.outlier_share = 0.9},
                                      {.motion = Motion::kStill, .noise_px = 0.3},
                                      {.surface = Surface::kPlane},
                                      {.motion = Motion::kRotation}}) {
    const auto pose = Estimate(MakePair(options), GetParam());
    EXPECT_TRUE(!pose.ok() ||
                (pose->cam1_from_cam0.translation.allFinite() && pose->cam1_from_cam0.rotation.coeffs().allFinite()));
  }
  pair = good;
  for (std::size_t i = 0; i < pair.rays0.size(); ++i) {
    pair.rays0[i] = Eigen::Vector3d(0.02 * static_cast<double>(i) - 0.2, 0, 1).normalized();
    pair.rays1[i] = Eigen::Vector3d(0.021 * static_cast<double>(i) - 0.2, 0, 1).normalized();
  }
  const auto on_a_line = Estimate(pair, GetParam());
  EXPECT_TRUE(!on_a_line.ok() || on_a_line->cam1_from_cam0.translation.allFinite());
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

TEST(RotationModel, IsFoundAmongOutliers) {
  const Pair pair = MakePair({.motion = Motion::kRotation, .rotation_deg = 5.0, .outlier_share = 0.3});
  const auto fit = FitRotation(pair.rays0, pair.rays1, pair.options.focal_px, 1.5);
  ASSERT_TRUE(fit.ok());
  EXPECT_LT(RotationAngle(fit->cam1_from_cam0 * pair.truth().rotation.conjugate()), kThirdOfAPixel_rad);
  EXPECT_GT(fit->num_inliers, kMinInliers);
}

TEST(RotationModel, DoesNotExplainATranslation) {
  for (const Motion motion : {Motion::kForward, Motion::kSideways}) {
    const Pair pair = MakePair({.motion = motion});
    const auto fit = FitRotation(pair.rays0, pair.rays1, pair.options.focal_px, 1.5);
    ASSERT_TRUE(fit.ok());
    EXPECT_LT(fit->num_inliers, kMaxByRotation);
  }
  EXPECT_EQ(FitRotation({}, {}, 450, 1.5).status().code(), ErrorCode::kInsufficient);
}

TEST(PlaneModel, HomographyOfAPlaneHoldsItsMotion) {
  for (const Motion motion : {Motion::kForward, Motion::kSideways}) {
    const Pair pair = MakePair({.surface = Surface::kPlane, .motion = motion, .outlier_share = 0.3});
    const auto fit = FitHomography(pair.rays0, pair.rays1, pair.options.focal_px, 1.5, Random(1));
    ASSERT_TRUE(fit.ok());
    EXPECT_GT(fit->num_inliers, kMinInliers);
    double nearest = std::numbers::pi;
    const auto motions = MotionsFromHomography(fit->cam1_from_cam0, pair.rays0);
    ASSERT_EQ(motions.size(), 2U);
    for (const Rigid3& candidate : motions)
      nearest = std::min(nearest, AngleBetween(candidate.translation, pair.truth().translation) +
                                      RotationAngle(candidate.rotation * pair.truth().rotation.conjugate()));
    EXPECT_LT(nearest, kTwoMotions_rad);
  }
}

TEST(PlaneModel, DoesNotExplainATube) {
  const Pair pair = MakePair({});
  const auto fit = FitHomography(pair.rays0, pair.rays1, pair.options.focal_px, 1.5, Random(1));
  ASSERT_TRUE(fit.ok());
  EXPECT_LT(fit->num_inliers, kMaxByPlane);
}

}  // namespace
}  // namespace pliant
