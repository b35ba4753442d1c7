// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/prefetched_sequence.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>

namespace pliant {
namespace {

Camera TestCamera() {
  constexpr std::array<double, 4> kParams = {60, 60, 31.5, 23.5};
  return *Camera::Create(CameraModelId::kPinhole, 64, 48, kParams);
}

// Frames 0 .. count - 1; frame `bad` is a Status, frame `thrown` an exception. Notes how far it was read, and whether
// two threads were ever inside at once.
class CountingSequence final : public Sequence {
 public:
  struct Log {
    std::atomic<int> read = 0;
    std::atomic<int> inside = 0;
    std::atomic<bool> overlapped = false;
  };
  CountingSequence(int count, int bad, int thrown, Log* log) : count_(count), bad_(bad), thrown_(thrown), log_(log) {}

  const Camera& camera() const override { return camera_; }
  int size() const override { return count_; }
  Result<std::optional<SequenceFrame>> Next() override {
    const Visit visit(log_);
    if (next_ >= count_) return std::optional<SequenceFrame>();
    const int idx = next_++;
    ++log_->read;
    if (idx == bad_) return Status(ErrorCode::kUnreadable, "bad");
    if (idx == thrown_) throw std::runtime_error("thrown");
    SequenceFrame frame;
    frame.frame_idx = idx;
    return std::optional<SequenceFrame>(frame);
  }
  Result<std::optional<cv::Mat>> Depth(int frame_idx) const override {
    const Visit visit(log_);
    return std::optional<cv::Mat>(cv::Mat(1, 1, CV_32FC1, cv::Scalar::all(frame_idx)));
  }
  std::optional<Rigid3> WorldFromCamera(int frame_idx) const override {
    const Visit visit(log_);
    return Rigid3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(frame_idx, 0, 0));
  }
  std::optional<double> TimestampS(int frame_idx) const override { return frame_idx; }

 private:
  struct Visit {
    explicit Visit(Log* visited) : log(visited) {
      if (++visited->inside > 1) visited->overlapped = true;
    }
    ~Visit() { --log->inside; }
    Log* log;
  };
  Camera camera_ = TestCamera();
  int count_;
  int bad_;
  int thrown_;
  Log* log_;
  int next_ = 0;
};

TEST(PrefetchedSequence, GivesTheSameFramesInTheSameOrder) {
  CountingSequence::Log log;
  PrefetchedSequence sequence(std::make_unique<CountingSequence>(50, -1, -1, &log));
  EXPECT_EQ(sequence.size(), 50);
  EXPECT_EQ(sequence.camera().width(), 64);
  for (int idx = 0; idx < 50; ++idx) {
    const auto frame = sequence.Next();
    ASSERT_TRUE(frame.ok() && frame->has_value());
    EXPECT_EQ((*frame)->frame_idx, idx);
    EXPECT_EQ((*sequence.Depth(idx))->at<float>(0, 0), static_cast<float>(idx));
    EXPECT_EQ(sequence.WorldFromCamera(idx)->translation.x(), idx);
    EXPECT_EQ(*sequence.TimestampS(idx), idx);
  }
  for (int again = 0; again < 2; ++again) EXPECT_FALSE(sequence.Next()->has_value());
  EXPECT_FALSE(log.overlapped);
}

TEST(PrefetchedSequence, PassesFailuresAndExceptionsOnInTheirPlace) {
  CountingSequence::Log log;
  PrefetchedSequence sequence(std::make_unique<CountingSequence>(4, 1, 2, &log), 2);
  EXPECT_EQ((*sequence.Next())->frame_idx, 0);
  EXPECT_EQ(sequence.Next().status().message(), "bad");
  EXPECT_THROW((void)sequence.Next(), std::runtime_error);
  EXPECT_EQ((*sequence.Next())->frame_idx, 3);
  EXPECT_FALSE(sequence.Next()->has_value());
}

TEST(PrefetchedSequence, ReadsOnlyAFewFramesAhead) {
  constexpr int kAhead = 3;
  CountingSequence::Log log;
  PrefetchedSequence sequence(std::make_unique<CountingSequence>(1000, -1, -1, &log), kAhead);
  for (int taken = 1; taken <= 20; ++taken) {
    ASSERT_TRUE(sequence.Next().ok());
    // Time enough for a reader without a bound to run away; a bounded one passes however long it takes.
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_LE(log.read, taken + kAhead);
  }
}

TEST(PrefetchedSequence, EndsAtAnyTime) {
  for (int taken = 0; taken < 8; ++taken) {
    CountingSequence::Log log;
    {
      PrefetchedSequence sequence(std::make_unique<CountingSequence>(5, -1, -1, &log), 2);
      for (int i = 0; i < taken; ++i) ASSERT_TRUE(sequence.Next().ok());
    }
    EXPECT_EQ(log.inside, 0);
    EXPECT_GE(log.read, std::min(taken, 5));
  }
}

}  // namespace
}  // namespace pliant
