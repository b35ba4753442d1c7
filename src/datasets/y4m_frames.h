// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The frames of a raw video (YUV4MPEG2, https://wiki.multimedia.cx/index.php/YUV4MPEG2) in a stream of bytes that comes
// in pieces. A decoder gives whole frames alone: one that is cut off would be an image of chance, and what follows a
// damaged marker the video's end. A second video behind the first one belongs to it where it is of the same kind.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <opencv2/core/types.hpp>

#include "pliant/base/status.h"

namespace pliant {

class Y4mFrames {
 public:
  // `source` is named in errors.
  explicit Y4mFrames(std::string source) : source_(std::move(source)) {}

  // Takes the next bytes. Fails with kUnreadable where there is no header or frame, or a pixel format that is not
  // decoded, and with kMismatch where size or format change; nothing may be added after that.
  Status Add(std::span<const unsigned char> bytes);
  // What a decoder may read of what was added: the first header, and whole frames. Once.
  std::vector<unsigned char> TakeWhole();

  int frames() const { return frames_; }  // whole ones
  // Whether a header or a frame has begun that has not ended.
  bool IsWithinFrame() const { return !rest_.empty(); }

 private:
  // What all frames have.
  struct Kind {
    cv::Size size;
    std::string format;
    std::size_t bytes = 0;  // of a frame's pixels
  };

  // What begins at the beginning of `rest`: how many bytes it has; 0: it is not whole.
  Result<std::size_t> TakeHeader(std::string_view rest);
  Result<std::size_t> TakeFrame(std::string_view rest);
  Result<Kind> KindOf(std::string_view header) const;
  Status CheckSame(const Kind& kind) const;
  Status Damaged() const;

  std::string source_;
  std::optional<Kind> kind_;
  int frames_ = 0;
  std::vector<unsigned char> rest_;   // that is not whole yet
  std::vector<unsigned char> whole_;  // that was not taken yet
};

}  // namespace pliant
