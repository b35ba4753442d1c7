// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Runs whose images arrive while they are tracked.
#include <atomic>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "pliant/base/files.h"
#include "pliant/datasets/live_source.h"
#include "pliant/io/camera_file.h"
#include "pliant/io/run_summary.h"
#include "pliant/pipeline/track.h"
#include "support/piped_video.h"
#include "support/rendered_sequence.h"
#include "support/test_folder.h"

namespace pliant {
namespace {

constexpr int kFps = 30;

class LiveRun : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(WriteCameraFile(folder_.Path("camera.yaml"), {.camera = Rendered().camera, .fps = kFps}).ok());
    options_.image.working = WorkingImageMode::kFixed;  // else it is measured on fewer images than are in a file
    options_.timings = RunTimings::kNone;
    options_.live_input.frames = LiveFrames::kAll;
  }

  RunRequest RequestOf(const std::string& image_path, const std::string& name) const {
    RunRequest request;
    request.input.image_path = image_path;
    request.output_path = folder_.Path(name);
    return request;
  }
  static cv::Mat Gray(const cv::Mat& image) {
    cv::Mat gray = image;
    if (image.channels() == 3) cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
    return gray;
  }
  void Send(const PipedVideo& pipe) const {
    pipe.Header(Rendered().camera.width(), Rendered().camera.height(), kFps);
    for (const SimulatedFrame& frame : Rendered().frames) pipe.Image(Gray(frame.image));
  }

  TestFolder folder_;
  TrackOptions options_;
};

TEST_F(LiveRun, OfEveryImageEqualsTheRunOfItsRecording) {
  PipedVideo pipe;
  std::thread sender([&] {
    Send(pipe);
    pipe.Close();
  });
  RunRequest request = RequestOf("-", "live");
  request.input.camera_path = folder_.Path("camera.yaml");
  const auto live = RunTrack(request, options_, {});
  sender.join();
  ASSERT_TRUE(live.ok()) << live.status().message();
  const std::string recording = RecordingOf(request.output_path);
  EXPECT_EQ(live->description.input, recording);
  const auto written = ReadRunSummary(folder_.Path("live/run.json"));
  ASSERT_TRUE(written.ok() && written->stream);
  EXPECT_EQ(written->stream->received, std::ssize(Rendered().frames));
  EXPECT_EQ(written->stream->skipped, 0);
  EXPECT_EQ(written->stream->fps, kFps);
  EXPECT_FALSE(written->stream->measured);

  const auto again = RunTrack(RequestOf(recording, "again"), options_, {});
  ASSERT_TRUE(again.ok()) << again.status().message();
  EXPECT_FALSE(again->stream);
  EXPECT_EQ(again->status, live->status);
  EXPECT_EQ(live->frames_read, std::ssize(Rendered().frames));
  for (const char* file : {"frames.csv", "observations.csv", "trajectory.txt"})
    EXPECT_EQ(folder_.Read(std::string("live/") + file), folder_.Read(std::string("again/") + file)) << file;
}

TEST_F(LiveRun, KeepsWhatWasTrackedBeforeTheSizeChanges) {
  options_.tracker.init.method = InitMethod::kGated;  // has a map before its images end
  PipedVideo pipe;
  std::thread sender([&] {
    Send(pipe);
    pipe.Header(32, 24, kFps);
    pipe.Image(cv::Mat(24, 32, CV_8UC1, cv::Scalar(100)));
    pipe.Close();
  });
  RunRequest request = RequestOf("-", "live");
  request.input.camera_path = folder_.Path("camera.yaml");
  const auto summary = RunTrack(request, options_, {});
  pipe.GiveUp();
  sender.join();
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->status, RunStatus::kFailed);
  EXPECT_EQ(summary->error, ErrorCode::kMismatch);
  EXPECT_THAT(summary->note, testing::HasSubstr("change their size from"));
  EXPECT_EQ(summary->frames_read, std::ssize(Rendered().frames));
  EXPECT_GT(summary->frames_tracked, 0);
  const auto written = ReadRunSummary(folder_.Path("live/run.json"));
  ASSERT_TRUE(written.ok()) << written.status().message();
  EXPECT_EQ(written->frames_tracked, summary->frames_tracked);
}

// When it is shown an image.
class StopAt final : public TrackObserver {
 public:
  StopAt(int frame_idx, std::atomic<bool>* stop) : frame_idx_(frame_idx), stop_(*stop) {}
  void OnStart(int /*frames*/) override { has_started_ = true; }
  void OnFrame(const FrameReport& /*report*/) override {}
  void OnImage(int frame_idx, const cv::Mat& /*image*/) override {
    if (frame_idx == frame_idx_) stop_ = true;
  }
  bool has_started() const { return has_started_; }

 private:
  int frame_idx_;
  std::atomic<bool>& stop_;
  bool has_started_ = false;
};

// Runs on a pipe into which `send` writes images without end, and which is stopped when an image is shown.
class StoppedLiveRun : public LiveRun {
 protected:
  Result<RunSummary> StopAtImage(int frame_idx, const std::function<void(const PipedVideo&)>& send) {
    PipedVideo pipe;
    std::thread sender([&] { send(pipe); });
    std::atomic<bool> stop = false;
    StopAt observer(frame_idx, &stop);
    RunRequest request = RequestOf("-", "stopped");
    request.input.camera_path = folder_.Path("camera.yaml");
    request.stop = &stop;
    TrackObserver* const observers[] = {&observer};
    Result<RunSummary> summary = RunTrack(request, options_, observers);
    pipe.GiveUp();
    sender.join();
    has_started_ = observer.has_started();
    return summary;
  }

  bool has_started_ = false;
};

TEST_F(StoppedLiveRun, EndsLikeASequence) {
  const auto summary = StopAtImage(9, [&](const PipedVideo& pipe) { Send(pipe); });
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->status, RunStatus::kCompleted);
  EXPECT_GE(summary->frames_read, 10);
  EXPECT_LT(summary->frames_read, std::ssize(Rendered().frames));
}

TEST_F(StoppedLiveRun, BeforeItHasAMapIsInterrupted) {
  const auto summary = StopAtImage(2, [&](const PipedVideo& pipe) {  // a camera that stands still
    pipe.Header(Rendered().camera.width(), Rendered().camera.height(), kFps);
    for (std::size_t k = 0; k < Rendered().frames.size(); ++k) pipe.Image(Gray(Rendered().frames.front().image));
  });
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->status, RunStatus::kInterrupted);
  EXPECT_THAT(summary->note, testing::StartsWith("stopped on request; the sequence ended without a first map"));
}

TEST_F(StoppedLiveRun, ShowsItsFirstImageAndEndsBeforeItsImagesAreMeasured) {
  options_.image.working = WorkingImageMode::kMeasured;
  const auto summary = StopAtImage(0, [&](const PipedVideo& pipe) { Send(pipe); });
  EXPECT_EQ(summary.status().code(), ErrorCode::kInterrupted);
  EXPECT_FALSE(has_started_);
  EXPECT_FALSE(std::filesystem::exists(folder_.Path("stopped")));
}

}  // namespace
}  // namespace pliant
