// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/window_initializer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/base/random.h"
#include "pliant/base/statistics.h"

namespace pliant {
namespace {

using testing::HasSubstr;

constexpr double kNominalMm = 50;
constexpr double kShape = 0.03;  // relative depth error, median; a constant depth has about 0.15
constexpr double kNoisePx = 0.05;

enum class CameraMotion { kForwards, kRotation };

// Tracks on a wavy surface that waves. Points 100 and above come into view later.
struct Sequence {
  Camera camera = Camera::Create(CameraModelId::kSimplePinhole, 640, 480, std::array{450.0, 319.5, 239.5}).value();
  std::vector<InitFrame> frames;
  std::vector<Eigen::Vector3d> points;
  std::vector<Rigid3> poses;

  explicit Sequence(int count, CameraMotion motion = CameraMotion::kForwards) {
    Random random(5);
    for (int i = 0; i < 160; ++i) {
      const double x = random.Uniform(-30, 30);
      const double y = random.Uniform(-22, 22);
      points.emplace_back(x, y, 60 + 15 * std::sin(x / 14) * std::cos(y / 18));
    }
    for (int t = 0; t < count; ++t) {
      poses.emplace_back(RotationExp(Eigen::Vector3d(0.02 * std::sin(0.05 * t), 0.002 * t, 0)),
                         motion == CameraMotion::kForwards ? Eigen::Vector3d(0.5 * std::sin(0.06 * t), 0, -0.5 * t)
                                                           : Eigen::Vector3d::Zero());
      InitFrame frame{100 + t, {}};
      for (int i = 0; i < 160; ++i) {
        if (i >= 100 && t < 10) continue;
        const Eigen::Vector3d x = poses.back() * At(i, motion == CameraMotion::kForwards ? t : 0);
        const auto pixel = camera.Project(x);
        if (!pixel || !camera.Contains(*pixel)) continue;
        InitObservation seen{PointId{i}, *pixel + kNoisePx * Eigen::Vector2d(random.Normal(), random.Normal())};
        seen.brightness = 255 * std::pow(30 / x.norm(), 2 / 2.2) * std::exp(random.Normal(0.1));
        frame.observations.push_back(seen);
      }
      frames.push_back(frame);
    }
  }

  Eigen::Vector3d At(int point, int t) const {
    const Eigen::Vector3d& rest = points[static_cast<std::size_t>(point)];
    const double phase = 0.02 * rest.sum();
    return rest + Eigen::Vector3d(0, 3 * (std::sin(0.12 * t + phase) - std::sin(phase)), 0);
  }

  InitOutcome Try(const WindowInitOptions& options, InitMoment moment = InitMoment::kMoreFollow) const {
    return MakeWindowInitializer(options, kNominalMm)->Try({camera, frames, {}, moment});
  }

  // Median relative depth error of a frame's positions, after the best scale.
  double ShapeError(const InitOutcome& outcome, int t) const {
    const InitFrameState& state = outcome.frames[static_cast<std::size_t>(t)];
    std::vector<double> ratios;
    for (const InitPosition& point : state.positions)
      ratios.push_back((state.cam_from_world * point.position).norm() /
                       (poses[static_cast<std::size_t>(t)] * At(static_cast<int>(point.id.value), t)).norm());
    const double scale = Median(ratios);
    for (double& ratio : ratios) ratio = std::abs(ratio / scale - 1);
    return Median(ratios);
  }
};

TEST(WindowInitializer, MapsASceneThatDeforms) {
  const Sequence sequence(61);
  const InitOutcome outcome = sequence.Try({});
  ASSERT_EQ(outcome.decision, InitDecision::kMap) << outcome.reason;
  EXPECT_THAT(outcome.reason, HasSubstr("deforming window of 61 frames"));
  ASSERT_EQ(outcome.frames.size(), sequence.frames.size());
  for (const int t : {0, 7, 30, 60}) EXPECT_LT(sequence.ShapeError(outcome, t), kShape) << t;
  EXPECT_EQ(outcome.frames.front().cam_from_world.translation, Eigen::Vector3d::Zero());
  std::vector<double> depths;
  for (const InitPoint& point : outcome.points) depths.push_back(point.position.z());
  EXPECT_NEAR(Median(depths), kNominalMm, 1e-9);
}

TEST(WindowInitializer, TakesPointsThatComeIntoViewLater) {
  const Sequence sequence(61);
  const InitOutcome outcome = sequence.Try({});
  ASSERT_EQ(outcome.decision, InitDecision::kMap) << outcome.reason;
  int later = 0;
  for (const InitPoint& point : outcome.points) later += point.id.value >= 100 ? 1 : 0;
  EXPECT_GT(later, 20);
  for (const InitPosition& point : outcome.frames.front().positions) EXPECT_LT(point.id.value, 100);
}

TEST(WindowInitializer, EveryPointIsInTheMapOrRejected) {
  const Sequence sequence(61);
  const InitOutcome outcome = sequence.Try({});
  std::set<PointId> ids;
  for (const InitPoint& point : outcome.points) EXPECT_TRUE(ids.insert(point.id).second);
  for (const InitRejectedPoint& point : outcome.rejected) EXPECT_TRUE(ids.insert(point.id).second);
  EXPECT_EQ(ids.size(), 160U);
}

TEST(WindowInitializer, LeavesOutAPointThatJumpsAbout) {
  Sequence sequence(61);
  for (std::size_t t = 0; t < sequence.frames.size(); ++t)
    for (InitObservation& seen : sequence.frames[t].observations)
      if (seen.id == PointId{42} && t > 0) seen.pixel.x() += 2 * std::sin(static_cast<double>(t * t));
  const InitOutcome outcome = sequence.Try({});
  ASSERT_EQ(outcome.decision, InitDecision::kMap) << outcome.reason;
  const InitRejectedPoint* jumping = FindById(outcome.rejected, PointId{42});
  ASSERT_NE(jumping, nullptr);
  EXPECT_EQ(jumping->reason, InitRejection::kReprojection);
}

TEST(WindowInitializer, LeavesOutAPointThatIsWrongBetweenTheViews) {
  Sequence sequence(61);  // a view every 6 frames
  for (std::size_t t = 0; t < sequence.frames.size(); ++t)
    for (InitObservation& seen : sequence.frames[t].observations)
      if (seen.id == PointId{42} && t % 6 != 0) seen.pixel.x() += 2 * std::sin(static_cast<double>(t * t));
  const InitOutcome outcome = sequence.Try({});
  ASSERT_EQ(outcome.decision, InitDecision::kMap) << outcome.reason;
  const InitRejectedPoint* wrong = FindById(outcome.rejected, PointId{42});
  ASSERT_NE(wrong, nullptr);
  EXPECT_EQ(wrong->reason, InitRejection::kReprojection);
  EXPECT_EQ(outcome.measured.inliers, static_cast<int>(outcome.points.size()));
}

TEST(WindowInitializer, MakesNoMapOfPointsThatAreAllWrongBetweenTheViews) {
  Sequence sequence(46);
  const std::set<std::size_t> views = {0, 5, 9, 14, 18, 23, 27, 32, 36, 41, 45};
  Random random(6);
  for (std::size_t t = 0; t < sequence.frames.size(); ++t)
    for (InitObservation& seen : sequence.frames[t].observations)
      if (!views.contains(t)) seen.pixel += 2 * Eigen::Vector2d(random.Normal(), random.Normal());
  const InitOutcome outcome = sequence.Try({});
  EXPECT_EQ(outcome.decision, InitDecision::kWait);
  EXPECT_THAT(outcome.reason, HasSubstr("agree with the frames between"));
  EXPECT_TRUE(outcome.points.empty());
}

TEST(WindowInitializer, WithoutAgreementOfTheSamplesThereIsAMapAtTheEndAlone) {
  const Sequence sequence(31);  // too short for the samples to agree well
  WindowInitOptions options;
  options.max_depth_sigma = 0.04;
  EXPECT_EQ(sequence.Try(options).decision, InitDecision::kWait);
  const InitOutcome last = sequence.Try(options, InitMoment::kLastFrame);
  ASSERT_EQ(last.decision, InitDecision::kMap) << last.reason;
  EXPECT_THAT(last.reason, HasSubstr("samples of the points do not agree"));
}

TEST(WindowInitializer, WaitsWhileMostPointsAreUncertain) {
  const Sequence sequence(31);
  WindowInitOptions options;
  options.max_depth_sigma = 0.002;
  const InitOutcome waiting = sequence.Try(options);
  EXPECT_EQ(waiting.decision, InitDecision::kWait);
  EXPECT_THAT(waiting.reason, HasSubstr("is certain"));
  EXPECT_EQ(sequence.Try(options, InitMoment::kLastFrame).decision, InitDecision::kNewReference);
}

TEST(WindowInitializer, AttemptsAtTheSequencesEndWhatItWouldHaveWaitedFor) {
  const Sequence sequence(41);  // due after 30 and 45 frames
  const InitOutcome waiting = sequence.Try({});
  EXPECT_EQ(waiting.decision, InitDecision::kWait);
  EXPECT_THAT(waiting.reason, HasSubstr("the window has 41 frames"));
  const InitOutcome last = sequence.Try({}, InitMoment::kLastFrame);
  ASSERT_EQ(last.decision, InitDecision::kMap) << last.reason;
  EXPECT_LT(sequence.ShapeError(last, 40), kShape);
}

TEST(WindowInitializer, SaysThatTheCameraOnlyTurned) {
  const InitOutcome outcome = Sequence(31, CameraMotion::kRotation).Try({});
  EXPECT_EQ(outcome.decision, InitDecision::kWait);
  EXPECT_THAT(outcome.reason, HasSubstr("rotated or stood still"));
}

TEST(WindowInitializer, AsksForANewReferenceWhenTooFewPointsAreLeft) {
  Sequence sequence(31);
  sequence.frames.back().observations.resize(10);
  const InitOutcome outcome = sequence.Try({});
  EXPECT_EQ(outcome.decision, InitDecision::kNewReference);
  EXPECT_THAT(outcome.reason, HasSubstr("only 10"));
}

}  // namespace
}  // namespace pliant
