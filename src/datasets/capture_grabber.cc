// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/capture_grabber.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <unistd.h>

#include "datasets/image_file.h"
#include "datasets/stream_errors.h"
#include "image/image_size.h"
#include "pliant/base/options.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

constexpr std::string_view kDevice = "device:";
using Clock = std::chrono::steady_clock;

constexpr double kMostOfTheTimeout = 0.9;
constexpr int kMaxDamaged = 100;  // packets in a row: a decoder says no more of one than of the stream's end
constexpr int kMaxHeldBack = 64;  // images: those that are coded before earlier ones, and one a thread of a decoder
constexpr auto kPauseOfDevice = std::chrono::milliseconds(20);
constexpr double kMaxFps = 1000;     // rates from there on are the unit of the stream's times
constexpr double kFpsOfNobody = 25;  // FFmpeg's word for JPEG images that come without a rate
constexpr int kMaxDevice = 255;      // Video4Linux has no more

double SecondsSince(Clock::time_point time) { return std::chrono::duration<double>(Clock::now() - time).count(); }

Result<int> DeviceNumber(std::string_view source) {
  int number = -1;
  if (ParseInt(source.substr(kDevice.size()), &number) && number >= 0 && number <= kMaxDevice) return number;
  return Status(ErrorCode::kInvalidArgument, Quoted(source) + " names no camera; write device:0 for /dev/video0");
}

Status CheckDevice(int number) {
  const std::string file = "/dev/video" + std::to_string(number);
  std::error_code error;
  if (!std::filesystem::exists(file, error))
    return {ErrorCode::kNotFound, "there is no camera " + file + "; plug it in, or name another device"};
  if (access(file.c_str(), R_OK | W_OK) != 0)
    return {ErrorCode::kUnreadable,
            "the camera " + file + " may not be opened; add yourself to the group that owns it, often video"};
  return Status::Ok();
}

// Both are continuous.
bool AreEqual(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && std::memcmp(a.data, b.data, a.total() * a.elemSize()) == 0;
}

}  // namespace

CaptureGrabber::CaptureGrabber(const std::string& source, double timeout_s, std::function<bool()> is_stopped)
    : FrameGrabber(source),
      timeout_s_(timeout_s),
      is_stopped_(std::move(is_stopped)),
      is_device_(source.starts_with(kDevice)) {}

Result<std::unique_ptr<FrameGrabber>> CaptureGrabber::Open(const std::string& source, double timeout_s,
                                                           const std::function<bool()>& is_stopped) {
  std::unique_ptr<CaptureGrabber> grabber(new CaptureGrabber(source, timeout_s, is_stopped));
  if (Status status = grabber->OpenCapture(); !status.ok()) return status;
  return std::unique_ptr<FrameGrabber>(std::move(grabber));
}

Result<std::unique_ptr<FrameGrabber>> CaptureGrabber::OpenPiped(std::unique_ptr<StandardInput> input,
                                                                std::span<const unsigned char> begin, double timeout_s,
                                                                const std::function<bool()>& is_stopped) {
  std::unique_ptr<CaptureGrabber> grabber(new CaptureGrabber("-", timeout_s, is_stopped));
  grabber->input_ = std::move(input);
  auto pipe = DecoderPipe::Open(grabber->input_.get(), begin, is_stopped);
  if (!pipe.ok()) return pipe.status();
  grabber->pipe_ = *std::move(pipe);
  if (Status status = grabber->OpenCapture(); !status.ok()) {
    const Status of_input = grabber->EndOfPipe();
    return of_input.ok() ? status : of_input;
  }
  return std::unique_ptr<FrameGrabber>(std::move(grabber));
}

Status CaptureGrabber::OpenCapture() {
  try {
    if (is_device_) {
      const auto number = DeviceNumber(source());
      if (!number.ok()) return number.status();
      if (Status status = CheckDevice(*number); !status.ok()) return status;
      capture_.open(*number, cv::CAP_V4L2);
    } else {
      const std::string address = pipe_ ? "pipe:" + std::to_string(pipe_->descriptor()) : source();
      // Standard input ends by itself, and may wait for as long as tracking takes.
      const int timeout_ms = pipe_ ? 1000000000 : static_cast<int>(1000 * timeout_s_);
      capture_.open(address, cv::CAP_FFMPEG,
                    {cv::CAP_PROP_OPEN_TIMEOUT_MSEC, timeout_ms, cv::CAP_PROP_READ_TIMEOUT_MSEC, timeout_ms});
    }
    if (!capture_.isOpened()) return CannotBeDecoded(source());
    const cv::Size size(static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_WIDTH)),
                        static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_HEIGHT)));
    if (size.area() != 0)  // a stream need not know it
      if (Status status = CheckPixels(size, pipe_ ? "the video on standard input" : "the stream " + Quoted(source()));
          !status.ok())
        return status;
    const double fps = capture_.get(cv::CAP_PROP_FPS);
    if (std::isfinite(fps) && fps > 0 && fps < kMaxFps) fps_ = fps;
    if (!is_device_) FollowJpegs();
  } catch (const cv::Exception&) {
    return CannotBeDecoded(source());
  }
  may_repeat_ = !is_device_ && !gives_jpegs_ && !(pipe_ && pipe_->PassesWholeFrames());
  return Status::Ok();
}

// A stream of bare JPEG images, as those of network cameras, is decoded here: FFmpeg fills the rest of one that is cut
// off from the image before, and gives each one when later ones have come.
void CaptureGrabber::FollowJpegs() {
  const int bare_jpeg = cv::VideoWriter::fourcc('m', 'j', 'p', 'e');  // FFmpeg's name; containers have other codes
  if (static_cast<int>(capture_.get(cv::CAP_PROP_FOURCC)) != bare_jpeg) return;
  gives_jpegs_ = capture_.set(cv::CAP_PROP_FORMAT, -1);
  if (fps_ == kFpsOfNobody) fps_.reset();
}

std::optional<cv::Mat> CaptureGrabber::Decode() {
  try {
    cv::Mat decoded;
    while (capture_.read(decoded) && !decoded.empty() && decoded.depth() == CV_8U) {
      if (!gives_jpegs_) return decoded.clone();  // the decoder reuses its own memory
      auto image = DecodeImage(std::vector<unsigned char>(decoded.datastart, decoded.dataend), "an image");
      if (image.ok()) return *std::move(image);
      CountDamaged(1);
      if (is_stopped_()) break;
    }
  } catch (const cv::Exception&) {
    // As a packet that cannot be decoded.
  }
  return std::nullopt;
}

// A decoder that waited in vain gives the images that it has held back, as if they had come, and then says no more than
// one whose stream has ended.
std::optional<cv::Mat> CaptureGrabber::Wait() {
  const auto begin = Clock::now();
  int damaged = 0;
  do {
    const auto asked = Clock::now();
    auto image = Decode();
    if (SecondsSince(asked) > kMostOfTheTimeout * timeout_s_) since_long_wait_ = 0;
    if (image) {
      CountDamaged(is_device_ ? 0 : damaged);
      gave_up_ = false;
      since_long_wait_ = std::min(since_long_wait_ + 1, kMaxHeldBack + 1);
      return image;
    }
    gave_up_ = gave_up_ || (pipe_ && pipe_->HasMore());
    if (is_device_) std::this_thread::sleep_for(kPauseOfDevice);
  } while (!is_stopped_() && SecondsSince(begin) < kMostOfTheTimeout * timeout_s_ &&
           (is_device_ || ++damaged <= kMaxDamaged));
  if (!is_stopped_()) Fail(pipe_ ? EndOfPipe() : EndOfStream(SecondsSince(begin)));
  if (pipe_ && pipe_->EndsWithinFrame()) CountDamaged(1);
  return std::nullopt;
}

// A camera has no end.
Status CaptureGrabber::EndOfStream(double waited_s) const {
  const bool has_stalled = waited_s > kMostOfTheTimeout * timeout_s_ || since_long_wait_ <= kMaxHeldBack;
  return has_stalled ? SentNothing(source(), timeout_s_) : Status::Ok();
}

Status CaptureGrabber::EndOfPipe() const {
  if (gave_up_ && images() > 0)
    return {ErrorCode::kUnreadable, "the video on standard input cannot be decoded beyond its image " +
                                        std::to_string(images()) +
                                        ", although more is sent; send it as ffmpeg -f yuv4mpegpipe does"};
  if (input_->has_stalled()) return SentNothing(source(), timeout_s_);
  return pipe_->EndsWithinFirstFrame() ? EndsWithinFirstImage(source()) : pipe_->status();
}

// An image that is cut off may come as a copy of the one before. So a copy is no image until another one follows.
std::optional<cv::Mat> CaptureGrabber::Next() {
  std::optional<cv::Mat> image = ahead_ ? std::exchange(ahead_, std::nullopt) : Wait();
  if (!image || !may_repeat_) return image;
  if (last_ && AreEqual(*image, *last_)) {
    ahead_ = Wait();
    if (!ahead_) CountDamaged(1);
    if (!ahead_) return std::nullopt;
  }
  last_ = image;
  return image;
}

}  // namespace pliant
