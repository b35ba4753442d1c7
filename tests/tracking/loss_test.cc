// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Images in which the scene is not seen, or badly, on the way: before the first map, and after it.
#include <algorithm>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "tracking/tracker_from_images.h"

namespace pliant {
namespace {

using testing::HasSubstr;
using tracking_test::kFrames;

constexpr double kUndisturbed_mm = 0.4;  // the path of 50 mm views that nothing was wrong with, where points were lost
constexpr double kStandstill_mm = 0.05;  // a tracked camera is known that well
constexpr double kShareOfGap = 0.05;     // of the way that nobody saw
constexpr double kShareOfWay = 0.1;      // two monocular maps of the same frames, but two
constexpr double kFoundAgain = 0.5;      // of the points, some of which have left the image
constexpr double kStillFollowed = 0.8;   // of the points of a run without blur

class LossOfTheView : public tracking_test::TrackerFromImages {
 protected:
  static cv::Mat Image(int idx) { return (*images_)[static_cast<std::size_t>(idx)]; }
  static cv::Mat Black() { return {images_->front().size(), CV_8UC3, cv::Scalar::all(0)}; }
  static cv::Mat Blurred(int idx, double sigma_px) {
    cv::Mat blurred;
    cv::GaussianBlur(Image(idx), blurred, cv::Size(), sigma_px);
    return blurred;
  }
  // Neither dark nor anything that was seen before.
  static cv::Mat Noise(int seed) {
    cv::Mat noise(images_->front().size(), CV_8UC3);
    cv::RNG rng(static_cast<std::uint64_t>(seed) + 1);
    rng.fill(noise, cv::RNG::UNIFORM, 40, 220);
    return noise;
  }
  // Bright, and without a corner.
  static cv::Mat Ramp() {
    cv::Mat ramp(images_->front().size(), CV_8UC3);
    for (int x = 0; x < ramp.cols; ++x) ramp.col(x) = cv::Scalar::all(60 + 120.0 * x / ramp.cols);
    return ramp;
  }
  static std::vector<cv::Mat> AllImages() {
    std::vector<cv::Mat> images;
    for (const cv::Mat& image : *images_) images.push_back(image.clone());
    return images;
  }

  static std::vector<FrameReport> Run(const TrackerOptions& options, const std::vector<cv::Mat>& images) {
    Tracker tracker = MakeTracker(options);
    std::vector<FrameReport> reports;
    const auto take = [&](std::vector<FrameReport> done) {
      for (FrameReport& report : done) reports.push_back(std::move(report));
    };
    for (std::size_t i = 0; i < images.size(); ++i) {
      const int idx = static_cast<int>(i);
      PreparedFrame frame = PrepareFrame(idx, NameOf(idx), idx / 30.0, images[i], {}, options);
      frame.known_depth_mm = [depth = *depth_] { return depth; };
      take(tracker.Process(frame));
    }
    take(tracker.Finish());
    return reports;
  }
  // A start from depth: there is a map from the first frame on.
  static TrackerOptions FromDepth() {
    TrackerOptions options;
    options.init.method = InitMethod::kDepth;
    return options;
  }
};

double DistanceMm(const FrameReport& a, const FrameReport& b) {
  return (a.cam_from_world->OriginInSource() - b.cam_from_world->OriginInSource()).norm();
}

std::vector<int> FramesThat(const std::vector<FrameReport>& reports, TrackingState state) {
  std::vector<int> frames;
  for (const FrameReport& report : reports)
    if (report.state == state) frames.push_back(report.frame_idx);
  return frames;
}

TEST_F(LossOfTheView, DarkAndBlurredImagesBeforeTheMapArePassedOver) {
  TrackerOptions options;
  options.init.method = InitMethod::kGated;
  std::vector<cv::Mat> images = AllImages();
  images[2] = Black();
  images[3] = Blurred(3, 5);
  const auto reports = Run(options, images);
  ASSERT_EQ(static_cast<int>(reports.size()), kFrames);
  EXPECT_EQ(FramesThat(reports, TrackingState::kLost), (std::vector<int>{2, 3}));
  EXPECT_EQ(static_cast<int>(FramesThat(reports, TrackingState::kTracking).size()), kFrames - 2);
  EXPECT_THAT(reports[2].note, HasSubstr("passed over"));
  EXPECT_THAT(reports[2].note, HasSubstr("black"));
  for (const int idx : {2, 3}) {
    const FrameReport& lost = reports[static_cast<std::size_t>(idx)];
    EXPECT_FALSE(lost.cam_from_world);
    EXPECT_FALSE(lost.first_map);
    EXPECT_TRUE(lost.observations.empty());
  }
  const auto undisturbed = Run(options, AllImages());
  // The unit of both is the nominal depth.
  EXPECT_LT(DistanceMm(reports.back(), undisturbed.back()),
            kShareOfWay * DistanceMm(undisturbed.front(), undisturbed.back()));
}

TEST_F(LossOfTheView, ABlurThatStaysIsTakenAsItIs) {
  TrackerOptions options;
  options.max_blurred_frames = 3;
  std::vector<cv::Mat> images = AllImages();
  for (int i = 2; i < kFrames; ++i) images[static_cast<std::size_t>(i)] = Blurred(i, 2);
  const auto reports = Run(options, images);
  ASSERT_EQ(static_cast<int>(reports.size()), kFrames);
  for (std::size_t i = 0; i < reports.size(); ++i)
    EXPECT_EQ(reports[i].note.find("passed over") != std::string::npos, i >= 2 && i < 5) << i << reports[i].note;
}

// A sway: after a gap the camera is elsewhere, and going another way.
TEST_F(LossOfTheView, TheCameraIsFoundWhereverItIsAfterTheDark) {
  const auto undisturbed = Run(FromDepth(), AllImages());
  constexpr int kLastSeen = 4;
  for (const int found : {7, 10, 13}) {
    std::vector<cv::Mat> images = AllImages();
    images.resize(static_cast<std::size_t>(found) + 1);
    for (int i = kLastSeen + 1; i < found; ++i) images[static_cast<std::size_t>(i)] = Black();
    const auto reports = Run(FromDepth(), images);
    EXPECT_EQ(static_cast<int>(FramesThat(reports, TrackingState::kLost).size()), found - kLastSeen - 1);
    const FrameReport& back = reports.back();
    ASSERT_EQ(back.state, TrackingState::kTracking) << found << ": " << back.note;
    const FrameReport& there = undisturbed[static_cast<std::size_t>(found)];
    EXPECT_LT(DistanceMm(back, there),
              kShareOfGap * DistanceMm(undisturbed[static_cast<std::size_t>(kLastSeen)], there) + kStandstill_mm)
        << found;
    std::set<PointId> before;
    for (const PointObservation& seen : reports[kLastSeen].observations) before.insert(seen.id);
    const auto same = std::ranges::count_if(back.observations,
                                            [&](const PointObservation& seen) { return before.contains(seen.id); });
    EXPECT_GT(static_cast<double>(same), kFoundAgain * static_cast<double>(before.size())) << found;
  }
}

TEST_F(LossOfTheView, TheCameraIsNotFoundInAnImageOfSomethingElse) {
  std::vector<cv::Mat> images = AllImages();
  images.resize(8);
  images[4] = images[5] = Black();
  images[6] = Noise(6);
  cv::flip(Image(7), images[7], 0);  // as bright and as textured as the scene, and not a view of it
  const auto reports = Run(FromDepth(), images);
  EXPECT_EQ(FramesThat(reports, TrackingState::kLost), (std::vector<int>{4, 5, 6, 7}));
}

TEST_F(LossOfTheView, PointsAreFollowedIntoBlurredImages) {
  const auto undisturbed = Run(FromDepth(), AllImages());
  std::vector<cv::Mat> images = AllImages();
  for (int i = 5; i < 8; ++i) images[static_cast<std::size_t>(i)] = Blurred(i, 4);
  TrackerOptions options = FromDepth();
  const auto reports = Run(options, images);
  EXPECT_TRUE(FramesThat(reports, TrackingState::kLost).empty());
  for (int i = 5; i < kFrames; ++i) {
    const auto idx = static_cast<std::size_t>(i);
    EXPECT_LT(DistanceMm(reports[idx], undisturbed[idx]), kUndisturbed_mm) << i;
    EXPECT_EQ(reports[idx].note.find("blurred") != std::string::npos, i < 8) << i;
  }
  EXPECT_GT(static_cast<double>(reports.back().optimized),
            kStillFollowed * static_cast<double>(undisturbed.back().optimized));

  options.track_blurred = Switch::kOff;
  EXPECT_FALSE(FramesThat(Run(options, images), TrackingState::kLost).empty());
}

// Somewhere else for a while: the images upside down, which no view of the scene resembles.
TEST_F(LossOfTheView, AMapThatIsLeftIsFoundAgain) {
  TrackerOptions options = FromDepth();
  options.max_lost_frames = 2;
  options.relocalization.search_every = 1;
  options.relocalization.merge_every = 1;
  std::vector<cv::Mat> images = AllImages();
  constexpr int kElsewhere = 4;
  constexpr int kBack = 10;
  for (std::size_t i = kElsewhere; i < kBack; ++i) cv::flip((*images_)[i], images[i], 0);
  const auto reports = Run(options, images);
  ASSERT_EQ(static_cast<int>(reports.size()), kFrames);
  EXPECT_EQ(FramesThat(reports, TrackingState::kLost), (std::vector<int>{kElsewhere, kElsewhere + 1, kBack}));
  std::map<PointId, int> submap_of;
  for (const FrameReport& report : reports) {
    const bool second = report.frame_idx >= kElsewhere + 2 && report.frame_idx <= kBack;
    EXPECT_EQ(report.submap, second ? 1 : 0) << report.frame_idx;
    for (const PointObservation& seen : report.observations)
      EXPECT_EQ(submap_of.try_emplace(seen.id, report.submap).first->second, report.submap) << "an id in two maps";
  }
  const auto undisturbed = Run(options, AllImages());
  EXPECT_LT(DistanceMm(reports.back(), undisturbed.back()), kUndisturbed_mm);
}

// The same images twice, with something else between: the second time another map is begun, of twice the unit.
class MapsThatMeet : public LossOfTheView {
 protected:
  static constexpr int kElsewhere = 6;
  static constexpr int kAgain = 8;
  static constexpr int kJoined = 15;

  static TrackerOptions Options() {
    TrackerOptions options = FromDepth();
    options.max_lost_frames = kAgain - kElsewhere;
    options.relocalization.search_every = 1000;
    options.relocalization.merge_every = kJoined;
    return options;
  }
  // The image that each frame shows; below 0 none.
  static std::vector<int> Twice() {
    std::vector<int> shown;
    for (int idx = 0; idx < kAgain + kFrames; ++idx)
      shown.push_back(idx >= kAgain ? idx - kAgain : idx < kElsewhere ? idx : -1);
    return shown;
  }
  static std::vector<FrameReport> Show(const TrackerOptions& options, const std::vector<int>& images) {
    Tracker tracker = MakeTracker(options);
    std::vector<FrameReport> reports;
    for (std::size_t i = 0; i < images.size(); ++i) {
      const int idx = static_cast<int>(i);
      PreparedFrame frame =
          PrepareFrame(idx, NameOf(idx), idx / 30.0, images[i] < 0 ? Noise(idx) : Image(images[i]), {}, options);
      frame.known_depth_mm = [depth = idx > kElsewhere ? cv::Mat(*depth_ * 2) : *depth_] { return depth; };
      for (FrameReport& report : tracker.Process(frame)) reports.push_back(std::move(report));
    }
    return reports;
  }
  // Of two reports of one image, one in each map: that the merge takes the one's world into the other's.
  static void ExpectOnePlace(FrameReport of_younger, const FrameReport& of_older, const SubmapMerge& merge) {
    of_younger.cam_from_world = PoseInWorld(merge.into_from_submap, *of_younger.cam_from_world);
    EXPECT_LT(DistanceMm(of_younger, of_older), kPlace_mm) << of_younger.frame_idx;
  }

  static constexpr double kPlace_mm = 0.1;
  static constexpr double kHalf = 0.5;  // the second map's unit
  static constexpr double kUnit = 0.01;
};

TEST_F(MapsThatMeet, BecomeOne) {
  const auto reports = Show(Options(), Twice());
  ASSERT_EQ(static_cast<int>(reports.size()), kAgain + kFrames);
  for (const FrameReport& report : reports) {
    EXPECT_EQ(report.submap, report.frame_idx >= kAgain && report.frame_idx <= kJoined ? 1 : 0) << report.frame_idx;
    EXPECT_EQ(report.merge.has_value(), report.frame_idx == kJoined) << report.frame_idx;
  }
  const SubmapMerge& merge = *reports[kJoined].merge;
  EXPECT_THAT(reports[kJoined].note, HasSubstr("map 1 is now part of map 0"));
  EXPECT_EQ(merge.submap, 1);
  EXPECT_EQ(merge.into, 0);
  EXPECT_NEAR(merge.into_from_submap.scale, kHalf, kUnit);
  EXPECT_FALSE(reports[kJoined + 1].refined_points.empty()) << "the other map's points rest where this one's do";
  const auto undisturbed = Run(FromDepth(), AllImages());
  for (int image = 0; image < kFrames; ++image) {
    const FrameReport& again = reports[static_cast<std::size_t>(kAgain + image)];
    const FrameReport& there = undisturbed[static_cast<std::size_t>(image)];
    ASSERT_EQ(again.state, TrackingState::kTracking) << image;
    if (again.submap == 1)
      ExpectOnePlace(again, there, merge);
    else
      EXPECT_LT(DistanceMm(again, there), kPlace_mm) << image;
  }
  // The points of both are in sight.
  const auto ids = [](const FrameReport& report) {
    std::set<PointId> seen;
    for (const PointObservation& observation : report.observations) seen.insert(observation.id);
    return seen;
  };
  const std::set<PointId> last = ids(reports.back());
  for (const int frame : {kElsewhere - 1, kJoined}) {
    const std::set<PointId> before = ids(reports[static_cast<std::size_t>(frame)]);
    EXPECT_GT(2 * std::ranges::count_if(before, [&](PointId id) { return last.contains(id); }),
              static_cast<std::ptrdiff_t>(before.size()))
        << frame;
  }
}

// The older map is found again while the younger one is lost; then that is found in its image.
TEST_F(MapsThatMeet, BecomeOneWhicheverIsTracked) {
  constexpr int kBack = 17;
  constexpr int kDue = 20;
  TrackerOptions options = Options();
  options.max_lost_frames = 3;
  options.relocalization.search_every = kBack;
  options.relocalization.merge_every = kDue;
  const auto reports =
      Show(options, {0, 1, 2, 3, 4, 5, -1, -1, -1, 0, 1, 2, 3, 4, 5, -1, -1, 6, 7, 8, 9, 10, 11, 12, 13});
  for (const FrameReport& report : reports) {
    EXPECT_EQ(report.submap, report.frame_idx >= 9 && report.frame_idx < kBack ? 1 : 0) << report.frame_idx;
    EXPECT_EQ(report.merge.has_value(), report.frame_idx == kDue) << report.frame_idx;
  }
  const SubmapMerge& merge = *reports[kDue].merge;
  EXPECT_EQ(merge.submap, 1);
  EXPECT_EQ(merge.into, 0);
  EXPECT_NEAR(merge.into_from_submap.scale, kHalf, kUnit);
  ExpectOnePlace(reports[12], reports[3], merge);
  EXPECT_EQ(reports.back().state, TrackingState::kTracking);
}

TEST_F(MapsThatMeet, StayTwoWhereTheyAreNotToBeJoinedOrContradictEachOther) {
  std::vector<TrackerOptions> unmerged(4, Options());
  unmerged[0].relocalization.merge = Switch::kOff;
  unmerged[1].relocalization.max_unit_spread = 0;
  unmerged[2].relocalization.relocalize = Switch::kOff;
  unmerged[3].find_lost = Switch::kOff;
  for (const TrackerOptions& options : unmerged) {
    const auto reports = Show(options, Twice());
    ASSERT_EQ(static_cast<int>(reports.size()), kAgain + kFrames);
    for (const FrameReport& report : reports) {
      EXPECT_FALSE(report.merge);
      EXPECT_EQ(report.submap, report.frame_idx >= kAgain ? 1 : 0);
    }
  }
}

TEST_F(LossOfTheView, AMapThatIsFoundAgainEndsTheWaitForAnother) {
  TrackerOptions options = FromDepth();
  options.max_lost_frames = 1;
  options.relocalization.search_every = 1;
  options.min_corners = 100;
  std::vector<cv::Mat> images = AllImages();
  for (std::size_t i = 4; i < 10; ++i) images[i] = Ramp();
  const auto reports = Run(options, images);
  ASSERT_EQ(static_cast<int>(reports.size()), kFrames);
  for (const FrameReport& report : reports) {
    const bool awaited = report.frame_idx >= 5 && report.frame_idx < 10;
    EXPECT_EQ(report.state == TrackingState::kTracking, report.frame_idx < 4 || report.frame_idx >= 10)
        << report.frame_idx << report.note;
    EXPECT_EQ(report.submap, awaited ? 1 : 0) << report.frame_idx;
  }
}

TEST_F(LossOfTheView, OnlyFramesThatShowSomethingEndTheRun) {
  TrackerOptions options = FromDepth();
  options.max_lost_frames = 2;
  options.submaps = Switch::kOff;
  Tracker tracker = MakeTracker(options);
  const auto show = [&](const cv::Mat& image) {
    PreparedFrame frame = PrepareFrame(0, NameOf(0), 0, image, {}, options);
    frame.known_depth_mm = [depth = *depth_] { return depth; };
    tracker.Process(frame);
  };
  show(Image(0));
  for (int i = 0; i < 5; ++i) show(Black());
  EXPECT_FALSE(tracker.GaveUp());
  for (int i = 0; i < 2; ++i) show(Noise(i));
  EXPECT_TRUE(tracker.GaveUp());
}

}  // namespace
}  // namespace pliant
