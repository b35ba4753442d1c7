// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// One image after the other from a camera, a stream over the network or standard input.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include "pliant/base/status.h"

namespace pliant {

class FrameGrabber {
 public:
  // Waits for the source's header. `is_stopped` is asked from several threads, and may become true at any time: then
  // this and Grab come to an end, at once for standard input, within the time-out otherwise.
  // Fails with kInvalidArgument, kNotFound, kUnreadable or kInterrupted.
  static Result<std::unique_ptr<FrameGrabber>> Open(const std::string& source, double timeout_s,
                                                    const std::function<bool()>& is_stopped);
  virtual ~FrameGrabber() = default;

  // Waits for the next image, 8-bit gray or BGR, all of one size; nothing at the source's end or where it fails. What
  // is cut off or cannot be decoded is left out and counted. To be called by one thread, as all that follow.
  std::optional<cv::Mat> Grab();
  // Once Grab has given nothing: Ok at the source's end, else why no image comes. Fails with kUnreadable or kMismatch
  // (another size).
  const Status& status() const { return status_; }
  // What was left out.
  std::int64_t damaged() const { return damaged_; }
  // Images a second, where the source says it.
  virtual std::optional<double> fps() const = 0;

 protected:
  explicit FrameGrabber(std::string source) : source_(std::move(source)) {}

  // Waits for the next image, of any size.
  virtual std::optional<cv::Mat> Next() = 0;

  const std::string& source() const { return source_; }
  int images() const { return images_; }  // that Grab has given
  void Fail(Status status) { status_ = std::move(status); }
  void CountDamaged(std::int64_t images) { damaged_ += images; }

 private:
  std::string source_;
  cv::Size size_;
  int images_ = 0;
  std::int64_t damaged_ = 0;
  Status status_ = Status::Ok();
};

}  // namespace pliant
