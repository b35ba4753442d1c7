// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/live_source.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <unistd.h>

#include "datasets/sequence_files.h"
#include "pliant/camera/assumed_camera.h"
#include "pliant/datasets/open_sequence.h"
#include "support/piped_video.h"
#include "support/served_bytes.h"

namespace pliant {
namespace {

using testing::HasSubstr;
using Clock = std::chrono::steady_clock;

constexpr int kFps = 20;

bool AreEqual(const cv::Mat& a, const cv::Mat& b) { return a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0; }

std::string Jpeg(const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", image, bytes);
  return {bytes.begin(), bytes.end()};
}

class LiveSourceTest : public SequenceFiles {
 protected:
  void SetUp() override {
    SequenceFiles::SetUp();
    WriteCamera();
    request_ = {.source = "-", .camera_path = Path("camera.yaml"), .recording_path = Path("recording")};
    request_.options.frames = LiveFrames::kAll;
    request_.options.timeout_s = 10;
  }

  // As video has gray levels: 16 is black, 235 is white.
  static cv::Mat Gray(int idx) { return cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(40 + 20 * idx)); }
  static double DecodedLevel(int idx) { return (40 + 20 * idx - 16) * 255.0 / 219.0; }
  void Send(int from, int to) const {
    for (int idx = from; idx < to; ++idx) pipe_.Image(Gray(idx));
  }

  // From the header to the end.
  void SendVideo(int images) {
    pipe_.Header(kWidth, kHeight, kFps);
    Send(0, images);
    pipe_.Close();
  }

  void TearDown() override {
    pipe_.GiveUp();
    SequenceFiles::TearDown();
  }

  // A video of these images.
  std::string Video(const std::string& name, const std::array<char, 4>& codec, const std::vector<int>& images) {
    cv::VideoWriter writer(Path(name), cv::CAP_FFMPEG, cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]),
                           kFps, {kWidth, kHeight});
    EXPECT_TRUE(writer.isOpened());
    for (const int idx : images) {
      cv::Mat color;
      cv::cvtColor(Gray(idx), color, cv::COLOR_GRAY2BGR);
      writer.write(color);
    }
    writer.release();
    return Path(name);
  }
  // Behind each other, while they are read.
  void SendFile(const std::string& file, const std::string& rest) {
    std::ifstream stream(file, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(stream)), {});
    sender_ = std::jthread([this, bytes, rest] {
      pipe_.Write(bytes + rest);
      pipe_.Close();
    });
  }
  // The numbers of the images to the end.
  static std::vector<int> ReadAll(LiveSource& source) {
    std::vector<int> numbers;
    while (true) {
      const auto image = source.Read(static_cast<int>(numbers.size()));
      EXPECT_TRUE(image.ok()) << image.status().message();
      if (!image.ok() || !image->has_value()) return numbers;
      numbers.push_back(static_cast<int>(std::lround((cv::mean(**image)[0] - 40) / 20)));
    }
  }
  PipedVideo pipe_;
  LiveRequest request_;
  std::jthread sender_;
};

TEST(IsLiveSource, TellsAddressesFromFiles) {
  for (const char* live :
       {"-", "device:0", "rtsp://10.0.0.2/stream", "http://host:8080/video", "HTTP://host/a", "udp://@:1234"})
    EXPECT_TRUE(IsLiveSource(live)) << live;
  for (const char* file : {"", "clip.mp4", "device", "/dev/video0", "http", "folder/-", "./-"})
    EXPECT_FALSE(IsLiveSource(file)) << file;
}

TEST(RecordingOf, IsBesideTheRun) {
  EXPECT_EQ(RecordingOf("a/run"), "a/run_recording");
  EXPECT_EQ(RecordingOf("a/run/"), "a/run_recording");
}

TEST_F(LiveSourceTest, GivesEveryImageAndRecordsItAsASequence) {
  SendVideo(6);
  auto source = LiveSource::Open(request_);
  ASSERT_TRUE(source.ok()) << source.status().message();
  std::vector<cv::Mat> images;
  while (true) {
    const auto image = (*source)->Read(static_cast<int>(images.size()));
    ASSERT_TRUE(image.ok()) << image.status().message();
    if (!image->has_value()) break;
    images.push_back(**image);
  }
  ASSERT_EQ(images.size(), 6U);
  for (std::size_t k = 0; k < images.size(); ++k)
    EXPECT_NEAR(cv::mean(images[k])[0], DecodedLevel(static_cast<int>(k)), 2);
  EXPECT_EQ((*source)->TimestampS(3), 3.0 / kFps);
  EXPECT_EQ((*source)->TimestampS(6), std::nullopt);
  EXPECT_EQ((*source)->counts().received, 6);
  EXPECT_EQ((*source)->counts().skipped, 0);
  EXPECT_EQ((*source)->counts().fps, kFps);
  EXPECT_FALSE((*source)->counts().measured);
  EXPECT_TRUE(AreEqual(**(*source)->Read(2), images[2]));  // tracking goes back
  EXPECT_TRUE((*source)->FinishRecording().ok());
  const auto recorded = OpenSequence({.image_path = Path("recording")});
  ASSERT_TRUE(recorded.ok()) << recorded.status().message();
  EXPECT_EQ((*recorded)->size(), 6);
  for (std::size_t k = 0; k < images.size(); ++k) {
    const auto frame = (*recorded)->Next();
    ASSERT_TRUE(frame.ok() && frame->has_value());
    EXPECT_TRUE(AreEqual((*frame)->image, images[k]));
    EXPECT_EQ((*frame)->timestamp_s, static_cast<double>(k) / kFps);
  }
}

TEST_F(LiveSourceTest, SaysWhenItsLastImageWasNotRecorded) {
  pipe_.Header(kWidth, kHeight, kFps);
  Send(0, 2);
  auto source = LiveSource::Open(request_);
  ASSERT_TRUE(source.ok()) << source.status().message();
  ASSERT_TRUE((*source)->Read(0)->has_value());
  ASSERT_TRUE((*source)->FinishRecording().ok());
  std::filesystem::remove_all(Path("recording"));
  Text("recording", "no folder any more");
  ASSERT_TRUE((*source)->Read(1)->has_value());
  const Status recorded = (*source)->FinishRecording();
  EXPECT_EQ(recorded.code(), ErrorCode::kUnwritable);
  EXPECT_THAT(recorded.message(), HasSubstr("recording"));
  pipe_.Close();
}

TEST_F(LiveSourceTest, SkipsAndCountsWhatCameWhileTrackingWasBusy) {
  request_.options.frames = LiveFrames::kNewest;
  SendVideo(5);
  auto source = LiveSource::Open(request_);
  ASSERT_TRUE(source.ok()) << source.status().message();
  while ((*source)->counts().received < 5) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const auto newest = (*source)->Read(0);
  ASSERT_TRUE(newest.ok() && newest->has_value());
  EXPECT_NEAR(cv::mean(**newest)[0], DecodedLevel(4), 2);
  EXPECT_FALSE((*source)->Read(1)->has_value());
  EXPECT_EQ((*source)->counts().skipped, 4);
  EXPECT_TRUE((*source)->counts().measured);
  EXPECT_GT((*source)->counts().fps, 0);
  EXPECT_GE((*source)->TimestampS(0), 0);
}

TEST_F(LiveSourceTest, KnowsWhenAnImageArrivedAndWhichOnesArePassed) {
  request_.options.frames = LiveFrames::kNewest;
  pipe_.Header(kWidth, kHeight, kFps);
  Send(0, 1);
  auto source = LiveSource::Open(request_);
  ASSERT_TRUE(source.ok()) << source.status().message();
  ASSERT_TRUE((*source)->Read(0)->has_value());
  const auto between = Clock::now();
  Send(1, 2);
  ASSERT_TRUE((*source)->Read(1)->has_value());
  EXPECT_LT(*(*source)->Arrived(0), between);
  EXPECT_GT(*(*source)->Arrived(1), between);
  EXPECT_LT(*(*source)->Arrived(1), Clock::now());
  EXPECT_FALSE((*source)->Arrived(2));
  EXPECT_EQ((*source)->Passed(), 2);
  pipe_.Close();
  EXPECT_FALSE((*source)->Read(2)->has_value());
  EXPECT_EQ((*source)->Passed(), 0) << "no newer ones will come";
}

TEST_F(LiveSourceTest, IsASequenceWhoseTimesAreTheSources) {
  SendVideo(5);
  auto source = LiveSource::Open(request_);
  ASSERT_TRUE(source.ok()) << source.status().message();
  SequenceRequest of_images{.image_path = "recording", .start = 1, .stride = 2};
  of_images.given = LiveSource::Given(*source);
  const auto sequence = OpenSequence(of_images);
  ASSERT_TRUE(sequence.ok()) << sequence.status().message();
  for (const int idx : {1, 3}) {
    const auto frame = (*sequence)->Next();
    ASSERT_TRUE(frame.ok() && frame->has_value());
    EXPECT_EQ((*frame)->frame_idx, idx);
    EXPECT_EQ((*frame)->timestamp_s, static_cast<double>(idx) / kFps);
  }
  EXPECT_FALSE((*sequence)->Next()->has_value());
}

TEST_F(LiveSourceTest, ASourceThatStallsFailsAndOneThatIsStoppedEnds) {
  std::atomic<bool> stop = false;
  request_.stop = &stop;
  request_.options.timeout_s = 0.5;
  pipe_.Header(kWidth, kHeight, kFps);
  Send(0, 3);
  auto source = LiveSource::Open(request_);
  ASSERT_TRUE(source.ok()) << source.status().message();
  for (int idx = 0; idx < 3; ++idx) ASSERT_TRUE((*source)->Read(idx)->has_value());
  const auto begin = Clock::now();
  const auto stalled = (*source)->Read(3);
  EXPECT_EQ(stalled.status().code(), ErrorCode::kUnreadable);
  EXPECT_THAT(stalled.status().message(), HasSubstr("standard input has sent no image for"));
  EXPECT_LT(std::chrono::duration<double>(Clock::now() - begin).count(), 5);
  EXPECT_TRUE((*source)->Read(0)->has_value());
  stop = true;
  EXPECT_FALSE((*source)->Read(3)->has_value());
}

TEST_F(LiveSourceTest, CountsWhatCannotBeDecoded) {
  for (int idx = 0; idx < 8; ++idx) {
    std::string image = Jpeg(Gray(idx));
    if (idx == 4) std::fill(image.begin() + 4, image.end() - 2, '\0');
    if (idx == 7) image.resize(image.size() / 2);
    pipe_.Write(image);
  }
  pipe_.Close();
  auto source = LiveSource::Open(request_);
  ASSERT_TRUE(source.ok()) << source.status().message();
  EXPECT_EQ(ReadAll(**source), (std::vector<int>{0, 1, 2, 3, 5, 6}));
  EXPECT_EQ((*source)->counts().received, 6);
  EXPECT_EQ((*source)->counts().damaged, 2);
}

TEST_F(LiveSourceTest, APipedPhotographIsThereBeforeTheNextOneComes) {
  pipe_.Write(Jpeg(Gray(0)));
  auto source = LiveSource::Open(request_);
  ASSERT_TRUE(source.ok()) << source.status().message();
  for (int idx = 0; idx < 3; ++idx) {
    const auto image = (*source)->Read(idx);
    ASSERT_TRUE(image.ok() && image->has_value()) << image.status().message();
    EXPECT_NEAR(cv::mean(**image)[0], 40 + 20 * idx, 1);
    pipe_.Write(Jpeg(Gray(idx + 1)));
  }
  EXPECT_EQ((*source)->counts().fps, kFps) << "by the calibration: photographs tell no rate";
  pipe_.Close();
}

TEST_F(LiveSourceTest, AVideoThatIsCutOffLosesItsLastImage) {
  const std::string last = "FRAME\n" + std::string(kWidth * kHeight, '\x80');
  pipe_.Header(kWidth, kHeight, kFps);
  Send(0, 3);
  pipe_.Write(last);
  pipe_.Close();
  auto source = LiveSource::Open(request_);
  ASSERT_TRUE(source.ok()) << source.status().message();
  EXPECT_EQ(ReadAll(**source).size(), 3U);
  EXPECT_EQ((*source)->counts().received, 3);
  EXPECT_EQ((*source)->counts().damaged, 1);
}

TEST_F(LiveSourceTest, SaysWhereAVideoIsDamagedOrChangesItsSize) {
  const auto ending = [&](const std::string& next) {
    PipedVideo pipe;
    pipe.Header(kWidth, kHeight, kFps);
    for (int idx = 0; idx < 3; ++idx) pipe.Image(Gray(idx));
    pipe.Write(next);
    pipe.Close();
    auto source = LiveSource::Open(request_);
    if (!source.ok()) return source.status();
    for (int idx = 0; idx < 3; ++idx) EXPECT_TRUE((*source)->Read(idx)->has_value()) << idx;
    return (*source)->Read(3).status();
  };
  const Status damaged = ending("FRAXE\n" + std::string(20000, 'x'));
  EXPECT_EQ(damaged.code(), ErrorCode::kUnreadable);
  EXPECT_THAT(damaged.message(), HasSubstr("is damaged after 3 images"));
  const Status changed = ending("YUV4MPEG2 W32 H24 F30:1\nFRAME\n" + std::string(32 * 24 * 3 / 2, 'x'));
  EXPECT_EQ(changed.code(), ErrorCode::kMismatch);
  EXPECT_THAT(changed.message(), HasSubstr("change their size from 64x48 to 32x24 after 3 images"));
}

TEST_F(LiveSourceTest, SaysThatADecoderEndsBeforeItsPipe) {
  SendFile(Video("clip.wmv", {'W', 'M', 'V', '2'}, {0, 1, 2, 3}), std::string(300000, '\x55'));
  auto source = LiveSource::Open(request_);
  ASSERT_TRUE(source.ok()) << source.status().message();
  for (int idx = 0; idx < 4; ++idx) ASSERT_TRUE((*source)->Read(idx)->has_value()) << idx;
  const auto ended = (*source)->Read(4);
  EXPECT_EQ(ended.status().code(), ErrorCode::kUnreadable);
  EXPECT_THAT(ended.status().message(), HasSubstr("cannot be decoded beyond its image 4, although more is sent"));
}

TEST_F(LiveSourceTest, ACopyOfTheLastImageIsNoImage) {
  SendFile(Video("clip.avi", {'M', 'J', 'P', 'G'}, {0, 1, 1, 2, 2}), "");
  auto source = LiveSource::Open(request_);
  ASSERT_TRUE(source.ok()) << source.status().message();
  EXPECT_EQ(ReadAll(**source), (std::vector<int>{0, 1, 1, 2})) << "one between others is";
  EXPECT_EQ((*source)->counts().received, 4);
  EXPECT_EQ((*source)->counts().damaged, 1);
}

TEST_F(LiveSourceTest, AnImageThatAConnectionCutsOffIsNoImage) {
  std::string stream = "HTTP/1.0 200 OK\r\nContent-Type: multipart/x-mixed-replace;boundary=next\r\n\r\n";
  for (int idx = 0; idx < 6; ++idx) {
    const std::string image = Jpeg(Gray(idx));
    stream += "--next\r\nContent-Type: image/jpeg\r\nContent-Length: " + std::to_string(image.size()) + "\r\n\r\n";
    stream += idx < 5 ? image + "\r\n" : image.substr(0, image.size() - 40);
  }
  const ServedBytes server(stream);
  request_.source = server.address();
  auto source = LiveSource::Open(request_);
  ASSERT_TRUE(source.ok()) << source.status().message();
  EXPECT_EQ(ReadAll(**source), (std::vector<int>{0, 1, 2, 3, 4}));
  EXPECT_EQ((*source)->counts().received, 5);
  EXPECT_EQ((*source)->counts().damaged, 1);
  EXPECT_EQ((*source)->counts().fps, kFps) << "by the calibration, where FFmpeg would invent one";
}

TEST_F(LiveSourceTest, SaysThatStandardInputEndsBeforeItsFirstImageIsWhole) {
  const auto refusal = [&](const std::string& bytes) {
    PipedVideo pipe;
    pipe.Write(bytes);
    pipe.Close();
    const auto source = LiveSource::Open(request_);
    EXPECT_EQ(source.status().code(), ErrorCode::kUnreadable);
    return source.status().message();
  };
  const std::string image = Jpeg(Gray(0));
  for (const std::string& begun : {image.substr(0, image.size() / 2), std::string("YUV4MPEG2 W6"),
                                   "YUV4MPEG2 W64 H48 F30:1\nFRAME\n" + std::string(100, 'x')})
    EXPECT_THAT(refusal(begun), HasSubstr("standard input ends within its first image"));
  EXPECT_THAT(refusal("YUV4MPEG2 W64 H48 F30:1\n"), HasSubstr("standard input ends before its first image"));
  EXPECT_THAT(refusal(""), HasSubstr("standard input is closed or empty"));
  const PipedVideo pipe;
  close(STDIN_FILENO);
  EXPECT_THAT(LiveSource::Open(request_).status().message(), HasSubstr("standard input is closed or empty"));
}

TEST_F(LiveSourceTest, SaysThatPhotographsChangeTheirSize) {
  const auto send = [&](int idx, cv::Size size) {
    cv::Mat image;
    cv::resize(Gray(idx), image, size);
    pipe_.Write(Jpeg(image));
  };
  for (int idx = 0; idx < 4; ++idx) send(idx, {kWidth, kHeight});
  for (int idx = 4; idx < 8; ++idx) send(idx, {kWidth / 2, kHeight / 2});
  pipe_.Close();
  auto source = LiveSource::Open(request_);
  ASSERT_TRUE(source.ok()) << source.status().message();
  for (int idx = 0; idx < 4; ++idx) {
    const auto image = (*source)->Read(idx);
    ASSERT_TRUE(image.ok() && image->has_value()) << idx;
    EXPECT_NEAR(cv::mean(**image)[0], 40 + 20 * idx, 3);
  }
  const auto changed = (*source)->Read(4);
  EXPECT_EQ(changed.status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(changed.status().message(), HasSubstr("change their size from"));
  EXPECT_THAT(changed.status().message(), HasSubstr("after 4 images"));
}

TEST_F(LiveSourceTest, SaysThatAPipeHasSentNothing) {
  request_.options.timeout_s = 0.5;
  const auto source = LiveSource::Open(request_);
  EXPECT_EQ(source.status().code(), ErrorCode::kUnreadable);
  EXPECT_THAT(source.status().message(), HasSubstr("standard input has sent no image for"));
  EXPECT_FALSE(std::filesystem::exists(Path("recording")));
}

TEST_F(LiveSourceTest, IsStoppedWhileItWaits) {
  std::atomic<bool> stop = false;
  request_.stop = &stop;
  pipe_.Header(kWidth, kHeight, kFps);
  Send(0, 1);
  auto source = LiveSource::Open(request_);
  ASSERT_TRUE(source.ok()) << source.status().message();
  ASSERT_TRUE((*source)->Read(0)->has_value());
  std::thread stopper([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    stop = true;
  });
  const auto begin = Clock::now();
  EXPECT_FALSE((*source)->Read(1)->has_value());
  source->reset();
  EXPECT_LT(std::chrono::duration<double>(Clock::now() - begin).count(), 3);
  stopper.join();
}

TEST_F(LiveSourceTest, WhatIsNoVideoIsRefusedAndLeavesNothing) {
  pipe_.Write("this is no video, whatever one makes of it\n");
  pipe_.Close();
  const auto source = LiveSource::Open(request_);
  EXPECT_EQ(source.status().code(), ErrorCode::kUnreadable);
  EXPECT_THAT(source.status().message(), HasSubstr("standard input is no video that can be decoded"));
  EXPECT_FALSE(std::filesystem::exists(Path("recording")));
}

TEST_F(LiveSourceTest, ACalibrationOfOtherImagesIsRefused) {
  WriteCamera("other.yaml", 128, 96);
  request_.camera_path = Path("other.yaml");
  SendVideo(2);
  const auto source = LiveSource::Open(request_);
  EXPECT_EQ(source.status().code(), ErrorCode::kMismatch);
  EXPECT_THAT(source.status().message(), HasSubstr("is for images of 128x96, but those of standard input are 64x48"));
  EXPECT_FALSE(std::filesystem::exists(Path("recording")));
}

TEST_F(LiveSourceTest, AnUnknownCameraIsAssumed) {
  request_.camera_path = AssumedCameraName(70);
  SendVideo(2);
  const auto source = LiveSource::Open(request_);
  ASSERT_TRUE(source.ok()) << source.status().message();
  EXPECT_THAT(LiveSource::Given(*source)->warnings, testing::ElementsAre(HasSubstr("the camera is not calibrated")));
}

TEST_F(LiveSourceTest, ARecordingThatCannotBeWrittenIsAnError) {
  Text("file", "");
  request_.recording_path = Path("file") / "recording";
  SendVideo(2);
  EXPECT_EQ(LiveSource::Open(request_).status().code(), ErrorCode::kUnwritable);
}

TEST_F(LiveSourceTest, TwoRunsDoNotRecordIntoOneFolder) {
  SendVideo(2);
  const auto source = LiveSource::Open(request_);
  ASSERT_TRUE(source.ok()) << source.status().message();
  PipedVideo other;
  other.Header(kWidth, kHeight, kFps);
  other.Image(Gray(0));
  other.Close();
  EXPECT_EQ(LiveSource::Open(request_).status().code(), ErrorCode::kUnwritable);
}

TEST_F(LiveSourceTest, CamerasThatAreNotThereAreNamed) {
  request_.source = "device:250";
  EXPECT_EQ(LiveSource::Open(request_).status().code(), ErrorCode::kNotFound);
  for (const char* wrong : {"device:", "device:x", "device:-1", "device:1000"}) {
    request_.source = wrong;
    EXPECT_EQ(LiveSource::Open(request_).status().code(), ErrorCode::kInvalidArgument) << wrong;
  }
  request_.source = "http://127.0.0.1:9/nothing";
  EXPECT_THAT(LiveSource::Open(request_).status().message(), HasSubstr("cannot be opened"));
}

}  // namespace
}  // namespace pliant
