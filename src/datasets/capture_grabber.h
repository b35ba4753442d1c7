// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Images through OpenCV: of a camera, of a stream over the network, and of the videos on standard input that it
// decodes.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <opencv2/core/mat.hpp>
#include <opencv2/videoio.hpp>

#include "datasets/decoder_pipe.h"
#include "datasets/frame_grabber.h"
#include "datasets/standard_input.h"
#include "pliant/base/status.h"

namespace pliant {

class CaptureGrabber final : public FrameGrabber {
 public:
  // Both as FrameGrabber::Open.
  static Result<std::unique_ptr<FrameGrabber>> Open(const std::string& source, double timeout_s,
                                                    const std::function<bool()>& is_stopped);
  // `begin` is what `input` gave first.
  static Result<std::unique_ptr<FrameGrabber>> OpenPiped(std::unique_ptr<StandardInput> input,
                                                         std::span<const unsigned char> begin, double timeout_s,
                                                         const std::function<bool()>& is_stopped);

  std::optional<double> fps() const override { return fps_; }

 private:
  CaptureGrabber(const std::string& source, double timeout_s, std::function<bool()> is_stopped);
  Status OpenCapture();
  void FollowJpegs();
  std::optional<cv::Mat> Next() override;
  std::optional<cv::Mat> Wait();
  std::optional<cv::Mat> Decode();
  // Why nothing more comes; Ok at the end.
  Status EndOfStream(double waited_s) const;
  Status EndOfPipe() const;

  std::unique_ptr<StandardInput> input_;  // null: another source; it outlives the pipe
  std::unique_ptr<DecoderPipe> pipe_;     // which outlives the capture that reads it
  cv::VideoCapture capture_;
  std::optional<double> fps_;
  double timeout_s_;
  std::function<bool()> is_stopped_;
  bool is_device_;
  bool gives_jpegs_ = false;     // the capture, instead of images
  bool may_repeat_ = false;      // the decoder, where an image is cut off
  bool gave_up_ = false;         // the decoder, since its last image, although the pipe had more
  std::optional<cv::Mat> last_;  // where it may repeat
  std::optional<cv::Mat> ahead_;
  int since_long_wait_ = 1 << 20;  // images since one, or the end, was waited for about as long as the time-out
};

}  // namespace pliant
