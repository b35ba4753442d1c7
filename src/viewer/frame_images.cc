// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/frame_images.h"

#include <utility>

#include "pliant/datasets/open_sequence.h"

namespace pliant {

Result<FrameImages> FrameImages::Open(const View& view, int first_frame_idx) {
  FrameImages images;
  if (!view.sequence) return images;
  SequenceRequest request = *view.sequence;
  request.start = first_frame_idx;
  auto sequence = OpenSequence(request);
  if (!sequence.ok()) return sequence.status();
  images.sequence_ = *std::move(sequence);
  return images;
}

Result<cv::Mat> FrameImages::At(int frame_idx) {
  while (sequence_ && last_idx_ < frame_idx) {
    auto frame = sequence_->Next();
    if (!frame.ok()) return frame.status();
    if (!frame->has_value()) break;
    last_idx_ = (*frame)->frame_idx;
    if (last_idx_ == frame_idx) return (*frame)->image;
  }
  return cv::Mat();
}

}  // namespace pliant
