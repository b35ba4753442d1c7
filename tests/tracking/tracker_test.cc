// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The tracker on a small simulated scene that is rigid, from images alone: what is reported, and when.
#include "pliant/tracking/tracker.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <opencv2/imgproc.hpp>

#include "tracking/tracker_from_images.h"

namespace pliant {
namespace {

using testing::HasSubstr;
using tracking_test::ExpectFromTheMap;
using tracking_test::kFrames;
using tracking_test::TrackerFromImages;

constexpr int kAtOnce = 1;
constexpr int kMinVisible = 100;     // points of a half of the image, or all that are followed throughout
constexpr int kMinUncovered = 20;    // points in what comes into view
constexpr int kMinGrown = 30;        // new points where there was nothing
constexpr int kMinOnTheStain = 10;   // points that will contradict their neighbors
constexpr double kNearlyAll = 0.9;   // of the points
constexpr double kComesBack = 0.8;   // of the points that were hidden
constexpr double kShareLeft = 0.05;  // of the motion in common

void ExpectInitializing(const FrameReport& report) {
  EXPECT_EQ(report.state, TrackingState::kInitializing);
  EXPECT_FALSE(report.cam_from_world);
  EXPECT_TRUE(report.observations.empty());
  EXPECT_TRUE(report.new_points.empty());
  EXPECT_GT(report.tracked, 0);
}

TEST_F(TrackerFromImages, TheFirstMapGivesEveryFrameSinceTheReferenceItsPoseAndPoints) {
  TrackerOptions options;
  options.init.method = InitMethod::kGated;  // within the few frames here
  Tracker tracker = MakeTracker(options);
  std::vector<FrameReport> done;
  int shown = 0;
  for (; shown < kFrames && done.empty(); ++shown) {
    done = Show(shown, shown, &tracker);
    if (!done.empty()) break;
    ASSERT_EQ(static_cast<int>(tracker.held().size()), shown + 1);
    EXPECT_EQ(tracker.held().back().frame_idx, shown);
    ExpectInitializing(tracker.held().back());
  }
  ASSERT_GT(shown, kAtOnce) << "the map came at once, so nothing was waited for";
  ASSERT_EQ(static_cast<int>(done.size()), shown + 1) << "no map came";
  EXPECT_TRUE(tracker.held().empty());

  std::set<PointId> map;
  for (const NewPoint& point : done.front().new_points) map.insert(point.id);
  EXPECT_EQ(done.front().added, static_cast<int>(map.size()));
  for (int k = 0; k <= shown; ++k) {
    const FrameReport& report = done[static_cast<std::size_t>(k)];
    EXPECT_EQ(report.frame_idx, k);
    ExpectFromTheMap(report, map, *camera_);
    ASSERT_TRUE(report.first_map);
    EXPECT_EQ(report.first_map->reference_frame_idx, 0);
    EXPECT_EQ(report.first_map->declared_frame_idx, shown);
    EXPECT_THAT(report.note, HasSubstr(k < shown ? "made in frame " + NameOf(shown) : "first map of"));
    EXPECT_EQ(report.new_points.empty(), k > 0);
  }
  // The reference is the world, and its points are where the map has them.
  const FrameReport& reference = done.front();
  EXPECT_TRUE(reference.cam_from_world->translation.isZero());
  ASSERT_EQ(reference.observations.size(), reference.new_points.size());
  for (std::size_t i = 0; i < reference.observations.size(); ++i)
    EXPECT_EQ(reference.observations[i].position, reference.new_points[i].position);

  // It goes on smoothly: one frame, at once, with nearly all points.
  const auto next = Show(shown + 1, shown + 1, &tracker);
  ASSERT_EQ(next.size(), 1U);
  ExpectFromTheMap(next.front(), map, *camera_);
  EXPECT_FALSE(next.front().first_map);
  EXPECT_GT(next.front().optimized, kNearlyAll * done.back().optimized);
  EXPECT_TRUE(tracker.Finish().empty());
}

TEST_F(TrackerFromImages, AReferenceThatIsGivenUpLeavesFramesWithoutPoses) {
  constexpr int kWindow = 8;
  TrackerOptions options;
  options.init.method = InitMethod::kGated;
  options.init.monocular.max_window = kWindow;
  Tracker tracker = MakeTracker(options);
  for (int i = 0; i < kWindow; ++i) EXPECT_TRUE(Show(0, i, &tracker).empty());
  const auto given_up = Show(0, kWindow, &tracker);  // a camera that stands still carries no map
  ASSERT_EQ(given_up.size(), kWindow);
  for (const FrameReport& report : given_up) ExpectInitializing(report);
  ASSERT_EQ(tracker.held().size(), 1U) << "the present frame is the new reference";
  EXPECT_EQ(tracker.held().front().frame_idx, kWindow);
  EXPECT_THAT(tracker.held().front().note, HasSubstr("given up after 8 frames"));

  // The next reference carries one, from itself on.
  std::vector<FrameReport> done;
  for (int i = 1; i < kFrames && done.empty(); ++i) done = Show(i, kWindow + i, &tracker);
  ASSERT_FALSE(done.empty());
  EXPECT_EQ(done.front().frame_idx, kWindow);
  EXPECT_FALSE(done.front().new_points.empty());
  for (const FrameReport& report : done) EXPECT_EQ(report.state, TrackingState::kTracking);
}

TEST_F(TrackerFromImages, FinishGivesTheFramesThatWaitedInVain) {
  Tracker tracker = MakeTracker();
  Show(0, 5, &tracker);
  Show(1, 6, &tracker);
  const auto rest = tracker.Finish();
  ASSERT_EQ(rest.size(), 2U);
  for (const FrameReport& report : rest) ExpectInitializing(report);
  EXPECT_EQ(rest.back().frame_idx, 6);
  EXPECT_TRUE(tracker.held().empty());
}

// The scene's right half is uncovered while the map is awaited.
class UncoveredLater : public TrackerFromImages {
 protected:
  static constexpr int kUncovered = 4;

  // All frames; a map is sought at the end alone.
  static std::vector<FrameReport> Run(InitMethod method, Tracker* tracker) {
    std::vector<FrameReport> done;
    for (int i = 0; i < kFrames; ++i) {
      cv::Mat image = (*images_)[static_cast<std::size_t>(i)].clone();
      if (i < kUncovered) image.colRange(image.cols / 2, image.cols).setTo(cv::Scalar::all(0));
      for (FrameReport& report : tracker->Process(PrepareFrame(i, NameOf(i), i / 30.0, image, {}, {})))
        done.push_back(std::move(report));
    }
    EXPECT_TRUE(done.empty()) << "a map came before the end of method " << EnumName(method);
    tracker->EndSequence();
    return tracker->Finish();
  }

  static TrackerOptions Options(InitMethod method) {
    TrackerOptions options;
    options.init.method = method;
    options.init.window.first_frame = kFrames;
    options.init.window.max_depth_sigma = 0.3;     // the few frames are short of parallax
    options.init.monocular.min_parallax_deg = 60;  // of the gated start: more than there is
    options.top_up_frames = kUncovered;
    return options;
  }
};

TEST_F(UncoveredLater, PointsAreAddedAndComeIntoTheFirstMapWhereTheyAreSeen) {
  Tracker tracker = MakeTracker(Options(InitMethod::kWindow));
  const auto reports = Run(InitMethod::kWindow, &tracker);
  ASSERT_EQ(reports.size(), kFrames);
  std::set<PointId> in_reference;
  for (const NewPoint& point : reports.front().new_points) in_reference.insert(point.id);
  EXPECT_EQ(reports.front().observations.size(), in_reference.size());
  std::set<PointId> map;
  for (const FrameReport& report : reports)
    for (const NewPoint& point : report.new_points) EXPECT_TRUE(map.insert(point.id).second);
  for (int k = 0; k < kFrames; ++k) {
    const FrameReport& report = reports[static_cast<std::size_t>(k)];
    ExpectFromTheMap(report, map, *camera_);
    const auto later = std::count_if(report.observations.begin(), report.observations.end(),
                                     [&](const PointObservation& seen) { return !in_reference.contains(seen.id); });
    if (k < kUncovered)
      EXPECT_EQ(later, 0) << k;
    else
      EXPECT_GT(later, kMinUncovered) << k;
  }
  EXPECT_EQ(tracker.state(), TrackingState::kTracking);
  EXPECT_FALSE(tracker.map().landmarks.empty());
  // What the map left out is counted in the frame that made it.
  EXPECT_GT(reports.back().lost, 0);
  int lost = 0;
  for (const auto& [reason, count] : reports.back().losses) lost += count;
  EXPECT_EQ(reports.back().lost, lost);
}

TEST_F(UncoveredLater, PointsAreNotAddedForAnInitializerOfTwoViews) {
  Tracker tracker = MakeTracker(Options(InitMethod::kGated));
  const auto reports = Run(InitMethod::kGated, &tracker);
  ASSERT_EQ(reports.size(), kFrames);
  for (std::size_t k = 1; k < reports.size(); ++k) EXPECT_LE(reports[k].tracked, reports[k - 1].tracked) << k;
}

TEST_F(TrackerFromImages, TheEndOfASequenceWithoutAMapIsSaid) {
  TrackerOptions options;
  options.init.window.first_frame = kFrames;
  Tracker tracker = MakeTracker(options);
  for (int i = 0; i < kFrames; ++i) EXPECT_TRUE(Show(0, i, &tracker).empty());  // a camera that stands still
  tracker.EndSequence();
  EXPECT_EQ(tracker.state(), TrackingState::kInitializing);
  const auto rest = tracker.Finish();
  ASSERT_EQ(rest.size(), kFrames);
  for (const FrameReport& report : rest) ExpectInitializing(report);
  EXPECT_THAT(rest.back().note, HasSubstr("rotated or stood still"));
  tracker.EndSequence();  // nothing is held: nothing happens
  EXPECT_TRUE(tracker.Finish().empty());
}

// The views of the first frames are nearly the same.
TEST_F(TrackerFromImages, ADepthPriorIsComparedWithTheMap) {
  constexpr int kFirstFrames = 4;
  for (const DepthPriorKind kind : {DepthPriorKind::kDepth, DepthPriorKind::kInverseDepth}) {
    TrackerOptions options;
    options.init.method = InitMethod::kDepth;
    options.depth_prior.kind = kind;
    Tracker tracker = MakeTracker(options);
    for (int i = 0; i < kFirstFrames; ++i) {
      PreparedFrame frame = PrepareFrame(i, NameOf(i), i / 30.0, (*images_)[static_cast<std::size_t>(i)], {}, options);
      frame.known_depth_mm = [depth = *depth_] { return depth; };
      frame.depth_prior = *depth_;
      const auto reports = tracker.Process(frame);
      ASSERT_EQ(reports.size(), 1U);
      const FramePrior& prior = reports.front().prior;
      EXPECT_FALSE(prior.by_brightness);
      EXPECT_FALSE(prior.is_used);
      if (i == 0) continue;  // the map is made of it
      EXPECT_EQ(prior.agreement, kind == DepthPriorKind::kDepth ? PriorAgreement::kAgrees : PriorAgreement::kFalls);
    }
  }
}

// Something passes over the left half of the view for four frames. The points there come back as the same points.
TEST_F(TrackerFromImages, PointsThatWereHiddenComeBack) {
  constexpr int kFirstHidden = 4;
  constexpr int kLastHidden = 7;
  enum class View { kOpen, kHidden };
  const auto run = [&](Switch find_lost, View view) {
    TrackerOptions options;
    options.init.method = InitMethod::kDepth;
    options.find_lost = find_lost;
    options.growth.grow = Switch::kOff;
    return RunMasked(options, [&](int i, const cv::Mat& mask) {
      if (view == View::kHidden && i >= kFirstHidden && i <= kLastHidden) mask.colRange(0, mask.cols / 2).setTo(0);
    });
  };
  const auto on_the_left = [](const FrameReport& report) {
    return std::count_if(report.observations.begin(), report.observations.end(),
                         [](const PointObservation& seen) { return seen.pixel.x() < 140; });
  };
  const auto open = run(Switch::kOn, View::kOpen);
  const auto without = run(Switch::kOff, View::kHidden);
  const auto with = run(Switch::kOn, View::kHidden);
  ASSERT_EQ(with.size(), static_cast<std::size_t>(kFrames));
  ASSERT_GT(on_the_left(open.back()), kMinVisible);
  EXPECT_EQ(on_the_left(with[kLastHidden]), 0);
  EXPECT_EQ(on_the_left(without.back()), 0);
  EXPECT_GT(on_the_left(with[kLastHidden + 1]), kComesBack * on_the_left(open[kLastHidden + 1]));  // at once
  EXPECT_GT(on_the_left(with.back()), kComesBack * on_the_left(open.back()));
  std::set<PointId> map;
  for (const NewPoint& point : with.front().new_points) map.insert(point.id);
  for (const FrameReport& report : with) ExpectFromTheMap(report, map, *camera_);
}

// The camera of a scene that stands still: what slips into the points' motion from frame to frame is given back to it.
TEST_F(TrackerFromImages, WhatAllPointsDoTogetherIsTheCameras) {
  const auto run = [&](double share) {
    TrackerOptions options;
    options.init.method = InitMethod::kDepth;
    options.growth.grow = Switch::kOff;
    options.common_motion_share = share;
    return RunMasked(options, [](int, const cv::Mat&) {});
  };
  const auto moved_together = [](const std::vector<FrameReport>& reports) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double count = 0;
    for (const PointObservation& seen : reports.back().observations)
      for (const PointObservation& first : reports.front().observations)
        if (first.id == seen.id) {
          sum += seen.position - first.position;
          ++count;
        }
    EXPECT_GT(count, kMinVisible);
    return (sum / count).norm();
  };
  const auto left = run(0);
  const auto held = run(1);
  EXPECT_LT(moved_together(held), kShareLeft * moved_together(left));
  std::set<PointId> map;
  for (const NewPoint& point : held.front().new_points) map.insert(point.id);
  for (const FrameReport& report : held) ExpectFromTheMap(report, map, *camera_);
}

// The right half is dark while the first map is made, and comes into view afterwards.
TEST_F(TrackerFromImages, TheMapGrowsWhereTheImageShowsMore) {
  constexpr int kFirstOpen = 3;
  const auto run = [&](Switch grow) {
    TrackerOptions options;
    options.init.method = InitMethod::kDepth;
    options.growth.grow = grow;
    options.growth.every = 1;
    options.growth.max_depth_sigma = 0.2;  // the few frames are short of parallax
    return RunMasked(options, [&](int i, const cv::Mat& mask) {
      if (i < kFirstOpen) mask.colRange(mask.cols / 2, mask.cols).setTo(0);
    });
  };
  const auto on_the_right = [](const FrameReport& report) {
    return std::count_if(report.observations.begin(), report.observations.end(),
                         [](const PointObservation& seen) { return seen.pixel.x() > 180; });
  };
  EXPECT_EQ(on_the_right(run(Switch::kOff).back()), 0);
  const auto grown = run(Switch::kOn);
  EXPECT_GT(on_the_right(grown.back()), kMinGrown);
  std::set<PointId> map;
  for (const FrameReport& report : grown) {
    EXPECT_EQ(report.added, static_cast<int>(report.new_points.size()));
    for (const NewPoint& point : report.new_points) EXPECT_TRUE(map.insert(point.id).second) << "twice";
    ExpectFromTheMap(report, map, *camera_);
    ASSERT_TRUE(report.coverage && report.followed_coverage);
    EXPECT_GE(*report.followed_coverage, *report.coverage);
  }
  // What came into sight is followed before it is in the map.
  EXPECT_TRUE(std::ranges::any_of(
      grown, [](const FrameReport& report) { return *report.followed_coverage > *report.coverage + 0.05; }));
}

// A stain moves to and fro on the scene. From frame to frame that may be the scene that deforms; over the frames of
// which the map is re-estimated it contradicts all that is around it.
TEST_F(TrackerFromImages, AReestimatedMapRejectsReprojectionOutliers) {
  const cv::Rect stain(130, 90, 60, 60);
  TrackerOptions options;
  options.init.method = InitMethod::kDepth;
  options.growth.window = kFrames - 2;
  options.growth.reestimate_every = kFrames - 1;
  options.growth.max_measured_share = 1.1;  // even where depth was measured everywhere
  Tracker tracker = MakeTracker(options);
  std::vector<FrameReport> reports;
  for (int i = 0; i < kFrames; ++i) {
    cv::Mat image = (*images_)[static_cast<std::size_t>(i)].clone();
    cv::Mat moved;
    cv::warpAffine(image, moved, cv::Matx23d(1, 0, std::sin(0.8 * i), 0, 1, 0), image.size());
    moved(stain).copyTo(image(stain));
    PreparedFrame frame = PrepareFrame(i, NameOf(i), i / 30.0, image, {}, options);
    frame.known_depth_mm = [depth = *depth_] { return depth; };
    for (FrameReport& report : tracker.Process(frame)) reports.push_back(std::move(report));
  }
  ASSERT_EQ(static_cast<int>(reports.size()), kFrames);
  const auto on_the_stain = [&](const FrameReport& report) {
    return std::count_if(report.observations.begin(), report.observations.end(), [&](const PointObservation& seen) {
      return stain.contains(cv::Point2d(seen.pixel.x(), seen.pixel.y()));
    });
  };
  const FrameReport& before = reports[kFrames - 2];
  const FrameReport& after = reports[kFrames - 1];
  EXPECT_THAT(after.note, HasSubstr("re-estimated"));
  EXPECT_GE(on_the_stain(before), kMinOnTheStain);
  EXPECT_LE(on_the_stain(after), on_the_stain(before) / 3);
  EXPECT_GT(after.optimized, kNearlyAll * static_cast<double>(before.optimized - on_the_stain(before)));
}

TEST_F(TrackerFromImages, AFrameWithoutCornersIsReportedAtOnce) {
  Tracker tracker = MakeTracker();
  const cv::Mat black(images_->front().size(), CV_8UC3, cv::Scalar::all(0));
  const auto done = tracker.Process(PrepareFrame(0, NameOf(0), 0, black, {}, {}));
  ASSERT_EQ(done.size(), 1U);
  EXPECT_EQ(done.front().state, TrackingState::kWaitingForReference);
  EXPECT_TRUE(tracker.held().empty());
}

}  // namespace
}  // namespace pliant
