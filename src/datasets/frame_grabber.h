// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// One image after the other from a camera, a stream over the network or standard input, through OpenCV.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <opencv2/core/mat.hpp>
#include <opencv2/videoio.hpp>

#include "datasets/standard_input.h"
#include "pliant/base/status.h"

namespace pliant {

class FrameGrabber {
 public:
  // Waits for the source's header. `is_stopped` is asked from several threads, and may become true at any time: then
  // this and Grab come to an end, at once for standard input, within the time-out otherwise.
  // Fails with kNotFound, kUnreadable or kInterrupted.
  static Result<std::unique_ptr<FrameGrabber>> Open(const std::string& source, double timeout_s,
                                                    const std::function<bool()>& is_stopped);

  // Waits for the next image, 8-bit BGR; nothing at the source's end, where it stalls, or before a change of size. What
  // cannot be decoded is left out and counted. To be called by one thread, as all that follow.
  std::optional<cv::Mat> Grab();
  // Whether Grab has waited in vain, so that it gives nothing.
  bool has_stalled() const { return has_stalled_; }
  // Why Grab gives nothing more: the images of standard input, as a sequence of JPEG, change their size there.
  std::optional<JpegSizes::Change> size_change() const {
    return standard_input_ ? standard_input_->size_change() : std::nullopt;
  }
  // What could not be decoded.
  std::int64_t damaged() const { return damaged_; }
  // Images a second, where the source says it.
  std::optional<double> fps() const { return fps_; }

 private:
  FrameGrabber() = default;
  Status OpenCapture(const std::string& source, double timeout_s);
  std::optional<cv::Mat> Decode();

  std::unique_ptr<StandardInput> standard_input_;  // outlives the capture that reads it
  cv::VideoCapture capture_;
  std::optional<double> fps_;
  double timeout_s_ = 0;
  std::function<bool()> is_stopped_;
  bool is_device_ = false;
  bool has_stalled_ = false;
  std::int64_t damaged_ = 0;
  int since_long_wait_ = 1 << 20;  // images since one, or the end, was waited for about as long as the time-out
};

}  // namespace pliant
