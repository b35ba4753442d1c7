// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the window says of the camera: whether it moves, and whether its focal length is the calibrated one.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/base/random.h"
#include "pliant/tracking/bootstrapping/make_initializer.h"
#include "support/waving_tracks.h"
#include "tracking/bootstrapping/window_map.h"
#include "tracking/bootstrapping/window_solution.h"

namespace pliant {
namespace {

using testing::HasSubstr;

using test::CameraPath;
using test::kNoisePx;
using test::kNominalMm;
using test::WavingTracks;

TEST(WindowCamera, SaysThatTheCameraOnlyTurned) {
  const InitOutcome outcome = WavingTracks(31, CameraPath::kRotation).Try({});
  EXPECT_EQ(outcome.decision, InitDecision::kWait);
  EXPECT_THAT(outcome.reason, HasSubstr("rotated or stood still"));
}

enum class SceneMotion { kNone, kWave };

// A camera that turns about the scene: if it moved along its axis, any focal length would do.
WavingTracks Orbit(int frames, SceneMotion motion) {
  WavingTracks sequence(frames, CameraPath::kStill);
  const Eigen::Vector3d center(0, 0, 60);
  Random random(3);
  for (std::size_t t = 0; t < sequence.frames.size(); ++t)
    for (InitObservation& seen : sequence.frames[t].observations) {
      const int time = motion == SceneMotion::kWave ? static_cast<int>(t) : 0;
      const Eigen::Vector3d from_center = sequence.At(static_cast<int>(seen.id.value), time) - center;
      const Eigen::Quaterniond turn = RotationExp(Eigen::Vector3d(0, 0.01 * static_cast<double>(t), 0));
      seen.pixel = *sequence.camera.Project(center + turn * from_center) +
                   kNoisePx * Eigen::Vector2d(random.Normal(), random.Normal());
    }
  return sequence;
}

TEST(WindowCamera, SaysThatTheImagesContradictTheFocalLength) {
  WavingTracks rigid = Orbit(31, SceneMotion::kNone);
  EXPECT_EQ(rigid.Try({}, InitMoment::kLastFrame).measured.focal_length_factor, 1.0);
  constexpr double kWrong = 0.75;
  rigid.camera = rigid.camera.WithFocalLengthTimes(kWrong).value();
  const InitOutcome outcome = rigid.Try({}, InitMoment::kLastFrame);
  EXPECT_NEAR(outcome.measured.focal_length_factor, 1 / kWrong, 0.05);
  EXPECT_THAT(outcome.reason, HasSubstr("contradict the focal length"));
}

// (W20) What contradicts a rigid scene of this calibration may as well be a deformation.
TEST(WindowCamera, ARigidMapThatContradictsTheFocalLengthIsPutAside) {
  WavingTracks rigid = Orbit(16, SceneMotion::kNone);
  WindowInitOptions options;
  options.max_correlation = 1;  // the errors that neighbors share do not refuse it
  const InitOutcome right = rigid.Try(options);
  ASSERT_EQ(right.decision, InitDecision::kMap) << right.reason;
  EXPECT_FALSE(right.provisional);
  rigid.camera = rigid.camera.WithFocalLengthTimes(0.5).value();
  const InitOutcome wrong = rigid.Try(options);
  ASSERT_NE(wrong.measured.focal_length_factor, 1.0) << wrong.reason;
  EXPECT_EQ(wrong.decision, InitDecision::kProvisional) << wrong.reason;
  EXPECT_TRUE(wrong.provisional);
  EXPECT_FALSE(wrong.refinable);
  EXPECT_EQ(rigid.Try(options, InitMoment::kLastFrame).decision, InitDecision::kMap);
  options.provisional = Switch::kOff;
  const InitOutcome refused = rigid.Try(options);
  EXPECT_EQ(refused.decision, InitDecision::kWait);
  EXPECT_THAT(refused.reason, HasSubstr("a rigid motion does not explain the images with this focal length"));
}

// (W20) Of a flat scene, whose depths hardly stand out.
TEST(WindowCamera, AfterCameraAndSceneCouldNotBeToldApartDepthsOfARigidMapHaveToStandOut) {
  const WavingTracks plane(46, CameraPath::kForwards, 0, 0);
  const auto initializer = MakeWindowInitializer({}, kNominalMm);
  InitInput input{plane.camera, plane.frames, {}};
  const InitOutcome map = initializer->Try(input);
  ASSERT_EQ(map.decision, InitDecision::kMap) << map.reason;
  ASSERT_TRUE(map.provisional);
  ASSERT_FALSE(map.deforming || map.allows_deformation);
  input.was_ambiguous = true;
  const InitOutcome refused = initializer->Try(input);
  EXPECT_EQ(refused.decision, InitDecision::kWait);
  EXPECT_THAT(refused.reason, HasSubstr("could not be told apart by another reference"));
  const WavingTracks deep(46, CameraPath::kForwards, 0);
  InitInput of_deep{deep.camera, deep.frames, {}};
  of_deep.was_ambiguous = true;
  EXPECT_EQ(initializer->Try(of_deep).decision, InitDecision::kMap);
  // Nor may they be less certain than demanded, however they stand out.
  WindowInitOptions strict;
  strict.certain_depth_sigma = strict.max_depth_sigma = strict.last_depth_sigma = 1e-4;
  const InitOutcome uncertain = MakeWindowInitializer(strict, kNominalMm)->Try(of_deep);
  EXPECT_EQ(uncertain.decision, InitDecision::kWait) << uncertain.reason;
  EXPECT_THAT(uncertain.reason, HasSubstr("not as certain as demanded"));
}

TEST(WindowCamera, ASceneThatDeformsDoesNotContradictTheFocalLength) {
  for (const int frames : {16, 31, 51}) {
    const InitOutcome outcome = Orbit(frames, SceneMotion::kWave).Try({}, InitMoment::kLastFrame);
    EXPECT_EQ(outcome.measured.focal_length_factor, 1.0) << frames;
  }
}

TEST(WindowCamera, SaysWhenCameraAndSceneCannotBeToldApart) {
  const WavingTracks held(51, CameraPath::kHeld);
  const InitOutcome outcome = held.Try({});
  EXPECT_EQ(outcome.decision, InitDecision::kNewReference);
  EXPECT_TRUE(outcome.ambiguous);
  EXPECT_LT(outcome.measured.still_camera_error_ratio, WindowInitOptions().min_still_camera_ratio);
  EXPECT_THAT(outcome.reason, HasSubstr("cannot be told apart"));
  WindowInitOptions unasked;
  unasked.min_still_camera_ratio = 0;
  EXPECT_EQ(held.Try(unasked).decision, InitDecision::kMap) << "nothing else refuses it";
}

// A camera that stands still before a wall of which a part moves, in noisy images.
WavingTracks PokedWall(int frames) {
  WavingTracks sequence(frames, CameraPath::kStill);
  Random random(8);
  for (std::size_t t = 0; t < sequence.frames.size(); ++t)
    for (InitObservation& seen : sequence.frames[t].observations) {
      const Eigen::Vector3d& point = sequence.points[static_cast<std::size_t>(seen.id.value)];
      const double poke =
          std::exp(-point.head<2>().squaredNorm() / (2 * 10 * 10)) * std::sin(0.08 * static_cast<double>(t));
      seen.pixel += Eigen::Vector2d(20 * poke, 0) + 0.2 * Eigen::Vector2d(random.Normal(), random.Normal());
    }
  return sequence;
}

TEST(WindowCamera, TakesNoPokeForAMotionOfTheCamera) {
  for (const int frames : {11, 16, 21, 31, 46}) {
    const InitOutcome outcome = PokedWall(frames).Try({});
    EXPECT_NE(outcome.decision, InitDecision::kMap) << frames << ": " << outcome.reason;
    EXPECT_NE(outcome.decision, InitDecision::kProvisional) << frames << ": " << outcome.reason;
  }
}

// Whatever depths lack, the window says whether it may be that the camera moves.
TEST(WindowCamera, WithoutAMapItSaysWhetherTheCameraMayStandStill) {
  WindowInitOptions options;
  options.certain_depth_sigma = options.last_depth_sigma = options.max_depth_sigma = 1e-4;
  options.provisional = Switch::kOff;
  const InitOutcome held = WavingTracks(61, CameraPath::kHeld).Try(options);
  ASSERT_EQ(held.decision, InitDecision::kNewReference) << held.reason;
  EXPECT_TRUE(held.camera_may_stand_still) << held.reason;
  EXPECT_FALSE(held.ambiguous) << "there would be no map if it moved";
  EXPECT_THAT(held.reason, HasSubstr("camera and scene cannot be told apart"));
  const InitOutcome moving = WavingTracks(61).Try(options);
  ASSERT_EQ(moving.decision, InitDecision::kNewReference) << moving.reason;
  EXPECT_FALSE(moving.camera_may_stand_still);
  EXPECT_THAT(moving.reason, HasSubstr("points is known to"));
}

TEST(WindowCamera, ARigidMotionThatExplainsLittleMakesNoMapOfAFlatScene) {
  const WavingTracks plane(36, CameraPath::kForwards, 0, 0);
  const InitInput input{plane.camera, plane.frames, {}};
  auto window = SolveAsRigid(input, plane.frames.size(), {}, kNominalMm);
  ASSERT_TRUE(window.ok()) << window.status().message();
  const auto map_if_correlated = [&](double correlation) {
    window->solution.residual_correlation = correlation;
    InitOutcome outcome;
    return MakeWindowMap(input, *window, DemandsOf({}, 1.0), {}, kNominalMm, &outcome);
  };
  const Status of_noise = map_if_correlated(0.5 * kMaxNoiseCorrelation);
  EXPECT_TRUE(of_noise.ok()) << of_noise.message();
  EXPECT_THAT(map_if_correlated(1.5 * kMaxNoiseCorrelation).message(), HasSubstr("does not explain all"));
}

TEST(WindowCamera, SaysByHowMuchTheCameraMoves) {
  const InitOutcome outcome = WavingTracks(61).Try({});
  ASSERT_EQ(outcome.decision, InitDecision::kMap) << outcome.reason;
  EXPECT_FALSE(outcome.ambiguous);
  EXPECT_GT(outcome.measured.still_camera_error_ratio, WindowInitOptions().min_still_camera_ratio);
  EXPECT_THAT(outcome.reason, HasSubstr("with a camera that stands still"));
}

// Errors alone would never do here, as in images in which noise hides what they tell.
WindowInitOptions WithoutErrors() {
  WindowInitOptions options;
  options.min_still_camera_ratio = 1e3;
  return options;
}

TEST(WindowCamera, DepthsThatStandOutShowThatTheCameraMoves) {
  const InitOutcome last = WavingTracks(61).Try(WithoutErrors());
  EXPECT_EQ(last.decision, InitDecision::kMap) << last.reason;
  EXPECT_TRUE(last.moves_by_depth);
  EXPECT_FALSE(last.ambiguous || last.camera_may_stand_still);
  const InitOutcome early = WavingTracks(41).Try(WithoutErrors());
  EXPECT_EQ(early.decision, InitDecision::kProvisional) << "a later window may contradict it: " << early.reason;
  EXPECT_TRUE(early.moves_by_depth);
}

TEST(WindowCamera, DepthsShowNothingWhereAnEarlierWindowContradictsThem) {
  const WavingTracks moving(61);
  const InitOutcome outcome = MakeWindowInitializer(WithoutErrors(), kNominalMm)
                                  ->Try({.camera = moving.camera,
                                         .frames = moving.frames,
                                         .reference_depth_mm = {},
                                         .camera_may_stand_still = true});
  EXPECT_EQ(outcome.decision, InitDecision::kNewReference);
  EXPECT_TRUE(outcome.ambiguous);
  EXPECT_FALSE(outcome.camera_may_stand_still) << "this window itself says that it moves";
}

TEST(WindowCamera, AHeldCameraMayStandStillWhateverTheDepths) {
  const InitOutcome outcome = WavingTracks(51, CameraPath::kHeld).Try({});
  EXPECT_TRUE(outcome.camera_may_stand_still);
  EXPECT_FALSE(outcome.moves_by_depth);
}

TEST(WindowCamera, SaysThatTheCameraStoodStill) {
  const InitOutcome outcome = WavingTracks(31, CameraPath::kStill).Try({});
  EXPECT_EQ(outcome.decision, InitDecision::kWait);
  EXPECT_THAT(outcome.reason, HasSubstr("rotated or stood still"));
}

}  // namespace
}  // namespace pliant
