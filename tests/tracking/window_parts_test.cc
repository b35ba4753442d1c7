// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/bootstrapping/window_parts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/base/statistics.h"
#include "support/waving_tracks.h"

namespace pliant {
namespace {

using testing::Each;
using testing::HasSubstr;

using test::CameraPath;
using test::kNominalMm;
using test::WavingTracks;

constexpr int kWindowFrames = 61;
constexpr double kRigid_mm = 0;
constexpr double kTremor_mm = 0.05;  // 0.4 px: more than the noise of the tracks
constexpr double kWave_mm = 1;
constexpr double kWrong = 0.3;  // of log distances
constexpr double kMaxFactorWhereRight = 2;
constexpr double kMaxRigidSigma = 0.003;  // where nothing deforms

InitInput InputOf(const WavingTracks& sequence) { return {sequence.camera, sequence.frames, {}}; }

SolvedWindow Rigid(const WavingTracks& sequence) {
  return SolveAsRigid(InputOf(sequence), sequence.frames.size(), {}, kNominalMm).value();
}

SolvedWindow Solved(const WavingTracks& sequence) {
  return SolveWindow(InputOf(sequence), sequence.frames.size(), WindowScene::kAny, {}, kNominalMm).value();
}

double SigmaFactor(const WavingTracks& sequence, const SolvedWindow& window) {
  return SigmaFactorOfLaterPart(InputOf(sequence), window, window.ids, {}, kNominalMm);
}

// Median error of log distance in the reference, after one scale.
double Error(const WavingTracks& sequence, const SolvedWindow& window) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < window.ids.size(); ++i)
    errors.push_back(std::log(window.solution.window.points_in_world[i].norm() /
                              sequence.points[static_cast<std::size_t>(window.ids[i].value)].norm()));
  const double scale = Median(errors);
  for (double& error : errors) error = std::abs(error - scale);
  return Median(errors);
}

// A lens whose distortion is not in the calibration: its errors are alike at neighbors, too.
WavingTracks Distorted(WavingTracks sequence, double k) {
  for (InitFrame& frame : sequence.frames)
    for (InitObservation& seen : frame.observations) {
      const Eigen::Vector2d from_center = seen.pixel - Eigen::Vector2d(319.5, 239.5);
      seen.pixel += k * from_center * (from_center / 450).squaredNorm();
    }
  return sequence;
}

TEST(WindowParts, HalvesAgreeWhereNothingDeforms) {
  const WavingTracks sequence(kWindowFrames, CameraPath::kForwards, kRigid_mm);
  const SolvedWindow window = Rigid(sequence);
  const std::vector<double> sigmas = SigmasOfHalves(InputOf(sequence), window, {}, kNominalMm);
  ASSERT_EQ(sigmas.size(), window.ids.size());
  EXPECT_LT(Median(sigmas), kMaxRigidSigma);
  EXPECT_GT(Median(sigmas), Error(sequence, window) / 2);
}

TEST(WindowParts, HalvesDifferByWhatADeformationMakesOfDepths) {
  const WavingTracks sequence(kWindowFrames, CameraPath::kForwards, kWave_mm);
  const SolvedWindow window = Rigid(sequence);
  const double linear = MedianSigma(window.solution);
  const double error = Error(sequence, window);
  EXPECT_GT(error, 1.5 * linear);  // which knows nothing of a deformation
  const double of_halves = Median(SigmasOfHalves(InputOf(sequence), window, {}, kNominalMm));
  EXPECT_GT(of_halves, error);
  EXPECT_LT(of_halves, 3 * error);
}

TEST(WindowParts, HalvesSayNothingWhereTheyAreTooShort) {
  const WavingTracks sequence(9, CameraPath::kForwards, kRigid_mm);
  EXPECT_THAT(SigmasOfHalves(InputOf(sequence), Rigid(sequence), {}, kNominalMm),
              Each(std::numeric_limits<double>::infinity()));
}

TEST(WindowParts, ATremorOrAWrongLensDoesNotCostTheDepthsOfARigidScene) {
  for (const double k : {0.0, 0.02}) {
    const WavingTracks sequence = Distorted(WavingTracks(kWindowFrames, CameraPath::kForwards, kTremor_mm), k);
    const SolvedWindow window = Solved(sequence);
    ASSERT_TRUE(window.IsRigid()) << k;
    EXPECT_GT(window.solution.residual_correlation, WindowInitOptions().max_correlation) << k;
    ASSERT_NE(window.deforming, nullptr) << k;
    EXPECT_FALSE(window.deforming->IsRigid()) << k;
    EXPECT_LT(MedianSigma(window.solution), MedianSigma(window.deforming->solution)) << k;
    EXPECT_LT(Error(sequence, window), Error(sequence, *window.deforming)) << k;
  }
}

// Ids are given from the top of the image to its bottom.
TEST(WindowParts, PointsThatAreTooManyAreTakenFromEverywhere) {
  WavingTracks sequence(kWindowFrames, CameraPath::kForwards, kRigid_mm);
  std::vector<std::pair<double, PointId>> by_row;
  for (const InitObservation& seen : sequence.frames.front().observations) by_row.emplace_back(seen.pixel.y(), seen.id);
  std::ranges::sort(by_row);
  std::map<PointId, PointId> renamed;
  for (std::size_t k = 0; k < by_row.size(); ++k) renamed[by_row[k].second] = PointId{static_cast<std::int64_t>(k)};
  for (InitFrame& frame : sequence.frames) {
    std::erase_if(frame.observations, [&](const InitObservation& seen) { return !renamed.contains(seen.id); });
    for (InitObservation& seen : frame.observations) seen.id = renamed.at(seen.id);
    std::ranges::sort(frame.observations, {}, &InitObservation::id);
  }
  WindowInitOptions options;
  options.max_points = 40;
  const auto window = SolveAsRigid(InputOf(sequence), sequence.frames.size(), options, kNominalMm);
  ASSERT_TRUE(window.ok()) << window.status().message();
  const auto upper = std::ranges::count_if(
      window->ids, [&](PointId id) { return 2 * static_cast<std::size_t>(id.value) < by_row.size(); });
  EXPECT_EQ(window->ids.size(), 40U);
  EXPECT_GT(upper, 10);
  EXPECT_LT(upper, 30);
}

TEST(WindowParts, AWindowMayHaveFewerViewsThanAPointIsOtherwiseSeenIn) {
  const WavingTracks sequence(kWindowFrames, CameraPath::kForwards, kRigid_mm);
  WindowInitOptions options;
  options.views = 4;
  ASSERT_LT(options.views, options.min_views);
  EXPECT_TRUE(SolveAsRigid(InputOf(sequence), sequence.frames.size(), options, kNominalMm).ok());
}

TEST(WindowParts, AWaveIsNotTakenForRigid) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const SolvedWindow window = Solved(WavingTracks(kWindowFrames, CameraPath::kForwards, kWave_mm, 15, seed));
    EXPECT_FALSE(window.IsRigid()) << seed;
    EXPECT_EQ(window.deforming, nullptr) << seed;
  }
}

TEST(WindowParts, AMapOfATremorSaysSo) {
  const WavingTracks sequence(kWindowFrames, CameraPath::kForwards, kTremor_mm);
  WindowInitOptions options;
  options.min_still_camera_ratio = 0;
  const InitOutcome outcome = sequence.Try(options);
  ASSERT_EQ(outcome.decision, InitDecision::kMap) << outcome.reason;
  EXPECT_FALSE(outcome.deforming);
  EXPECT_TRUE(outcome.allows_deformation);
  EXPECT_THAT(outcome.reason, HasSubstr("the scene deforms, but so little"));
}

// What two halves differ by is one sample of what a deformation adds to depths.
TEST(WindowParts, AMapOfATremorOverAFlatSceneIsProvisional) {
  WindowInitOptions options;
  options.min_still_camera_ratio = 0;
  const WavingTracks flat(kWindowFrames - 10, CameraPath::kForwards, 0.8 * kTremor_mm, 4.5);
  const InitOutcome outcome = flat.Try(options);
  ASSERT_EQ(outcome.decision, InitDecision::kMap) << outcome.reason;
  EXPECT_TRUE(outcome.allows_deformation);
  EXPECT_GE(outcome.measured.DepthSignal(), kMinDepthSignal);
  EXPECT_TRUE(outcome.provisional);
  EXPECT_THAT(outcome.reason, HasSubstr("it is provisional"));
  EXPECT_FALSE(WavingTracks(kWindowFrames, CameraPath::kForwards, 0.8 * kTremor_mm, 4.5).Try(options).provisional);

  options.provisional = Switch::kOff;
  const InitOutcome refused = flat.Try(options);
  EXPECT_NE(refused.decision, InitDecision::kMap);
  EXPECT_THAT(refused.reason, HasSubstr("a certain map needs"));
}

// A scene that deforms at all may do so before a camera that stands still: here in one way, as the camera moves.
TEST(WindowParts, WhetherTheCameraMovesIsAskedAllTheSame) {
  const WavingTracks sequence(kWindowFrames, CameraPath::kForwards, kTremor_mm);
  const InitOutcome outcome = sequence.Try({});
  EXPECT_TRUE(outcome.ambiguous) << outcome.reason;
  EXPECT_LT(outcome.measured.still_camera_error_ratio, WindowInitOptions().min_still_camera_ratio);
}

TEST(WindowParts, AgreeWithAWindowThatIsRight) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const WavingTracks sequence(kWindowFrames, CameraPath::kForwards, kWave_mm, 15, seed);
    EXPECT_LT(SigmaFactor(sequence, Solved(sequence)), kMaxFactorWhereRight) << seed;
  }
}

TEST(WindowParts, SayByHowMuchItsSigmasAreTooSmall) {
  const WavingTracks sequence(kWindowFrames, CameraPath::kForwards, kWave_mm);
  SolvedWindow wrong = Solved(sequence);
  const double right = SigmaFactor(sequence, wrong);
  ASSERT_FALSE(wrong.IsRigid());
  std::vector<Eigen::Vector3d>& points = wrong.solution.window.points_in_world;
  for (std::size_t i = 0; i < points.size(); ++i) points[i] *= std::exp(i % 2 == 0 ? kWrong : -kWrong);
  const double factor = SigmaFactor(sequence, wrong);
  EXPECT_GT(factor, 5 * right);
}

TEST(WindowParts, SayNothingOfPointsThatTheyDoNotHave) {
  const WavingTracks sequence(kWindowFrames, CameraPath::kForwards, kWave_mm);
  SolvedWindow window = Solved(sequence);
  for (PointId& id : window.ids) id = {id.value + 100000};
  EXPECT_EQ(SigmaFactor(sequence, window), 1.0);
}

}  // namespace
}  // namespace pliant
