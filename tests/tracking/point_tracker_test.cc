// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/tracks/point_tracker.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "photometric/synthetic_texture.h"
#include "support/tolerances.h"

namespace pliant {
namespace {

const cv::Size kSize(220, 190);
const cv::Point2d kCenter(110, 95);
constexpr std::size_t kMinFollowed = 62;    // of 72; some leave the image
constexpr int kMaxRefreshed = 8;            // a zoom by 1.6 asks for few new patches
constexpr double kPeriodicDrifts = 1.5;     // times the drift: each new patch adds its error
constexpr double kFollowed_px = 0.3;        // one frame of noise, from a patch of another size
constexpr double kSameSurface = 0.8;        // SSIM with noise; another surface has near none
constexpr double kPulledToIdentity = 0.01;  // of 1.1: where neighbors say little the identity has a say
constexpr double kNoise = 1.5;              // gray levels

// What a point of the first image has become in image t.
using Motion = std::function<cv::Point2d(cv::Point2d, int)>;

struct Sequence {
  SyntheticTexture texture{5};
  Motion first_from_image;  // and its inverse
  Motion image_from_first;
  double noise = kNoise;

  ImagePyramid Image(int t) const {
    return {texture.Render(
                kSize, [&](cv::Point2d p) { return first_from_image(p, t); }, 1 + 0.01 * t, -0.4 * t, noise,
                static_cast<std::uint64_t>(t) + 1),
            4};
  }
};

// From scale 1 to 1.6 in 40 images, with a slow turn.
constexpr int kZoomImages = 40;
Sequence Zoom() {
  const auto matrix = [](int t) {
    const double scale = std::pow(1.6, t / static_cast<double>(kZoomImages));
    const double angle = 0.004 * t;
    return cv::Matx22d(scale * std::cos(angle), -scale * std::sin(angle), scale * std::sin(angle),
                       scale * std::cos(angle));
  };
  const auto apply = [](const cv::Matx22d& m, cv::Point2d p) {
    const cv::Vec2d d = m * cv::Vec2d(p.x - kCenter.x, p.y - kCenter.y);
    return kCenter + cv::Point2d(d[0], d[1]);
  };
  Sequence sequence;
  sequence.image_from_first = [=](cv::Point2d p, int t) { return apply(matrix(t), p); };
  sequence.first_from_image = [=](cv::Point2d p, int t) { return apply(matrix(t).inv(), p); };
  return sequence;
}

// All points that live to the end: their last tracks, and the errors against the truth.
struct Outcome {
  std::vector<PointTrack> tracks;
  std::vector<double> errors_px;
  std::vector<Eigen::Vector2d> starts;
  int refreshed = 0;
  double Median() const {
    std::vector<double> e = errors_px;
    std::sort(e.begin(), e.end());
    return e.empty() ? std::numeric_limits<double>::infinity() : e[e.size() / 2];
  }
};

Outcome Follow(const Sequence& sequence, int images, const PointTrackerOptions& options, int threads = 1) {
  Outcome outcome;
  PointTracker tracker(options);
  std::vector<PointPrediction> predictions;
  ImagePyramid previous = sequence.Image(0);
  for (int y = 60; y <= 130; y += 10) {
    for (int x = 70; x <= 150; x += 10) {
      outcome.starts.emplace_back(x, y);
      const PointId id{static_cast<std::int64_t>(outcome.starts.size()) - 1};
      EXPECT_EQ(tracker.Add(id, outcome.starts.back(), previous, {}), PatchFailure::kNone);
      predictions.push_back({id, outcome.starts.back(), Eigen::Matrix2d::Identity()});
    }
  }
  for (int t = 1; t <= images; ++t) {
    ImagePyramid current = sequence.Image(t);
    outcome.tracks = tracker.Track(previous, {}, current, {}, predictions, threads);
    predictions.clear();
    std::vector<PointId> found;
    for (const PointTrack& track : outcome.tracks) {
      outcome.refreshed += track.refreshed == Refreshed::kYes;
      if (track.failure != PatchFailure::kNone) continue;
      predictions.push_back({track.id, track.pixel, Eigen::Matrix2d::Identity()});
      found.push_back(track.id);
    }
    tracker.Keep(found);
    previous = std::move(current);
  }
  for (const PointTrack& track : outcome.tracks) {
    if (track.failure != PatchFailure::kNone) continue;
    const Eigen::Vector2d& start = outcome.starts[static_cast<std::size_t>(track.id.value)];
    const cv::Point2d truth = sequence.image_from_first({start.x(), start.y()}, images);
    outcome.errors_px.push_back((track.pixel - Eigen::Vector2d(truth.x, truth.y)).norm());
  }
  return outcome;
}

TEST(PointTracker, AdaptivePolicyFollowsALongZoomWithoutDriftWherePeriodicDrifts) {
  constexpr double kDrift_px = 0.1;
  PointTrackerOptions options;
  const Outcome adaptive = Follow(Zoom(), kZoomImages, options);
  options.patch_policy = PatchPolicy::kPeriodic;
  const Outcome periodic = Follow(Zoom(), kZoomImages, options);
  EXPECT_GT(adaptive.errors_px.size(), kMinFollowed);
  EXPECT_LT(adaptive.Median(), kDrift_px);
  EXPECT_GT(periodic.Median(), kPeriodicDrifts * adaptive.Median());
  EXPECT_GE(periodic.refreshed, 8 * static_cast<int>(periodic.errors_px.size()));  // every fifth of 40 images
  EXPECT_LT(adaptive.refreshed, kMaxRefreshed);
}

TEST(PointTracker, ReportsTheAffineChangeSinceThePointWasAdded) {
  constexpr double kAffine = 0.06;
  const Outcome outcome = Follow(Zoom(), kZoomImages, {});
  std::vector<double> determinants;
  for (const PointTrack& track : outcome.tracks)
    if (track.failure == PatchFailure::kNone) determinants.push_back(std::sqrt(track.affine_from_first.determinant()));
  ASSERT_FALSE(determinants.empty());
  std::sort(determinants.begin(), determinants.end());
  EXPECT_NEAR(determinants[determinants.size() / 2], 1.6, kAffine);
}

TEST(PointTracker, RefreshesWhenTheFirstPatchNoLongerResemblesWhatIsSeen) {
  PointTrackerOptions options;
  options.max_scale = 1.2;
  const Outcome outcome = Follow(Zoom(), kZoomImages, options);
  EXPECT_GT(outcome.refreshed, static_cast<int>(outcome.errors_px.size()));
}

TEST(PointTracker, IsTheSameForEveryNumberOfThreads) {
  const Outcome one = Follow(Zoom(), 6, {}, 1);
  const Outcome two = Follow(Zoom(), 6, {}, 2);
  ASSERT_EQ(one.tracks.size(), two.tracks.size());
  for (std::size_t i = 0; i < one.tracks.size(); ++i) {
    EXPECT_EQ(one.tracks[i].pixel, two.tracks[i].pixel);
    EXPECT_EQ(one.tracks[i].ssim, two.tracks[i].ssim);
    EXPECT_EQ(one.tracks[i].failure, two.tracks[i].failure);
  }
}

Sequence Still() {
  Sequence sequence;
  sequence.noise = 0;
  sequence.first_from_image = sequence.image_from_first = [](cv::Point2d p, int) { return p; };
  return sequence;
}

TEST(PointTracker, FallsBackToTheLastPixelWhenThePredictionIsWrong) {
  const Sequence still = Still();
  PointTracker tracker({});
  ASSERT_EQ(tracker.Add({0}, {110, 95}, still.Image(0), {}), PatchFailure::kNone);
  PointPrediction wrong{{0}, {-500, 95}, Eigen::Matrix2d::Identity()};
  const auto tracks = tracker.Track(still.Image(0), {}, still.Image(1), {}, std::vector{wrong}, 1);
  EXPECT_EQ(tracks[0].failure, PatchFailure::kNone);
  constexpr double kSubPixel_px = 0.05;
  EXPECT_LT((tracks[0].pixel - Eigen::Vector2d(110, 95)).norm(), kSubPixel_px);
}

TEST(PointTracker, ForwardBackwardRefusesATrackThatDoesNotReturn) {
  const Sequence still = Still();
  Sequence other = Still();
  other.texture = SyntheticTexture(77);
  PointTracker tracker({});
  ASSERT_EQ(tracker.Add({0}, {110, 95}, still.Image(0), {}), PatchFailure::kNone);
  // The image called previous is another one: nothing leads back into it.
  const PointPrediction prediction{{0}, {110, 95}, Eigen::Matrix2d::Identity()};
  const auto tracks = tracker.Track(other.Image(0), {}, still.Image(0), {}, std::vector{prediction}, 1);
  EXPECT_EQ(tracks[0].failure, PatchFailure::kForwardBackward);
  PointTrackerOptions off;
  off.forward_backward = Switch::kOff;
  PointTracker trusting(off);
  ASSERT_EQ(trusting.Add({0}, {110, 95}, still.Image(0), {}), PatchFailure::kNone);
  EXPECT_EQ(trusting.Track(other.Image(0), {}, still.Image(0), {}, std::vector{prediction}, 1)[0].failure,
            PatchFailure::kNone);
}

TEST(PointTracker, WhatIsNotKeptLeavesNoTrace) {
  const Sequence sequence = Zoom();
  const ImagePyramid first = sequence.Image(0);
  const ImagePyramid skipped = sequence.Image(6);
  const ImagePyramid next = sequence.Image(2);
  const Eigen::Vector2d start(90, 80);
  const std::vector<PointPrediction> predictions = {{PointId{0}, start, Eigen::Matrix2d::Identity()}};
  PointTracker plain{PointTrackerOptions{}};
  PointTracker not_kept{PointTrackerOptions{}};
  ASSERT_EQ(plain.Add(PointId{0}, start, first, {}), PatchFailure::kNone);
  ASSERT_EQ(not_kept.Add(PointId{0}, start, first, {}), PatchFailure::kNone);
  ASSERT_EQ(not_kept.Track(first, {}, skipped, {}, predictions, 1)[0].failure, PatchFailure::kNone);
  const PointTrack expected = plain.Track(first, {}, next, {}, predictions, 1)[0];
  const PointTrack found = not_kept.Track(first, {}, next, {}, predictions, 1)[0];
  ASSERT_EQ(expected.failure, PatchFailure::kNone);
  EXPECT_EQ(found.failure, PatchFailure::kNone);
  EXPECT_EQ(found.pixel, expected.pixel);
}

// A point that is not followed for twelve images of a zoom is found again near where it is expected, and goes on.
TEST(PointTracker, FindsAPointThatWasOutOfSight) {
  const Sequence sequence = Zoom();
  const Eigen::Vector2d start(90, 80);
  const auto truth = [&](int t) {
    const cv::Point2d p = sequence.image_from_first({start.x(), start.y()}, t);
    return Eigen::Vector2d(p.x, p.y);
  };
  const auto see = [&](const Eigen::Vector2d& pixel, const Eigen::Matrix2d& affine) {
    return std::vector<PointPrediction>{{PointId{0}, pixel, affine}};
  };
  const Eigen::Matrix2d none = Eigen::Matrix2d::Identity();
  constexpr std::array kOnly = {PointId{0}};
  PointTracker tracker{PointTrackerOptions{}};
  ASSERT_EQ(tracker.Add(PointId{0}, start, sequence.Image(0), {}), PatchFailure::kNone);
  ASSERT_EQ(tracker.Track(sequence.Image(0), {}, sequence.Image(1), {}, see(truth(1), none), 1)[0].failure,
            PatchFailure::kNone);
  tracker.Keep(kOnly);
  const Eigen::Matrix2d zoomed = std::pow(1.6, 12.0 / kZoomImages) * none;
  const Eigen::Vector2d near = truth(13) + Eigen::Vector2d(3, -2);
  const PointTrack elsewhere = tracker.Find(sequence.Image(13), {}, see({150, 120}, zoomed), 1)[0];
  EXPECT_NE(elsewhere.failure, PatchFailure::kNone);
  PointTrack found = tracker.Find(sequence.Image(13), {}, see(near, zoomed), 1)[0];
  ASSERT_EQ(found.failure, PatchFailure::kNone);
  EXPECT_LT((found.pixel - truth(13)).norm(), kFollowed_px);
  EXPECT_GT(found.ssim, kSameSurface);
  // Not kept, it is where it was seen last; kept, it goes on from where it was found.
  found = tracker.Find(sequence.Image(13), {}, see(near, zoomed), 1)[0];
  ASSERT_EQ(found.failure, PatchFailure::kNone);
  tracker.Keep(kOnly);
  EXPECT_EQ(tracker.PixelOf(PointId{0}), found.pixel);
  const PointTrack next = tracker.Track(sequence.Image(13), {}, sequence.Image(14), {}, see(found.pixel, none), 1)[0];
  ASSERT_EQ(next.failure, PatchFailure::kNone);
  EXPECT_LT((next.pixel - truth(14)).norm(), kFollowed_px);

  PointTrackerOptions periodic;
  periodic.patch_policy = PatchPolicy::kPeriodic;
  PointTracker without{periodic};
  ASSERT_EQ(without.Add(PointId{0}, start, sequence.Image(0), {}), PatchFailure::kNone);
  EXPECT_NE(without.Find(sequence.Image(0), {}, see(start, none), 1)[0].failure, PatchFailure::kNone);
}

TEST(PointTracker, UnknownAndRemovedPointsAreSaidToBeUnknown) {
  const Sequence still = Still();
  PointTracker tracker({});
  ASSERT_EQ(tracker.Add({3}, {110, 95}, still.Image(0), {}), PatchFailure::kNone);
  EXPECT_TRUE(tracker.Contains({3}));
  tracker.Remove({3});
  EXPECT_EQ(tracker.size(), 0u);
  const PointPrediction prediction{{3}, {110, 95}, Eigen::Matrix2d::Identity()};
  EXPECT_EQ(tracker.Track(still.Image(0), {}, still.Image(0), {}, std::vector{prediction}, 1)[0].failure,
            PatchFailure::kUnknownPoint);
  EXPECT_EQ(tracker.Add({4}, {-20, 0}, still.Image(0), {}), PatchFailure::kOutOfImage);
  EXPECT_FALSE(tracker.Contains({4}));
}

TEST(NeighborhoodAffines, RecoverAnAffineMotionDespiteAStray) {
  Eigen::Matrix2d truth;
  truth << 1.04, -0.03, 0.02, 0.97;
  Random random(8);
  std::vector<Eigen::Vector2d> from, to;
  for (int i = 0; i < 60; ++i) {
    from.emplace_back(random.Uniform(0, 200), random.Uniform(0, 200));
    to.push_back(truth * from.back() + Eigen::Vector2d(5, -3));
  }
  to[7] += Eigen::Vector2d(6, 4);
  constexpr double kDamped = 0.02;  // the pull to the identity, and what is left of the stray
  const auto affines = NeighborhoodAffines(from, to);
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (i == 7) continue;
    EXPECT_LT((affines[i] - truth).norm(), kDamped) << i;
  }
}

TEST(NeighborhoodAffines, StayNearTheIdentityWhereNeighborsSayLittle) {
  const std::vector<Eigen::Vector2d> one = {{10, 10}};
  EXPECT_EQ(NeighborhoodAffines(one, one)[0], Eigen::Matrix2d::Identity());
  const std::vector<Eigen::Vector2d> from = {{0, 0}, {20, 0}, {40, 0}};  // on a line: nothing is known across it
  const std::vector<Eigen::Vector2d> to = {{0, 0}, {22, 0}, {44, 0}};
  const auto affines = NeighborhoodAffines(from, to);
  EXPECT_NEAR(affines[1](0, 0), 1.1, kPulledToIdentity);
  EXPECT_NEAR(affines[1](1, 1), 1.0, kRoundOff);
}

}  // namespace
}  // namespace pliant
