// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Parts that a program gives to the tracker are asked in place of its own.
#include "pliant/tracking/extensions.h"

#include <gmock/gmock.h>

#include "pliant/base/random.h"
#include "pliant/tracking/bootstrapping/make_initializer.h"
#include "tracking/tracker_from_images.h"
#include "tracking/tracks/patch_tracks.h"

namespace pliant {
namespace {

using testing::ElementsAre;
using tracking_test::kFrames;
using tracking_test::TrackerFromImages;

class Extensions : public TrackerFromImages {
 protected:
  static std::vector<FrameReport> Run(const TrackerOptions& options, const TrackerExtensions& extensions) {
    Tracker tracker(*camera_, options, 1, 1, {.extensions = extensions});
    std::vector<FrameReport> reports;
    for (int i = 0; i < kFrames; ++i)
      for (FrameReport& report : Show(i, i, &tracker)) reports.push_back(std::move(report));
    return reports;
  }
  static void ExpectSame(const std::vector<FrameReport>& some, const std::vector<FrameReport>& others) {
    ASSERT_EQ(some.size(), others.size());
    for (std::size_t k = 0; k < some.size(); ++k) {
      ASSERT_EQ(some[k].observations.size(), others[k].observations.size()) << k;
      for (std::size_t i = 0; i < some[k].observations.size(); ++i)
        EXPECT_EQ(some[k].observations[i].position, others[k].observations[i].position);
    }
  }
};

TEST_F(Extensions, AGivenInitializerMakesTheFirstMap) {
  TrackerOptions options;
  options.init.method = InitMethod::kGated;
  const std::vector<FrameReport> of_options = Run(options, {});
  ASSERT_FALSE(of_options.empty());
  options.init.method = InitMethod::kWindow;
  options.init.window.first_frame = 10 * kFrames;
  ASSERT_TRUE(Run(options, {}).empty());
  TrackerExtensions extensions;
  extensions.initializer = MakeGatedInitializer(options.init.monocular, Random(1).Child("initializer"));
  EXPECT_THAT(extensions.Names(), ElementsAre("initializer gated"));
  ExpectSame(Run(options, extensions), of_options);
}

// First a provisional map whose depths stand out; then one that is less certain; then none. `describe` says what else
// they are: of the map of this number, from 0.
class TwoMaps final : public Initializer {
 public:
  using Describe = std::function<void(int, InitOutcome*)>;
  explicit TwoMaps(Describe describe)
      : gated_(MakeGatedInitializer(InitOptions().monocular, Random(1).Child("initializer"))),
        describe_(std::move(describe)) {}
  std::string_view name() const override { return "two maps"; }
  InitOutcome Try(const InitInput& input) const override {
    InitOutcome outcome;
    if (made_ < 2) outcome = gated_->Try(input);
    if (outcome.decision == InitDecision::kMap) {
      outcome.decision = InitDecision::kProvisional;
      outcome.provisional = true;
      outcome.measured.depth_spread = 0.2;
      outcome.measured.median_depth_sigma = made_ == 0 ? 0.02 : 0.08;
      describe_(made_, &outcome);
      ++made_;
    }
    if (input.moment == InitMoment::kLastFrame) outcome.decision = InitDecision::kNewReference;
    return outcome;
  }
  int made() const { return made_; }

 private:
  std::shared_ptr<const Initializer> gated_;
  Describe describe_;
  mutable int made_ = 0;
};

class ExtensionsOfTwoMaps : public Extensions {
 protected:
  // Whether the second map is taken, which is less certain.
  static bool TakesSecond(const TwoMaps::Describe& describe) {
    const auto initializer = std::make_shared<TwoMaps>(describe);
    Tracker tracker(*camera_, {}, 1, 1, {.extensions = {.initializer = initializer}});
    for (int i = 0; i < kFrames; ++i) EXPECT_TRUE(Show(i, i, &tracker).empty());
    EXPECT_EQ(initializer->made(), 2);
    tracker.EndSequence();
    const std::vector<FrameReport> reports = tracker.Finish();
    const bool has_map = !reports.empty() && reports.front().first_map;
    EXPECT_TRUE(has_map);
    return has_map && reports.front().first_map->evidence.depth_sigma == 0.08;
  }
};

TEST_F(ExtensionsOfTwoMaps, TheMoreCertainOneIsTaken) {
  EXPECT_FALSE(TakesSecond([](int /*map*/, InitOutcome* /*outcome*/) {}));
}

TEST_F(ExtensionsOfTwoMaps, AMapOfARigidSceneGivesWayToOneThatDeforms) {
  EXPECT_TRUE(TakesSecond([](int map, InitOutcome* outcome) { outcome->deforming = map == 1; }));
}

TEST_F(ExtensionsOfTwoMaps, AMapWhoseFarPointsAreJudgedByThemselvesGivesWay) {
  EXPECT_TRUE(TakesSecond([](int map, InitOutcome* outcome) { outcome->far_by_own_distance = map == 0; }));
  EXPECT_FALSE(TakesSecond([](int map, InitOutcome* outcome) {
    outcome->deforming = true;
    outcome->far_by_own_distance = map == 1;
  }));
}

TEST_F(ExtensionsOfTwoMaps, WhatHalvesSayCountsMoreThanLinearSigmas) {
  EXPECT_FALSE(TakesSecond([](int map, InitOutcome* outcome) {
    (map == 0 ? outcome->allows_deformation : outcome->deforming) = true;
    if (map == 0) outcome->measured.median_depth_sigma = 0.09;
  }));
  EXPECT_TRUE(TakesSecond([](int map, InitOutcome* outcome) {
    (map == 1 ? outcome->allows_deformation : outcome->deforming) = true;
    if (map == 0) outcome->measured.median_depth_sigma = 0.07;
  }));
  // But not where the depths of the deforming window stand out as those of a certain map do.
  EXPECT_FALSE(TakesSecond([](int map, InitOutcome* outcome) {
    (map == 1 ? outcome->allows_deformation : outcome->deforming) = true;
    if (map == 0) outcome->measured.median_depth_sigma = 0.05;
  }));
}

// A provisional map whose depths stand out so much.
class ProvisionalMap final : public Initializer {
 public:
  ProvisionalMap(const InitOptions& options, double signal)
      : gated_(MakeGatedInitializer(options.monocular, Random(1).Child("initializer"))), signal_(signal) {}
  std::string_view name() const override { return "provisional"; }
  InitOutcome Try(const InitInput& input) const override {
    InitOutcome outcome = gated_->Try(input);
    outcome.provisional = true;
    outcome.measured.median_depth_sigma = 0.02;
    outcome.measured.depth_spread = signal_ * outcome.measured.median_depth_sigma;
    return outcome;
  }

 private:
  std::shared_ptr<const Initializer> gated_;
  double signal_;
};

TEST_F(Extensions, AProvisionalMapIsReestimatedByOneWhoseDepthsStandOutMore) {
  TrackerOptions options;
  options.growth.window = 7;
  options.growth.reestimate_every = 1;
  // None is certain.
  options.init.window.certain_depth_sigma = options.init.window.last_depth_sigma = 1e-4;
  options.init.window.max_depth_sigma = 1e-4;
  for (const double signal : {0.1, 1000.0}) {
    TrackerExtensions extensions;
    extensions.initializer = std::make_shared<ProvisionalMap>(InitOptions(), signal);
    const std::vector<FrameReport> reports = Run(options, extensions);
    ASSERT_FALSE(reports.empty());
    const bool is_reestimated = std::ranges::any_of(
        reports, [](const FrameReport& report) { return report.note.starts_with("the map was re-estimated"); });
    EXPECT_EQ(is_reestimated, signal < 1) << signal;
    EXPECT_EQ(reports.back().state, TrackingState::kProvisional);
  }
}

TEST_F(Extensions, AGivenSourceFollowsThePoints) {
  TrackerOptions options;
  options.init.method = InitMethod::kGated;
  int made = 0;
  TrackerExtensions extensions;
  extensions.make_tracks = [&] {
    ++made;
    return std::make_unique<PatchTracks>(options.point_tracker, 1);
  };
  EXPECT_THAT(extensions.Names(), ElementsAre("tracks"));
  ExpectSame(Run(options, extensions), Run(options, {}));
  EXPECT_EQ(made, 1);
}

// Finds no point again.
class BlindTracks final : public PatchTracks {
 public:
  using PatchTracks::PatchTracks;
  std::vector<PointTrack> Track(const PreparedFrame& /*previous*/, const PreparedFrame& /*current*/,
                                std::span<const PointPrediction> predictions) override {
    std::vector<PointTrack> lost;
    for (const PointPrediction& prediction : predictions)
      lost.push_back({.id = prediction.id, .failure = PatchFailure::kOccluded, .pixel = prediction.pixel});
    return lost;
  }
};

TEST_F(Extensions, ASourceThatLosesAllPointsIsNamedAsTheCause) {
  for (const InitMethod method : {InitMethod::kWindow, InitMethod::kGated}) {
    TrackerOptions options;
    options.init.method = method;
    TrackerExtensions extensions;
    extensions.make_tracks = [&] { return std::make_unique<BlindTracks>(options.point_tracker, 1); };
    Tracker tracker(*camera_, options, 1, 1, {.extensions = extensions});
    for (int i = 0; i < kFrames; ++i) Show(i, i, &tracker);
    tracker.EndSequence();
    const std::vector<FrameReport> rest = tracker.Finish();
    ASSERT_FALSE(rest.empty());
    EXPECT_EQ(rest.back().note, "all points were lost") << "the last reference has no image after it";
  }
}

}  // namespace
}  // namespace pliant
