// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Provisional maps that are hardly better than one constant depth wait for what the next references give.
#include <cstdlib>
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

using tracking_test::TrackerFromImages;

constexpr double kDepthSigma = 0.02;
constexpr double kWeakSignal = 1.0;
constexpr double kStrongSignal = 2.5;
constexpr double kNoMap = 0;
constexpr int kImagesShown = 40;  // there and back again, so that every reference sees the camera move

// Gives every reference one provisional map of a scene that deforms, whose depths stand out so much, or none, and then
// gives the reference up. Later references carry nothing.
class OneMapAReference final : public Initializer {
 public:
  OneMapAReference(std::vector<double> signals, bool ambiguous_at_last)
      : gated_(MakeGatedInitializer(InitOptions().monocular, Random(1).Child("initializer"))),
        signals_(std::move(signals)),
        ambiguous_at_last_(ambiguous_at_last) {}
  std::string_view name() const override { return "one map a reference"; }
  InitOutcome Try(const InitInput& input) const override {
    if (references_.empty() || references_.back() != input.frames.front().frame_idx) {
      references_.push_back(input.frames.front().frame_idx);
      made_ = false;
    }
    const std::size_t reference = references_.size() - 1;
    InitOutcome outcome;
    if (!made_ && reference < signals_.size() && signals_[reference] > 0) outcome = gated_->Try(input);
    if (outcome.decision == InitDecision::kMap) {
      made_ = true;
      outcome.decision = InitDecision::kProvisional;
      outcome.provisional = outcome.deforming = true;
      outcome.measured.median_depth_sigma = kDepthSigma;
      outcome.measured.depth_spread = signals_[reference] * kDepthSigma;
      return outcome;
    }
    const bool carries_none = reference >= signals_.size() || signals_[reference] == kNoMap;
    const bool waited = input.frames.size() > kReferenceFrames;
    outcome.decision = made_ || (carries_none && waited) ? InitDecision::kNewReference : InitDecision::kWait;
    if (ambiguous_at_last_ && reference + 1 == signals_.size() && outcome.decision == InitDecision::kNewReference) {
      outcome.ambiguous = true;
      outcome.reason = "camera and scene cannot be told apart";
    }
    return outcome;
  }
  const std::vector<int>& references() const { return references_; }

 private:
  static constexpr std::size_t kReferenceFrames = 4;

  std::shared_ptr<const Initializer> gated_;
  std::vector<double> signals_;
  bool ambiguous_at_last_;
  mutable std::vector<int> references_;
  mutable bool made_ = false;
};

class WeakMaps : public TrackerFromImages {
 protected:
  // Shows images there and back again until the tracker goes back, and ends the sequence if it never does.
  void Show(const std::vector<double>& signals, bool ambiguous_at_last = false) {
    initializer_ = std::make_shared<OneMapAReference>(signals, ambiguous_at_last);
    Tracker tracker(*camera_, options_, 1, 1, {.extensions = {.initializer = initializer_}});
    constexpr int kLast = tracking_test::kFrames - 1;
    for (shown_ = 0; shown_ < kImagesShown && !back_; ++shown_) {
      const int image = kLast - std::abs(kLast - shown_ % (2 * kLast));
      for (FrameReport& report : TrackerFromImages::Show(image, shown_, &tracker))
        reports_.push_back(std::move(report));
      back_ = tracker.TakeGoesBackTo();
    }
    back_ = End(back_, &tracker, &reports_);
    EXPECT_EQ(std::ssize(reports_), shown_);
  }
  // The reference of the map that is there in the end; -1: there is none.
  int ReferenceOfMap() const {
    for (const FrameReport& report : reports_)
      if (report.first_map) return report.first_map->reference_frame_idx;
    return -1;
  }

  TrackerOptions options_;
  std::shared_ptr<const OneMapAReference> initializer_;
  std::vector<FrameReport> reports_;
  std::optional<int> back_;
  int shown_ = 0;
};

TEST_F(WeakMaps, GivesWayToOneOfTheNextReferenceWhoseDepthsStandOut) {
  Show({kWeakSignal, kStrongSignal});
  ASSERT_GE(initializer_->references().size(), 2U);
  const int second = initializer_->references()[1];
  EXPECT_EQ(ReferenceOfMap(), second);
  ASSERT_TRUE(back_);
  for (int k = 0; k <= *back_; ++k)
    EXPECT_EQ(reports_[static_cast<std::size_t>(k)].state == TrackingState::kInitializing, k < second) << k;
}

TEST_F(WeakMaps, IsTakenAtTheEndWhereNoneStandsOut) {
  Show({kWeakSignal});
  EXPECT_GT(initializer_->references().size(), 2U);
  EXPECT_EQ(shown_, kImagesShown);
  EXPECT_EQ(ReferenceOfMap(), 0);
  ASSERT_TRUE(back_);
  EXPECT_LT(*back_, initializer_->references()[1]);
}

TEST_F(WeakMaps, TheBetterOfTwoIsTaken) {
  Show({kWeakSignal, 1.2 * kWeakSignal});
  EXPECT_EQ(ReferenceOfMap(), initializer_->references()[1]);
}

TEST_F(WeakMaps, DoesNotWaitForEver) {
  options_.init.window.last_frame = 6;
  Show({kWeakSignal});
  EXPECT_LT(shown_, kImagesShown);
  EXPECT_GE(shown_, 3 * options_.init.window.last_frame);
  EXPECT_EQ(ReferenceOfMap(), 0);
}

TEST_F(WeakMaps, IsForgottenWhereCameraAndSceneCannotBeToldApart) {
  Show({kWeakSignal, kNoMap}, /*ambiguous_at_last=*/true);
  EXPECT_EQ(ReferenceOfMap(), -1);
  const int second = initializer_->references()[1];
  const int third = initializer_->references()[2];
  for (const FrameReport& report : reports_) {
    const bool ambiguous = second <= report.frame_idx && report.frame_idx < third;
    EXPECT_EQ(report.state == TrackingState::kAmbiguous, ambiguous) << report.frame_idx;
  }
}

TEST_F(WeakMaps, OneWhoseDepthsStandOutDoesNotWait) {
  Show({kStrongSignal, 2 * kStrongSignal});
  EXPECT_EQ(ReferenceOfMap(), 0);
  EXPECT_EQ(initializer_->references().size(), 1U);
}

}  // namespace
}  // namespace pliant
