// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/frame_grabber.h"

#include <utility>

#include "datasets/capture_grabber.h"
#include "datasets/piped_jpegs.h"
#include "datasets/standard_input.h"
#include "datasets/stream_errors.h"

namespace pliant {
namespace {

constexpr unsigned char kBeginOfJpeg = 0xFF;

// The first byte says what standard input is.
Result<std::unique_ptr<FrameGrabber>> OpenPiped(double timeout_s, const std::function<bool()>& is_stopped) {
  auto input = StandardInput::Open(timeout_s);
  if (!input.ok()) return input.status();
  const auto begin = (*input)->Read(is_stopped);
  if ((*input)->has_stalled()) return SentNothing("-", timeout_s);
  if (begin.empty()) return StandardInputIsEmpty();
  if (begin.front() == kBeginOfJpeg)
    return std::unique_ptr<FrameGrabber>(new PipedJpegs(*std::move(input), begin, timeout_s, is_stopped));
  return CaptureGrabber::OpenPiped(*std::move(input), begin, timeout_s, is_stopped);
}

}  // namespace

Result<std::unique_ptr<FrameGrabber>> FrameGrabber::Open(const std::string& source, double timeout_s,
                                                         const std::function<bool()>& is_stopped) {
  auto grabber = source == "-" ? OpenPiped(timeout_s, is_stopped) : CaptureGrabber::Open(source, timeout_s, is_stopped);
  if (is_stopped()) return Status(ErrorCode::kInterrupted, "stopped on request before the first image");
  return grabber;
}

std::optional<cv::Mat> FrameGrabber::Grab() {
  std::optional<cv::Mat> image = status_.ok() ? Next() : std::nullopt;
  if (!image) return std::nullopt;
  if (images_ > 0 && image->size() != size_) {
    Fail(ChangesSize(source_, size_, image->size(), images_));
    return std::nullopt;
  }
  size_ = image->size();
  ++images_;
  return image;
}

}  // namespace pliant
