// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/map_upkeep/reestimate_map.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/base/random.h"
#include "support/waving_tracks.h"

namespace pliant {
namespace {

using test::CameraPath;
using test::kNoisePx;
using test::kShape;
using test::WavingTracks;
using testing::HasSubstr;

constexpr double kRefined = 0.5;              // of the error: six times the frames
constexpr double kNoisier = 1.5;              // times the sigma, for twice the noise
constexpr std::size_t kMinReestimated = 100;  // the others stay

TEST(ReestimateMap, RefinesTheMapOfARigidSceneByTheFramesThatFollow) {
  const WavingTracks start(11, CameraPath::kForwards, 0.0);
  const InitOutcome first = start.Try({});
  ASSERT_EQ(first.decision, InitDecision::kMap) << first.reason;
  EXPECT_TRUE(first.refinable);
  const WavingTracks longer(61, CameraPath::kForwards, 0.0);
  const InitOutcome refined = longer.Reestimate(WindowScene::kRigid);
  ASSERT_EQ(refined.decision, InitDecision::kMap) << refined.reason;
  EXPECT_EQ(refined.frames.size(), 61U);
  EXPECT_LT(longer.ShapeError(refined, 0), kRefined * start.ShapeError(first, 0));
  EXPECT_LT(longer.ShapeError(refined, 60), kRefined * start.ShapeError(first, 0));

  WindowInitOptions once;
  once.refine_rigid = Switch::kOff;
  EXPECT_FALSE(start.Try(once).refinable);
}

TEST(ReestimateMap, RefinesNoMapOfASceneThatDeforms) {
  const WavingTracks sequence(61);
  const InitOutcome first = sequence.Try({});
  ASSERT_EQ(first.decision, InitDecision::kMap) << first.reason;
  EXPECT_FALSE(first.refinable);
  const InitOutcome refined = sequence.Reestimate(WindowScene::kRigid);
  EXPECT_EQ(refined.decision, InitDecision::kNewReference);
  EXPECT_TRUE(refined.deforming);
  EXPECT_THAT(refined.reason, HasSubstr("the scene deforms"));
  // That too little was seen says nothing of the scene.
  EXPECT_FALSE(WavingTracks(2).Reestimate(WindowScene::kRigid).deforming);
}

// A tenth of a pixel a frame at most: what it tells the first map is no worse than noise.
TEST(ReestimateMap, APointThatDriftsStaysOut) {
  WavingTracks sequence(61, CameraPath::kForwards, 0.0);
  for (InitFrame& frame : sequence.frames)
    for (InitObservation& seen : frame.observations)
      if (seen.id == PointId{42}) seen.pixel.x() += 0.5 * std::sin(0.2 * (frame.frame_idx - 100));
  for (const WindowScene scene : {WindowScene::kRigid, WindowScene::kAny}) {
    const InitOutcome reestimated = sequence.Reestimate(scene);
    ASSERT_EQ(reestimated.decision, InitDecision::kMap) << reestimated.reason;
    EXPECT_EQ(FindById(reestimated.points, PointId{42}), nullptr);
    EXPECT_EQ(FindById(reestimated.rejected, PointId{42})->reason, InitRejection::kReprojection);
    EXPECT_GT(reestimated.points.size(), kMinReestimated);
  }
}

TEST(ReestimateMap, APointWithLargerErrorsIsLessCertain) {
  WavingTracks sequence(61, CameraPath::kForwards, 0.0);
  const InitOutcome clean = sequence.Reestimate(WindowScene::kRigid);
  ASSERT_EQ(clean.decision, InitDecision::kMap) << clean.reason;
  const InitPoint* before = FindById(clean.points, PointId{42});
  ASSERT_NE(before, nullptr);
  Random random(4);  // twice the noise of the others
  for (InitFrame& frame : sequence.frames)
    for (InitObservation& seen : frame.observations)
      if (seen.id == PointId{42})
        seen.pixel += Eigen::Vector2d(random.Normal(2 * kNoisePx), random.Normal(2 * kNoisePx));
  const InitOutcome noisy = sequence.Reestimate(WindowScene::kRigid);
  ASSERT_EQ(noisy.decision, InitDecision::kMap) << noisy.reason;
  const InitPoint* after = FindById(noisy.points, PointId{42});
  ASSERT_NE(after, nullptr);
  EXPECT_GT(after->depth_sigma, kNoisier * before->depth_sigma);
}

TEST(ReestimateMap, MakesAMapOfASceneThatDeformsWhereItMayBeAny) {
  const WavingTracks sequence(46);
  EXPECT_EQ(sequence.Reestimate(WindowScene::kRigid).decision, InitDecision::kNewReference);
  const InitOutcome reestimated = sequence.Reestimate(WindowScene::kAny);
  ASSERT_EQ(reestimated.decision, InitDecision::kMap) << reestimated.reason;
  EXPECT_LT(sequence.ShapeError(reestimated, 45), kShape);
  // Where there are too few points there is nothing to be made of them.
  WavingTracks empty(46);
  for (InitFrame& frame : empty.frames) frame.observations.resize(5);
  const InitOutcome none = empty.Reestimate(WindowScene::kAny);
  EXPECT_NE(none.decision, InitDecision::kMap);
  EXPECT_FALSE(none.reason.empty());
}

TEST(ReestimateMap, AProvisionalMapIsReplacedByAnother) {
  const WavingTracks sequence(46);
  WindowInitOptions options;
  options.certain_depth_sigma = options.max_depth_sigma = options.last_depth_sigma = 1e-4;
  EXPECT_EQ(sequence.Reestimate(WindowScene::kAny, false, options).decision, InitDecision::kWait);
  const InitOutcome reestimated = sequence.Reestimate(WindowScene::kAny, true, options);
  ASSERT_EQ(reestimated.decision, InitDecision::kMap) << reestimated.reason;
  EXPECT_TRUE(reestimated.provisional);
  EXPECT_LT(sequence.ShapeError(reestimated, 45), 2 * kShape);
  // It may be certain as well.
  EXPECT_FALSE(sequence.Reestimate(WindowScene::kAny, true).provisional);
}

}  // namespace
}  // namespace pliant
