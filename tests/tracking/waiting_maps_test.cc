// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/bootstrapping/waiting_maps.h"

#include <optional>

#include <gtest/gtest.h>

namespace pliant {
namespace {

constexpr double kMapSigma = 0.02;
constexpr int kFramesOfReference = 50;
constexpr int kMaxWaitFrames = 150;

// A provisional one of a deforming window.
MadeMap Deforming(double linear_signal, double sigma_factor, int frame_idx = 0) {
  MadeMap made;
  made.map.frames = {{frame_idx, {}}};
  made.map.outcome.frames = {{frame_idx, {}, {}}};
  made.map.outcome.provisional = made.map.outcome.deforming = true;
  made.map.outcome.measured.median_depth_sigma = kMapSigma;
  made.map.outcome.measured.depth_spread = linear_signal * kMapSigma;
  made.map.outcome.measured.sigma_factor = sigma_factor;
  return made;
}

TEST(WaitingMaps, APartOfItsFramesMakesAMapWeak) {
  EXPECT_FALSE(IsWeak(Deforming(2.5, 1).map.outcome));
  EXPECT_TRUE(IsWeak(Deforming(2.5, 1.5).map.outcome));
  EXPECT_FALSE(IsWeak(Deforming(3.5, 2).map.outcome));  // which is certain by its own
}

TEST(WaitingMaps, TheOneThatItsOwnFramesContradictGivesWay) {
  std::optional<MadeMap> best;
  PutAside(Deforming(4, 3), &best);
  PutAside(Deforming(2.5, 1), &best);
  ASSERT_TRUE(best);
  EXPECT_EQ(best->map.outcome.measured.sigma_factor, 1);
}

TEST(WaitingMaps, ALongerWindowOfTheReferenceGivesWayToWhatIsMoreCertainInAllWaysAlone) {
  const auto later_one_stays = [](double linear_signal, double sigma_factor, int reference) {
    const MadeMap later = Deforming(linear_signal, sigma_factor, reference);
    return !WeakMap().HasBetterThan(later.map.outcome, Deforming(2.9, 1));
  };
  EXPECT_TRUE(later_one_stays(4.5, 2, 0));
  EXPECT_FALSE(later_one_stays(2.8, 1, 0));
  EXPECT_FALSE(later_one_stays(4.5, 2, 50)) << "the windows have no frames in common";
}

// A provisional one of a rigid window, of a later reference.
MadeMap Rigid(double signal) {
  MadeMap made = Deforming(signal, 1, kFramesOfReference);
  made.map.outcome.deforming = false;
  return made;
}

TEST(WaitingMaps, AWeakOneGivesWayToALaterReferencesUnlessThatKnowsLess) {
  for (const double signal : {1.2, 2.8}) {
    WeakMap weak;
    EXPECT_FALSE(weak.GiveUpReference(Deforming(1.8, 1), kFramesOfReference, kMaxWaitFrames));
    EXPECT_EQ(weak.HasBetterThan(Rigid(signal).map.outcome, std::nullopt), signal < 1.8) << signal;
    const auto taken = weak.EndWait(Rigid(signal));
    ASSERT_TRUE(taken);
    EXPECT_EQ(taken->map.outcome.deforming, signal < 1.8) << signal;
  }
}

TEST(WaitingMaps, AWeakOneWaitsForLaterReferences) {
  WeakMap weak;
  EXPECT_FALSE(weak.GiveUpReference(Deforming(2.5, 2, 7), kFramesOfReference, kMaxWaitFrames));
  EXPECT_EQ(weak.Since(), 7);
  for (int k = 0; k < kFramesOfReference; ++k) weak.CountFrame();
  EXPECT_FALSE(weak.GiveUpReference(std::nullopt, kFramesOfReference, kMaxWaitFrames));
  for (int k = 0; k < kFramesOfReference; ++k) weak.CountFrame();
  EXPECT_TRUE(weak.GiveUpReference(std::nullopt, kFramesOfReference, kMaxWaitFrames));
  EXPECT_FALSE(weak.IsThere());
}

TEST(WaitingMaps, DoubtEndsTheWaitOfThoseWhoseOwnSigmasAreWeak) {
  for (const double linear_signal : {1.5, 2.5}) {
    WeakMap weak;
    EXPECT_FALSE(weak.GiveUpReference(Deforming(linear_signal, 2), kFramesOfReference, kMaxWaitFrames));
    weak.Doubt();
    EXPECT_EQ(weak.IsThere(), linear_signal > 2) << linear_signal;
  }
}

TEST(WaitingMaps, AnotherReferencesAmbiguityLeavesMapsOfDeformingWindowsAlone) {
  std::optional<MadeMap> deforming = Deforming(2.5, 1);
  DoubtRigidity(&deforming);
  EXPECT_TRUE(deforming);
  std::optional<MadeMap> rigid = Rigid(5);
  DoubtRigidity(&rigid);
  EXPECT_FALSE(rigid);
}

TEST(WaitingMaps, DoubtLeavesAReferenceNoMapThatIsUncertainOrOfACameraThatMayStandStill) {
  for (const bool camera_may_stand_still : {false, true})
    for (const double signal : {2.5, 4.0}) {
      std::optional<MadeMap> of_reference = Deforming(signal, 1);
      Doubt(camera_may_stand_still, &of_reference);
      EXPECT_EQ(of_reference.has_value(), signal > 3 && !camera_may_stand_still) << signal;
    }
}

}  // namespace
}  // namespace pliant
