// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/pipeline/image_tracker.h"

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/base/statistics.h"
#include "pliant/datasets/given_images.h"
#include "support/kept_reports.h"
#include "support/rendered_sequence.h"
#include "support/temporary_folder.h"

namespace pliant {
namespace {

using testing::HasSubstr;

class RenderedImages final : public ImageSource {
 public:
  int count() const override { return static_cast<int>(Rendered().frames.size()); }
  Result<std::optional<cv::Mat>> Read(int idx) override {
    return idx < count() ? std::optional(Rendered().frames[static_cast<std::size_t>(idx)].image) : std::nullopt;
  }
};

TrackOptions FixedImages() {
  TrackOptions options;
  options.image.working = WorkingImageMode::kFixed;
  options.max_frames_back = 0;
  return options;
}

TEST(ImageTracker, ReportsWhatARunOfTheSameImagesReports) {
  const TemporaryFolder folder("image_tracker");
  RunRequest request;
  request.input.given = std::make_shared<GivenImages>(
      GivenImages{.camera = Rendered().camera, .images = std::make_shared<RenderedImages>()});
  request.output_path = folder.Path("run");
  TrackOptions options = FixedImages();
  options.image.smoothing_px = 0.7;
  KeptReports run;
  const auto summary = RunTrack(request, options, std::array<TrackObserver*, 1>{&run});
  ASSERT_TRUE(summary.ok()) << summary.status().message();

  auto tracker = ImageTracker::Create(Rendered().camera, std::nullopt, options);
  ASSERT_TRUE(tracker.ok()) << tracker.status().message();
  std::vector<FrameReport> reports;
  RenderedSequence sequence;
  while (auto frame = *sequence.Next()) {
    frame->name = run.reports[static_cast<std::size_t>(frame->frame_idx)].name;
    auto done = tracker->Process(*frame);
    ASSERT_TRUE(done.ok());
    for (FrameReport& report : *done) reports.push_back(std::move(report));
  }
  for (FrameReport& report : tracker->Finish()) reports.push_back(std::move(report));

  ASSERT_EQ(reports.size(), run.reports.size());
  std::size_t observations = 0;
  for (std::size_t k = 0; k < reports.size(); ++k) {
    EXPECT_EQ(reports[k].frame_idx, static_cast<int>(k));
    EXPECT_EQ(reports[k].state, run.reports[k].state);
    EXPECT_EQ(reports[k].note, run.reports[k].note);
    ASSERT_EQ(reports[k].observations.size(), run.reports[k].observations.size());
    observations += reports[k].observations.size();
    for (std::size_t i = 0; i < reports[k].observations.size(); ++i) {
      EXPECT_EQ(reports[k].observations[i].pixel, run.reports[k].observations[i].pixel);
      EXPECT_EQ(reports[k].observations[i].position, run.reports[k].observations[i].position);
    }
  }
  EXPECT_GT(observations, 0U);
}

TEST(ImageTracker, RefusesOptionsThatNeedMoreThanImages) {
  for (const InitMethod method : {InitMethod::kDepth, InitMethod::kStereo, InitMethod::kColmapModel}) {
    TrackOptions options = FixedImages();
    options.tracker.init.method = method;
    EXPECT_EQ(ImageTracker::Create(Rendered().camera, std::nullopt, options).status().code(),
              ErrorCode::kInvalidArgument);
  }
  TrackOptions options = FixedImages();
  options.track_file.path = "tracks.npz";
  EXPECT_THAT(ImageTracker::Create(Rendered().camera, std::nullopt, options).status().message(),
              HasSubstr("TrackFile.path"));
}

// Of one image, up to a scale, whatever the camera does.
TEST(ImageTracker, StartsFromADepthPriorAndSaysThatItIsProvisional) {
  constexpr double kShape = 0.02;  // of log distance, where the prior has no error but its unit
  TrackOptions options = FixedImages();
  options.tracker.init.method = InitMethod::kDepthPrior;
  options.tracker.depth_prior.kind = DepthPriorKind::kDepth;
  auto tracker = ImageTracker::Create(Rendered().camera, std::nullopt, options);
  ASSERT_TRUE(tracker.ok()) << tracker.status().message();
  RenderedSequence sequence;
  auto frame = *sequence.Next();
  frame->depth_prior = 0.01 * Rendered().frames.front().depth;
  const auto reports = tracker->Process(*frame);
  ASSERT_TRUE(reports.ok());
  ASSERT_EQ(reports->size(), 1U);
  const FrameReport& report = reports->front();
  EXPECT_EQ(report.state, TrackingState::kProvisional);
  ASSERT_GT(report.observations.size(), 40U);
  std::vector<double> log_ratios;
  for (const PointObservation& seen : report.observations) {
    const auto x = static_cast<int>(std::lround(seen.pixel.x()));
    const auto y = static_cast<int>(std::lround(seen.pixel.y()));
    log_ratios.push_back(std::log(seen.position.z() / Rendered().frames.front().depth.at<float>(y, x)));
  }
  EXPECT_LT(MedianDeviation(log_ratios), kShape);

  frame->frame_idx = 1;
  frame->depth_prior = cv::Mat(240, 320, CV_16UC1, cv::Scalar::all(1));
  EXPECT_THAT(tracker->Process(*frame).status().message(), HasSubstr("the depth prior of image"));
  options.tracker.depth_prior.path = "priors";
  EXPECT_EQ(ImageTracker::Create(Rendered().camera, std::nullopt, options).status().code(),
            ErrorCode::kInvalidArgument);
}

// Of a map that is its own, brightness says whether it grows where it should.
TEST(ImageTracker, ComparesADepthPriorThatTheMapIsOfWithBrightness) {
  constexpr std::size_t kFirstFrames = 4;
  for (const DepthPriorKind kind : {DepthPriorKind::kDepth, DepthPriorKind::kInverseDepth}) {
    TrackOptions options = FixedImages();
    options.tracker.init.method = InitMethod::kDepthPrior;
    options.tracker.depth_prior.kind = kind;
    auto tracker = ImageTracker::Create(Rendered().camera, std::nullopt, options);
    ASSERT_TRUE(tracker.ok()) << tracker.status().message();
    RenderedSequence sequence;
    for (std::size_t k = 0; k < kFirstFrames; ++k) {
      auto frame = *sequence.Next();
      frame->depth_prior = Rendered().frames[k].depth;
      const auto reports = tracker->Process(*frame);
      ASSERT_TRUE(reports.ok());
      ASSERT_EQ(reports->size(), 1U);
      const FrameReport& report = reports->front();
      if (k == 0) {
        ASSERT_TRUE(report.first_map);
        EXPECT_TRUE(report.first_map->evidence.uses_prior);
        continue;
      }
      EXPECT_TRUE(report.prior.by_brightness);
      EXPECT_EQ(report.prior.agreement,
                kind == DepthPriorKind::kDepth ? PriorAgreement::kAgrees : PriorAgreement::kFalls);
    }
  }
}

TEST(ImageTracker, WithoutADepthPriorAStartFromItSaysSo) {
  TrackOptions options = FixedImages();
  options.tracker.init.method = InitMethod::kDepthPrior;
  auto tracker = ImageTracker::Create(Rendered().camera, std::nullopt, options);
  RenderedSequence sequence;
  const auto reports = tracker->Process(**sequence.Next());
  ASSERT_TRUE(reports.ok());
  ASSERT_EQ(reports->size(), 1U);
  EXPECT_FALSE(reports->front().cam_from_world.has_value());
  EXPECT_THAT(reports->front().note, HasSubstr("the image has no depth prior"));
}

TEST(ImageTracker, PassesOverAnImageOfAnotherSize) {
  auto tracker = ImageTracker::Create(Rendered().camera, std::nullopt, FixedImages());
  ASSERT_TRUE(tracker.ok());
  SequenceFrame frame;
  frame.name = "small.png";
  frame.image = cv::Mat::zeros(12, 16, CV_8UC1);
  const Status status = tracker->Process(frame).status();
  EXPECT_EQ(status.code(), ErrorCode::kMismatch);
  EXPECT_THAT(status.message(), HasSubstr("image small.png has 16x12 pixels, and the camera 320x240"));
  EXPECT_TRUE(tracker->Finish().empty());
}

}  // namespace
}  // namespace pliant
