// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Maps that are made beside tracking are taken over a fixed number of frames later, and meet the frames since.
#include <gmock/gmock.h>

#include "pliant/tracking/tracker_options.h"
#include "tracking/tracker_from_images.h"

namespace pliant {
namespace {

using tracking_test::kFrames;
using tracking_test::TrackerFromImages;

constexpr double kSamePose = 0.02;  // of the path: what another way from the same map leaves

class HandedOverMap : public TrackerFromImages {
 protected:
  static TrackerOptions Options(int handover_frames) {
    TrackerOptions options;
    options.init.method = InitMethod::kGated;
    options.handover_frames = handover_frames;
    return options;
  }
  static std::vector<FrameReport> Run(const TrackerOptions& options, int threads, int frames = kFrames) {
    Tracker tracker(*camera_, options, 1, threads);
    std::vector<FrameReport> reports;
    const auto take = [&](std::vector<FrameReport> more) {
      for (FrameReport& report : more) reports.push_back(std::move(report));
    };
    for (int i = 0; i < frames; ++i) take(Show(i, i, &tracker));
    tracker.EndSequence();
    take(tracker.Finish());
    return reports;
  }
};

TEST_F(HandedOverMap, IsThatOfTheSameFrames) {
  const std::vector<FrameReport> at_once = Run(Options(0), 1);
  const std::vector<FrameReport> later = Run(Options(3), 1);
  ASSERT_EQ(at_once.size(), later.size());
  ASSERT_TRUE(at_once.front().first_map && later.front().first_map);
  const int declared = at_once.front().first_map->declared_frame_idx;
  EXPECT_EQ(later.front().first_map->declared_frame_idx, declared);
  ASSERT_LT(declared + 3, kFrames) << "the scene is too short for this test";
  for (int k = 0; k <= declared; ++k) {
    const auto idx = static_cast<std::size_t>(k);
    EXPECT_EQ(later[idx].cam_from_world->translation, at_once[idx].cam_from_world->translation) << k;
    EXPECT_EQ(later[idx].observations.size(), at_once[idx].observations.size()) << k;
  }
}

TEST_F(HandedOverMap, MeetsTheFramesSince) {
  const std::vector<FrameReport> at_once = Run(Options(0), 1);
  const std::vector<FrameReport> later = Run(Options(3), 1);
  ASSERT_EQ(at_once.size(), later.size());
  const double path = at_once.back().cam_from_world->translation.norm();
  std::set<PointId> known;
  for (std::size_t k = 0; k < later.size(); ++k) {
    ASSERT_TRUE(later[k].cam_from_world) << k << ": " << later[k].note;
    EXPECT_EQ(later[k].frame_idx, static_cast<int>(k));
    EXPECT_LT((later[k].cam_from_world->translation - at_once[k].cam_from_world->translation).norm(), kSamePose * path)
        << k;
    for (const NewPoint& point : later[k].new_points) EXPECT_TRUE(known.insert(point.id).second) << k;
    for (const PointObservation& seen : later[k].observations) EXPECT_TRUE(known.contains(seen.id)) << k;
    EXPECT_LT(later[k].median_reprojection_error_px, tracking_test::kMedianError_px) << k;
  }
}

TEST_F(HandedOverMap, DoesNotDependOnTheNumberOfThreads) {
  TrackerOptions options = Options(2);
  options.growth.window = 4;
  options.growth.reestimate_every = 3;
  const std::vector<FrameReport> one = Run(options, 1);
  const std::vector<FrameReport> two = Run(options, 2);
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t k = 0; k < one.size(); ++k) {
    EXPECT_EQ(one[k].state, two[k].state) << k;
    ASSERT_EQ(one[k].observations.size(), two[k].observations.size()) << k;
    for (std::size_t i = 0; i < one[k].observations.size(); ++i)
      EXPECT_EQ(one[k].observations[i].position, two[k].observations[i].position) << k;
  }
}

TEST_F(HandedOverMap, IsTakenWhereTheSequenceEndsBefore) {
  const int declared = Run(Options(0), 1).front().first_map->declared_frame_idx;
  for (const int frames : {declared + 1, declared + 2, declared + 4}) {
    const std::vector<FrameReport> reports = Run(Options(3), 1, frames);
    ASSERT_EQ(static_cast<int>(reports.size()), frames);
    for (const FrameReport& report : reports)
      EXPECT_TRUE(report.cam_from_world) << frames << " frames, " << report.frame_idx << ": " << report.note;
  }
}

// To track back would keep the frame waiting: where as many points are left as a map needs, it goes on with these.
TEST_F(HandedOverMap, GoesOnWithThePointsThatAreLeft) {
  const int declared = Run(Options(0), 1).front().first_map->declared_frame_idx;
  const cv::Size size = images_->front().size();
  for (const int min_points : {20, 1000}) {
    TrackerOptions options = Options(3);
    options.init.window.min_points = min_points;
    Tracker tracker(*camera_, options, 1, 1);
    std::vector<FrameReport> reports;
    bool goes_back = false;
    for (int i = 0; i < kFrames && !goes_back; ++i) {
      cv::Mat mask(size, CV_8UC1, cv::Scalar(255));
      if (i > declared) mask.colRange(0, 2 * size.width / 3) = 0;
      const cv::Mat& image = (*images_)[static_cast<std::size_t>(i)];
      for (FrameReport& report : tracker.Process(PrepareFrame(i, NameOf(i), i / 30.0, image, mask, options)))
        reports.push_back(std::move(report));
      goes_back = tracker.TakeGoesBackTo().has_value();
    }
    EXPECT_EQ(goes_back, min_points == 1000);
    if (goes_back) continue;
    ASSERT_EQ(reports.size(), static_cast<std::size_t>(kFrames));
    ASSERT_TRUE(reports.front().first_map);
    EXPECT_LT(2 * reports.back().observations.size(), reports.front().observations.size());
    EXPECT_TRUE(reports.back().cam_from_world) << reports.back().note;
  }
}

// What the reference alone tells needs no frame after it.
TEST_F(HandedOverMap, FromKnownDepthIsTakenAtOnce) {
  for (const InitMethod method : {InitMethod::kDepth, InitMethod::kDepthPrior, InitMethod::kColmapModel}) {
    TrackerOptions options = Options(3);
    options.init.method = method;
    options.depth_prior.kind = DepthPriorKind::kDepth;
    Tracker tracker(*camera_, options, 1, 1);
    for (int i = 0; i < 5; ++i) {
      PreparedFrame frame = PrepareFrame(i, NameOf(i), i / 30.0, (*images_)[static_cast<std::size_t>(i)], {}, options);
      frame.known_depth_mm = [depth = *depth_] { return depth; };
      if (method == InitMethod::kDepthPrior) frame.depth_prior = *depth_;
      frame.known_points = [] {
        std::vector<PixelDepth> points;
        for (int k = 0; k < 150; ++k) {
          const int row = k / 15;
          const Eigen::Vector2d pixel(20 + 18.7 * (k % 15), 20 + 20.3 * row);
          points.push_back({pixel, depth_->at<float>(static_cast<int>(pixel.y()), static_cast<int>(pixel.x()))});
        }
        return points;
      };
      const std::vector<FrameReport> reports = tracker.Process(frame);
      ASSERT_EQ(reports.size(), 1U) << EnumName(method) << ", frame " << i;
      EXPECT_TRUE(reports.front().cam_from_world) << EnumName(method) << ": " << reports.front().note;
    }
  }
}

TEST_F(HandedOverMap, IsNotLookedForOnceTheReferenceIsLost) {
  Tracker tracker(*camera_, Options(3), 1, 1);
  for (int i = 0; i < 5; ++i) Show(i, i, &tracker);
  const cv::Mat black(images_->front().size(), images_->front().type(), cv::Scalar::all(0));
  std::vector<FrameReport> reports;
  for (int i = 5; i < 60; ++i)
    for (FrameReport& report : tracker.Process(PrepareFrame(i, NameOf(i), i / 30.0, black, {}, {})))
      reports.push_back(std::move(report));
  for (const FrameReport& report : reports) EXPECT_FALSE(report.cam_from_world) << report.frame_idx;
}

}  // namespace
}  // namespace pliant
