// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/frame_grabber.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include <unistd.h>

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
constexpr double kMaxFps = 1000;  // rates from there on are the unit of the stream's times
constexpr int kMaxDevice = 255;   // Video4Linux has no more

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

std::string CannotBeDecoded(const std::string& source) {
  if (source == "-")
    return "standard input is no video that can be decoded, or ends before its first image; pipe one into the "
           "program, as in ffmpeg -i VIDEO -f yuv4mpegpipe - | pliant track -";
  if (source.starts_with(kDevice))
    return "the camera " + Quoted(source) + " cannot be read; check that no other program uses it";
  return "the stream " + Quoted(source) + " cannot be opened; check its address, and that it is being sent";
}

// Of standard input.
Status SentNothing(double timeout_s) {
  return {ErrorCode::kUnreadable, "standard input has sent no image for " + Digits(timeout_s, 0) +
                                      " s; check it, or wait longer with LiveInput.timeout_s"};
}

}  // namespace

Result<std::unique_ptr<FrameGrabber>> FrameGrabber::Open(const std::string& source, double timeout_s,
                                                         const std::function<bool()>& is_stopped) {
  std::unique_ptr<FrameGrabber> grabber(new FrameGrabber);
  grabber->timeout_s_ = timeout_s;
  grabber->is_stopped_ = is_stopped;
  if (source == "-") {
    auto input = StandardInput::Open(timeout_s, is_stopped);
    if (!input.ok()) return input.status();
    grabber->standard_input_ = *std::move(input);
  }
  Status opened = Status::Ok();
  try {
    opened = grabber->OpenCapture(source, timeout_s);
  } catch (const cv::Exception&) {
    opened = Status(ErrorCode::kUnreadable, CannotBeDecoded(source));
  }
  if (is_stopped()) return Status(ErrorCode::kInterrupted, "stopped on request before the first image");
  if (!opened.ok() && grabber->standard_input_ && grabber->standard_input_->has_stalled())
    return SentNothing(timeout_s);
  if (!opened.ok()) return opened;
  const cv::Size size(static_cast<int>(grabber->capture_.get(cv::CAP_PROP_FRAME_WIDTH)),
                      static_cast<int>(grabber->capture_.get(cv::CAP_PROP_FRAME_HEIGHT)));
  if (size.area() != 0)  // a stream need not know it
    if (Status status =
            CheckPixels(size, source == "-" ? "the video on standard input" : "the stream " + Quoted(source));
        !status.ok())
      return status;
  const double fps = grabber->capture_.get(cv::CAP_PROP_FPS);
  if (std::isfinite(fps) && fps > 0 && fps < kMaxFps) grabber->fps_ = fps;
  return grabber;
}

Status FrameGrabber::OpenCapture(const std::string& source, double timeout_s) {
  is_device_ = source.starts_with(kDevice);
  if (is_device_) {
    const auto number = DeviceNumber(source);
    if (!number.ok()) return number.status();
    if (Status status = CheckDevice(*number); !status.ok()) return status;
    capture_.open(*number, cv::CAP_V4L2);
  } else {
    const std::string address = standard_input_ ? "pipe:" + std::to_string(standard_input_->descriptor()) : source;
    // Standard input ends by itself, and may wait for as long as tracking takes.
    const int timeout_ms = standard_input_ ? 1000000000 : static_cast<int>(1000 * timeout_s);
    capture_.open(address, cv::CAP_FFMPEG,
                  {cv::CAP_PROP_OPEN_TIMEOUT_MSEC, timeout_ms, cv::CAP_PROP_READ_TIMEOUT_MSEC, timeout_ms});
  }
  return capture_.isOpened() ? Status::Ok() : Status(ErrorCode::kUnreadable, CannotBeDecoded(source));
}

std::optional<cv::Mat> FrameGrabber::Decode() {
  try {
    cv::Mat decoded;
    if (capture_.read(decoded) && !decoded.empty() && decoded.depth() == CV_8U)
      return decoded.clone();  // the decoder reuses its own memory
  } catch (const cv::Exception&) {
    // As a packet that cannot be decoded.
  }
  return std::nullopt;
}

// A decoder that waited in vain gives the images that it has held back, as if they had come, and then says no more than
// one whose stream has ended.
std::optional<cv::Mat> FrameGrabber::Grab() {
  const auto begin = Clock::now();
  int damaged = 0;
  do {
    const auto asked = Clock::now();
    auto image = Decode();
    if (SecondsSince(asked) > kMostOfTheTimeout * timeout_s_) since_long_wait_ = 0;
    if (image) {
      damaged_ += is_device_ ? 0 : damaged;
      since_long_wait_ = std::min(since_long_wait_ + 1, kMaxHeldBack + 1);
      return image;
    }
    if (is_device_) std::this_thread::sleep_for(kPauseOfDevice);
  } while (!is_stopped_() && SecondsSince(begin) < kMostOfTheTimeout * timeout_s_ &&
           (is_device_ || ++damaged <= kMaxDamaged));
  if (standard_input_)
    has_stalled_ = standard_input_->has_stalled();
  else  // a camera has no end
    has_stalled_ = SecondsSince(begin) > kMostOfTheTimeout * timeout_s_ || since_long_wait_ <= kMaxHeldBack;
  return std::nullopt;
}

}  // namespace pliant
