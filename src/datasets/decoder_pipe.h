// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A pipe of our own, from standard input to a decoder, which waits for its input without end: it is closed when nothing
// more is to be waited for.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "datasets/standard_input.h"
#include "datasets/y4m_frames.h"
#include "pliant/base/status.h"

namespace pliant {

class DecoderPipe {
 public:
  // Passes on `begin`, which was read already, and what `input` gives; of a YUV4MPEG video whole frames. `input` is
  // read by another thread as long as this lives, and `is_stopped` asked. Fails with kUnreadable.
  static Result<std::unique_ptr<DecoderPipe>> Open(StandardInput* input, std::span<const unsigned char> begin,
                                                   std::function<bool()> is_stopped);
  ~DecoderPipe();
  DecoderPipe(const DecoderPipe&) = delete;
  DecoderPipe& operator=(const DecoderPipe&) = delete;

  int descriptor() const { return read_end_; }
  // Whether frames are whole, since a YUV4MPEG video is passed on.
  bool PassesWholeFrames() const { return y4m_.has_value(); }
  // Whether there is something, or may be, that the decoder has not read.
  bool HasMore() const;

  // The following are known when HasMore is false, or the pipe has ended before standard input.
  // Why it has, where the video is at fault (Y4mFrames).
  Status status() const { return has_ended_ ? status_ : Status::Ok(); }
  // Whether the video, else in order, ends within a frame, and whether that is its first one.
  bool EndsWithinFrame() const { return has_ended_ && y4m_ && status_.ok() && y4m_->IsWithinFrame(); }
  bool EndsWithinFirstFrame() const { return EndsWithinFrame() && y4m_->frames() == 0; }

 private:
  DecoderPipe() = default;
  void PassOn(StandardInput* input, const std::vector<unsigned char>& begin, const std::function<bool()>& is_stopped);
  // False: the decoder reads no more, or it is to be stopped.
  bool Write(std::span<const unsigned char> bytes, const std::function<bool()>& is_stopped) const;

  int read_end_ = -1;
  int write_end_ = -1;
  std::optional<Y4mFrames> y4m_;  // it and `status_` are of the thread until the pipe has ended
  Status status_ = Status::Ok();
  std::atomic<bool> has_ended_ = false;
  std::atomic<bool> is_closing_ = false;
  std::thread thread_;
};

}  // namespace pliant
