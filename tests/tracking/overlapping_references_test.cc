// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Halfway through a reference's time the next one is begun beside it.
#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "pliant/base/random.h"
#include "pliant/tracking/bootstrapping/make_initializer.h"
#include "tracking/tracker_from_images.h"

namespace pliant {
namespace {

using tracking_test::kFrames;
using tracking_test::TrackerFromImages;

constexpr int kLastFrame = 8;
constexpr int kHalf = kLastFrame / 2;
constexpr double kDepthSigma = 0.02;

// What a reference answers in the frame so long after it.
struct Turn {
  int reference_frame_idx = 0;
  std::size_t frames = 0;  // since the reference, which counts
  InitDecision decision = InitDecision::kWait;
  double signal = 2.5;  // of a map
  bool at_end = false;  // of the sequence alone; then its map is provisional
};

// Maps of a few frames are uncertain here, which does not matter.
MonocularInitOptions OfFewFrames() {
  MonocularInitOptions options;
  options.min_parallax_deg = 0.1;
  options.min_competing_cost_ratio = 1;
  options.max_median_depth_sigma = options.max_depth_sigma = 1;
  return options;
}

// Answers by turns, waits otherwise, and remembers what it was asked.
class Turns final : public Initializer {
 public:
  explicit Turns(std::vector<Turn> turns)
      : gated_(MakeGatedInitializer(OfFewFrames(), Random(1).Child("initializer"))), turns_(std::move(turns)) {}
  std::string_view name() const override { return "turns"; }
  bool TakesLaterPoints() const override { return true; }
  InitOutcome Try(const InitInput& input) const override {
    asked_.push_back({input.frames.front().frame_idx, input.frames.size()});
    const auto turn = std::ranges::find_if(turns_, [&](const Turn& t) {
      return t.reference_frame_idx == input.frames.front().frame_idx && t.frames == input.frames.size() &&
             (!t.at_end || input.moment == InitMoment::kLastFrame);
    });
    InitOutcome outcome;
    if (turn == turns_.end()) return outcome;
    if (turn->decision == InitDecision::kMap || turn->decision == InitDecision::kProvisional) {
      outcome = gated_->Try(input);
      if (outcome.decision != InitDecision::kMap) {
        ADD_FAILURE() << outcome.reason;
        return outcome;
      }
      outcome.provisional = outcome.deforming = turn->at_end || turn->decision == InitDecision::kProvisional;
      outcome.measured.median_depth_sigma = kDepthSigma;
      outcome.measured.depth_spread = turn->signal * kDepthSigma;
    }
    outcome.decision = turn->decision;
    return outcome;
  }
  bool WasAsked(int reference_frame_idx, std::size_t frames) const {
    return std::ranges::any_of(
        asked_, [&](const Turn& t) { return t.reference_frame_idx == reference_frame_idx && t.frames == frames; });
  }
  bool HadReference(int frame_idx) const {
    return std::ranges::any_of(asked_, [&](const Turn& t) { return t.reference_frame_idx == frame_idx; });
  }

 private:
  std::shared_ptr<const Initializer> gated_;
  std::vector<Turn> turns_;
  mutable std::vector<Turn> asked_;
};

class OverlappingReferences : public TrackerFromImages {
 protected:
  OverlappingReferences() { options_.init.window.last_frame = kLastFrame; }

  // Shows all images, until the tracker goes back.
  void Show(std::vector<Turn> turns) {
    initializer_ = std::make_shared<Turns>(std::move(turns));
    Tracker tracker(*camera_, options_, 1, 1, {.extensions = {.initializer = initializer_}});
    for (int i = 0; i < kFrames && !back_; ++i) {
      for (FrameReport& report : TrackerFromImages::Show(i, i, &tracker)) reports_.push_back(std::move(report));
      back_ = tracker.TakeGoesBackTo();
    }
    back_ = End(back_, &tracker, &reports_);
  }
  // The first map's reference and last frame.
  std::optional<std::pair<int, int>> MapFrames() const {
    for (const FrameReport& report : reports_)
      if (report.first_map)
        return std::pair(report.first_map->reference_frame_idx, report.first_map->declared_frame_idx);
    return std::nullopt;
  }
  // All frames from this one on have a map, and none before.
  void ExpectMapSince(int frame_idx) const {
    for (const FrameReport& report : reports_)
      EXPECT_EQ(report.cam_from_world.has_value(), report.frame_idx >= frame_idx) << report.frame_idx;
  }

  TrackerOptions options_;
  std::shared_ptr<const Turns> initializer_;
  std::vector<FrameReport> reports_;
  std::optional<int> back_;
};

TEST_F(OverlappingReferences, TheNextOneIsAskedBesideThePresentOne) {
  Show({});
  EXPECT_TRUE(initializer_->WasAsked(0, kFrames - 1));
  EXPECT_TRUE(initializer_->WasAsked(kHalf, kFrames - kHalf));
  EXPECT_FALSE(initializer_->HadReference(kHalf + kHalf)) << "one at a time";
  EXPECT_FALSE(MapFrames());
}

TEST_F(OverlappingReferences, ACertainMapOfTheNextOneIsTaken) {
  Show({{kHalf, 7, InitDecision::kMap}});
  EXPECT_EQ(MapFrames(), std::pair(kHalf, kHalf + 6));
  ExpectMapSince(kHalf);
}

TEST_F(OverlappingReferences, TheNextOneTakesThePlaceOfThePresentOneWithItsFrames) {
  Show({{0, kLastFrame, InitDecision::kNewReference}, {kHalf, 9, InitDecision::kMap}});
  EXPECT_EQ(MapFrames(), std::pair(kHalf, kHalf + 8));
  ExpectMapSince(kHalf);
  EXPECT_TRUE(initializer_->HadReference(kLastFrame)) << "halfway through its time the one after it begins";
}

TEST_F(OverlappingReferences, WhatTheNextOnePutAsideWaitsForThePresentOne) {
  Show({{kHalf, 6, InitDecision::kProvisional},
        {kHalf, 7, InitDecision::kNewReference},
        {0, kFrames - 2, InitDecision::kNewReference}});
  EXPECT_EQ(MapFrames(), std::pair(kHalf, kHalf + 5));
  EXPECT_EQ(back_, kHalf + 5);
}

TEST_F(OverlappingReferences, WhatTheNextOnePutAsideGivesWayToACertainMap) {
  Show({{kHalf, 6, InitDecision::kProvisional},
        {kHalf, 7, InitDecision::kNewReference},
        {0, kFrames - 2, InitDecision::kMap}});
  EXPECT_EQ(MapFrames(), std::pair(0, kFrames - 3));
  ExpectMapSince(0);
}

TEST_F(OverlappingReferences, AtTheEndBothMakeALastAttempt) {
  Show({{kHalf, kFrames - kHalf, InitDecision::kWait}});
  EXPECT_TRUE(initializer_->WasAsked(0, kFrames));
  EXPECT_TRUE(initializer_->WasAsked(kHalf, kFrames - kHalf));
}

TEST_F(OverlappingReferences, TheEndMakesNoMapThatHardlyStandsOutOnceALongerReferenceWasGivenUp) {
  const Turn given_up{0, kFrames - 2, InitDecision::kNewReference};
  for (const double signal : {1.5, 2.5}) {
    reports_.clear();
    back_.reset();
    Show({given_up, {kHalf, kFrames - kHalf, InitDecision::kMap, signal, true}});
    EXPECT_EQ(MapFrames().has_value(), signal > 2) << signal;
  }
}

TEST_F(OverlappingReferences, ThereIsNoneWhereFramesDoNotComeAgain) {
  for (const int handover_frames : {0, 1}) {
    options_.handover_frames = handover_frames;
    Tracker tracker(*camera_, options_, 1, 1);
    TrackerFromImages::Show(0, 0, &tracker);
    const PointId after_first = tracker.next_point_id();
    for (int i = 1; i < options_.top_up_frames; ++i) TrackerFromImages::Show(i, i, &tracker);
    EXPECT_EQ(tracker.next_point_id() == after_first, handover_frames > 0);
  }
}

}  // namespace
}  // namespace pliant
