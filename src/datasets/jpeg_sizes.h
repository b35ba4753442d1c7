// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The sizes of the JPEG images in a stream of bytes: OpenCV decodes all of a video in the size of its first image, and
// what it gives of others is no image.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <opencv2/core/types.hpp>

namespace pliant {

class JpegSizes {
 public:
  struct Change {
    cv::Size from, to;
    int images = 0;  // before it
  };

  // How many of the next bytes come before the first image of another size. The stream's first byte decides whether it
  // consists of JPEG images; in any other one all count.
  std::size_t BytesBeforeChange(std::span<const unsigned char> bytes);
  // The first one.
  const std::optional<Change>& change() const { return change_; }

 private:
  enum class At { kBegin, kSegment, kPixels, kOther };

  void Add(unsigned char byte);
  void AddToSegment();

  At at_ = At::kBegin;
  std::vector<unsigned char> read_;  // of the segment, or the byte before
  std::size_t skipped_ = 0;          // bytes that are still to be passed over
  cv::Size size_;
  int images_ = 0;
  std::optional<Change> change_;
};

}  // namespace pliant
