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
  WaitingMaps maps;
  maps.Put(Deforming(4, 3));
  maps.Put(Deforming(2.5, 1));
  const auto taken = maps.Take();
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->map.outcome.measured.sigma_factor, 1);
  EXPECT_TRUE(maps.IsEmpty());
}

TEST(WaitingMaps, ALongerWindowOfTheReferenceGivesWayToWhatIsMoreCertainInAllWaysAlone) {
  const auto later_one_stays = [](double linear_signal, double sigma_factor, int reference) {
    WaitingMaps maps;
    maps.Put(Deforming(2.9, 1));
    MadeMap later = Deforming(linear_signal, sigma_factor, reference);
    return !maps.HasBetterThan(later.map.outcome);
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
    WaitingMaps maps;
    maps.Put(Deforming(1.8, 1));
    EXPECT_FALSE(maps.GiveUpReference(kFramesOfReference, kMaxWaitFrames));
    EXPECT_EQ(maps.HasBetterThan(Rigid(signal).map.outcome), signal < 1.8) << signal;
    maps.Put(Rigid(signal));
    maps.EndWait();
    const auto taken = maps.Take();
    ASSERT_TRUE(taken);
    EXPECT_EQ(taken->map.outcome.deforming, signal < 1.8) << signal;
  }
}

TEST(WaitingMaps, AWeakOneWaitsForLaterReferences) {
  WaitingMaps maps;
  maps.Put(Deforming(2.5, 2, 7));
  EXPECT_FALSE(maps.GiveUpReference(kFramesOfReference, kMaxWaitFrames));
  EXPECT_EQ(maps.WeakSince(), 7);
  for (int k = 0; k < kFramesOfReference; ++k) maps.CountFrame();
  EXPECT_FALSE(maps.GiveUpReference(kFramesOfReference, kMaxWaitFrames));
  for (int k = 0; k < kFramesOfReference; ++k) maps.CountFrame();
  EXPECT_TRUE(maps.GiveUpReference(kFramesOfReference, kMaxWaitFrames));
  EXPECT_TRUE(maps.IsEmpty());
}

TEST(WaitingMaps, DoubtEndsTheWaitOfThoseWhoseOwnSigmasAreWeak) {
  for (const double linear_signal : {1.5, 2.5}) {
    WaitingMaps maps;
    maps.Put(Deforming(linear_signal, 2));
    EXPECT_FALSE(maps.GiveUpReference(kFramesOfReference, kMaxWaitFrames));
    maps.Doubt(true);
    EXPECT_EQ(maps.WeakSince().has_value(), linear_signal > 2) << linear_signal;
  }
}

}  // namespace
}  // namespace pliant
