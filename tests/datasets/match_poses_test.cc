// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/match_poses.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/base/random.h"

namespace pliant {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kTolerance_s = 0.01;
constexpr int kFrames = 60;
constexpr double kRate_hz = 30;

class TimedFrames final : public Sequence {
 public:
  explicit TimedFrames(std::vector<double> times_s) : times_s_(std::move(times_s)) {}

  const Camera& camera() const override { return camera_; }
  int size() const override { return static_cast<int>(times_s_.size()); }
  Result<std::optional<SequenceFrame>> Next() override { return std::optional<SequenceFrame>(); }
  Result<std::optional<cv::Mat>> Depth(int) const override { return std::optional<cv::Mat>(); }
  std::optional<Rigid3> WorldFromCamera(int) const override { return std::nullopt; }
  std::optional<double> TimestampS(int frame_idx) const override {
    if (frame_idx < 0 || frame_idx >= size()) return std::nullopt;
    return times_s_[static_cast<std::size_t>(frame_idx)];
  }

 private:
  Camera camera_ = *Camera::Create("SIMPLE_PINHOLE", 64, 48, std::vector<double>{50, 32, 24});
  std::vector<double> times_s_;
};

// (first + k * stride) / rate_hz
std::vector<double> Times(int count, double rate_hz, int first = 0, int stride = 1) {
  std::vector<double> times_s;
  for (int k = 0; k < count; ++k) times_s.push_back((first + k * stride) / rate_hz);
  return times_s;
}
const std::vector<double> kTimes = Times(kFrames, kRate_hz);

std::vector<double> Shifted(std::vector<double> times_s, double by_s) {
  for (double& time_s : times_s) time_s += by_s;
  return times_s;
}

std::vector<double> Jittered(std::vector<double> times_s, double sigma_s) {
  Random random(5);
  for (double& time_s : times_s) time_s += random.Normal(sigma_s);
  std::ranges::sort(times_s);
  return times_s;
}

// The k-th pose is at x = k.
Result<MatchedPoses> Match(const std::vector<double>& pose_times_s, const std::vector<double>& frame_times_s = kTimes) {
  std::vector<TimedPose> poses;
  for (const double time_s : pose_times_s) {
    TimedPose pose{time_s, {}};
    pose.world_from_cam.translation.x() = static_cast<double>(poses.size());
    poses.push_back(pose);
  }
  return MatchPoses(poses, TimedFrames(frame_times_s), kTolerance_s, "'path.txt'");
}

std::size_t NumMatched(const std::vector<double>& pose_times_s, const std::vector<double>& frame_times_s = kTimes) {
  const auto matched = Match(pose_times_s, frame_times_s);
  EXPECT_TRUE(matched.ok()) << matched.status().message();
  return matched.ok() ? matched->world_from_cam.size() : 0;
}

std::string WhyNot(const std::vector<double>& pose_times_s, const std::vector<double>& frame_times_s = kTimes) {
  const Status status = Match(pose_times_s, frame_times_s).status();
  EXPECT_EQ(status.code(), ErrorCode::kMismatch);
  return status.message();
}

TEST(MatchPoses, OfFramesComeToThem) {
  const auto matched = Match(Times(40, kRate_hz, 20));
  ASSERT_TRUE(matched.ok()) << matched.status().message();
  EXPECT_THAT(matched->notes, IsEmpty());
  ASSERT_EQ(matched->world_from_cam.size(), 40U);
  for (const auto& [frame_idx, world_from_cam] : matched->world_from_cam)
    EXPECT_EQ(world_from_cam.translation.x(), frame_idx - 20);
}

TEST(MatchPoses, MayBeFewerThanTheFrames) {
  EXPECT_EQ(NumMatched(Times(30, kRate_hz, 0, 2)), 30U);
  EXPECT_EQ(NumMatched(Times(19, kRate_hz, 5, 3)), 19U);
  std::vector<double> keyframes;
  for (const int frame : {0, 4, 5, 11, 13, 26, 27, 31, 48, 59}) keyframes.push_back(frame / kRate_hz);
  EXPECT_EQ(NumMatched(keyframes), keyframes.size());
}

TEST(MatchPoses, MayBeOffByAConstant) {
  for (const double offset_s : {-0.009, 0.005, 0.009}) EXPECT_EQ(NumMatched(Shifted(kTimes, offset_s)), kTimes.size());
}

TEST(MatchPoses, MayBeOfFramesAtJitteredTimes) {
  constexpr double kSigma_s = 0.004;
  const std::vector<double> jittered = Jittered(kTimes, kSigma_s);
  EXPECT_EQ(NumMatched(jittered, jittered), kTimes.size());
  EXPECT_GT(NumMatched(kTimes, jittered), kTimes.size() * 9 / 10);  // of nominal times: 1 % are off by 2.5 sigmas
}

TEST(MatchPoses, MayBeOfMoreOrOtherFramesThanThereAre) {
  const std::vector<double> film = Times(3000, kRate_hz);
  EXPECT_EQ(NumMatched(film, Times(kFrames, kRate_hz, 1000)), kTimes.size());  // a part of it
  EXPECT_EQ(NumMatched(Times(1000, kRate_hz, 0, 3), Times(kFrames, kRate_hz, 1000)), kTimes.size() / 3);
  EXPECT_EQ(NumMatched(film, Times(1000, kRate_hz, 0, 3)), 1000U);  // every third one
  std::vector<double> gaps = Times(20, kRate_hz);                   // some were left out
  for (const double time_s : Times(30, kRate_hz, 27)) gaps.push_back(time_s);
  EXPECT_EQ(NumMatched(kTimes, gaps), gaps.size());
}

TEST(MatchPoses, MayBeOfADeviceThatGivesMoreThanThereAreFrames) {
  for (const double phase_s : {0.0, 0.0037, 0.008}) {
    EXPECT_EQ(NumMatched(Shifted(Times(300, 100, -50), phase_s)), kTimes.size());
    EXPECT_EQ(NumMatched(Shifted(Times(81, 100, 60), phase_s)), 25U) << "of 0.8 s";
    EXPECT_EQ(NumMatched(Shifted(Times(600, 200), phase_s), Times(kFrames, 20)), kTimes.size());
  }
}

TEST(MatchPoses, AtAnotherRateAreRefusedWithBothRates) {
  for (const double rate_hz : {20.0, 24.0, 25.0, 50.0, 60.0})
    for (const int first : {0, 20})
      EXPECT_THAT(WhyNot(Times(40, rate_hz, first)), HasSubstr("most poses lie between two frames: give each pose"));
  EXPECT_THAT(WhyNot(Times(40, 25)),
              HasSubstr("the poses of 'path.txt' come 25.00 times a second and the frames 30.00 times, and"));
  EXPECT_THAT(WhyNot(Times(kFrames, 30), Times(kFrames, 25)), HasSubstr("30.00 times a second and the frames 25.00"));
}

TEST(MatchPoses, ThatDriftAwayAreRefusedBeforeOneComesToAnotherFrame) {
  EXPECT_THAT(WhyNot(Times(3000, 29.97), Times(3000, 30)), HasSubstr("29.97 times a second and the frames 30.00"));
  const auto matched = Match(Times(500, 29.97), Times(500, 30));
  ASSERT_TRUE(matched.ok()) << matched.status().message();
  for (const auto& [frame_idx, world_from_cam] : matched->world_from_cam)
    EXPECT_EQ(world_from_cam.translation.x(), frame_idx);
}

TEST(MatchPoses, OfAnotherUnitAreReadInItOnlyIfTheyComeToFrames) {
  std::vector<double> times_ms = kTimes;
  for (double& time : times_ms) time *= 1000;
  const auto matched = Match(times_ms);
  ASSERT_TRUE(matched.ok()) << matched.status().message();
  EXPECT_EQ(matched->world_from_cam.size(), kTimes.size());
  EXPECT_THAT(matched->notes, testing::ElementsAre("the times of 'path.txt' are read as milliseconds"));
  std::vector<double> times_100 = Times(40, kRate_hz);
  for (double& time : times_100) time *= 100;
  EXPECT_THAT(WhyNot(times_100), HasSubstr("'path.txt', read as milliseconds, come 300.00 times a second"));
}

}  // namespace
}  // namespace pliant
