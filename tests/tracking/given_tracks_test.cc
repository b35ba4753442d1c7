// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "tracking/tracks/given_tracks.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pliant {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr int kWidth = 160;
constexpr int kHeight = 120;

// Seen everywhere but in frame 1 (4), from frame 2 on (6), in frame 0 alone (9), and hidden in frame 0 (12).
const std::vector<PixelTrack> kTracks = {
    {PointId{4}, {{0, {30.5, 30}}, {2, {32.5, 30}}, {3, {33.5, 30}}}},
    {PointId{6}, {{2, {80, 60.5}}, {3, {81, 60.5}}}},
    {PointId{9}, {{0, {34, 30}}}},
    {PointId{12}, {{0, {120, 90}, 0, false}, {1, {121, 90}}, {2, {122, 90}}, {3, {123, 90}}}}};

PreparedFrame Frame(int frame_idx, const cv::Mat& mask = {}) {
  return PrepareFrame(frame_idx, "image", frame_idx, cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(128)), mask, {});
}

std::vector<std::int64_t> Ids(const std::vector<NewTrack>& tracks) {
  std::vector<std::int64_t> ids;
  for (const NewTrack& track : tracks) ids.push_back(track.id.value);
  return ids;
}

std::vector<PointTrack> Track(GivenTracks* tracks, int frame_idx, const std::vector<std::int64_t>& ids) {
  std::vector<PointPrediction> predictions;
  for (const std::int64_t id : ids) predictions.push_back({PointId{id}, {1, 1}, Eigen::Matrix2d::Identity()});
  return tracks->Track(Frame(frame_idx - 1), Frame(frame_idx), predictions);
}

TEST(GivenTracks, OfferWhatIsSeenTheLongestFirst) {
  GivenTracks tracks(kTracks);
  CornerOptions corners;
  corners.min_distance_px = 8;  // tracks 4 and 9 are 3.5 px apart
  EXPECT_THAT(Ids(tracks.AddNew(Frame(0), {}, corners)), ElementsAre(4));
  corners.min_distance_px = 2;
  EXPECT_THAT(Ids(GivenTracks(kTracks).AddNew(Frame(0), {}, corners)), ElementsAre(4, 9));
  corners.max_corners = 1;
  EXPECT_THAT(Ids(GivenTracks(kTracks).AddNew(Frame(2), {}, corners)), ElementsAre(4));
}

TEST(GivenTracks, OfferNothingWherePointsAreOrTheMaskIs) {
  GivenTracks tracks(kTracks);
  const std::vector<Eigen::Vector2d> existing = {{30.5, 30}, {80, 60.5}};
  EXPECT_THAT(Ids(tracks.AddNew(Frame(2), existing, {})), ElementsAre(12));
  cv::Mat mask(kHeight, kWidth, CV_8UC1, cv::Scalar(255));
  mask.colRange(0, 60).setTo(0);
  EXPECT_THAT(Ids(GivenTracks(kTracks).AddNew(Frame(2, mask), {}, {})), ElementsAre(6, 12));
}

TEST(GivenTracks, LeaveContoursOutWhereThereAreEnoughOthers) {
  cv::Mat step(kHeight, kWidth, CV_8UC1, cv::Scalar(30));
  step.colRange(80, kWidth).setTo(180);
  const PreparedFrame frame = PrepareFrame(0, "image", 0, step, {}, {});
  const std::vector<PixelTrack> on_the_step = {{PointId{1}, {{0, {80, 60}}}}};
  EXPECT_THAT(Ids(GivenTracks(on_the_step).AddNew(frame, {}, {})), ElementsAre(1)) << "there are no others";
  const std::vector<Eigen::Vector2d> existing(40, Eigen::Vector2d(20, 20));
  EXPECT_THAT(GivenTracks(on_the_step).AddNew(frame, existing, {}), IsEmpty());
}

// Those that are followed already are no others.
TEST(GivenTracks, TakeThoseOnContoursWhereTheOthersAreFollowedAlready) {
  cv::Mat step(kHeight, kWidth, CV_8UC1, cv::Scalar(30));
  step.colRange(80, kWidth).setTo(180);
  const PreparedFrame frame = PrepareFrame(0, "image", 0, step, {}, {});
  std::vector<PixelTrack> all = {{PointId{1}, {{0, {80, 60}}}}};
  std::vector<Eigen::Vector2d> followed;
  for (int i = 0; i < 30; ++i) {
    followed.emplace_back(20 + 10.0 * (i % 3), 10 + 3.0 * i);
    all.push_back({PointId{2 + i}, {{0, followed.back()}}});
  }
  EXPECT_THAT(Ids(GivenTracks(all).AddNew(frame, followed, {})), ElementsAre(1));
  CornerOptions close;
  close.min_distance_px = 0;
  close.contour_filter = Switch::kOff;
  EXPECT_THAT(Ids(GivenTracks(all).AddNew(frame, followed, close)), ElementsAre(1));
}

TEST(GivenTracks, FollowPointsWhileTheyAreSeenAndFindThemAgain) {
  GivenTracks tracks(kTracks);
  ASSERT_THAT(tracks.AddNew(Frame(0), {}, {}), SizeIs(1));
  EXPECT_EQ(Track(&tracks, 1, {4})[0].failure, PatchFailure::kOccluded);
  const auto found = Track(&tracks, 2, {4});
  EXPECT_EQ(found[0].failure, PatchFailure::kNone);
  EXPECT_EQ(found[0].pixel, Eigen::Vector2d(32.5, 30));
  EXPECT_NE(Track(&tracks, 2, {6})[0].failure, PatchFailure::kNone) << "a point that was never added";
}

TEST(GivenTracks, ATrackThatIsBegunOnceMoreIsAnotherPoint) {
  GivenTracks tracks(kTracks);
  EXPECT_THAT(Ids(tracks.AddNew(Frame(2), {}, {})), ElementsAre(4, 6, 12));
  tracks.Remove(PointId{6});
  EXPECT_THAT(Ids(tracks.AddNew(Frame(3), {}, {})), ElementsAre(13, 14, 15));
  EXPECT_EQ(Track(&tracks, 3, {4})[0].pixel, Track(&tracks, 3, {13})[0].pixel);
}

TEST(GivenTracks, APointIsResumedByItsIdOrByItsPixel) {
  GivenTracks tracks(kTracks);
  ASSERT_THAT(tracks.AddNew(Frame(0), {}, {}), SizeIs(1));
  tracks.Remove(PointId{4});
  EXPECT_TRUE(tracks.Resume(PointId{4}, {32.5, 30}, Frame(2)));
  EXPECT_FALSE(tracks.Resume(PointId{4}, {32.5, 30}, Frame(1)));

  GivenTracks goes_on(kTracks);  // with the points of another one, whose point 20 is track 6
  ASSERT_TRUE(goes_on.Resume(PointId{20}, {80, 60.5}, Frame(2)));
  EXPECT_FALSE(goes_on.Resume(PointId{21}, {50, 50}, Frame(2)));
  goes_on.SkipIds(PointId{30});
  EXPECT_EQ(Track(&goes_on, 3, {20})[0].pixel, Eigen::Vector2d(81, 60.5));
  EXPECT_THAT(Ids(goes_on.AddNew(Frame(2), {}, {})), ElementsAre(30, 31, 32)) << "the others have the ids of tracks";
}

TEST(GivenTracks, APointOfAModelIsTheTrackThatIsSeenThere) {
  GivenTracks tracks(kTracks);
  EXPECT_EQ(tracks.Add({80.25, 60.5}, Frame(2)), PointId{6});
  EXPECT_FALSE(tracks.Add({82, 60.5}, Frame(2)));
}

}  // namespace
}  // namespace pliant
