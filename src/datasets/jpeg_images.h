// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The JPEG images in a stream of bytes that comes in pieces, one behind the other, with anything between them. An image
// is there with its last byte.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

namespace pliant {

class JpegImages {
 public:
  void Add(std::span<const unsigned char> bytes);
  // The next whole image, which may be damaged inside.
  std::optional<std::vector<unsigned char>> Take();
  // Images that are not whole, so far: their head is damaged, or another one begins within them.
  std::int64_t broken() const { return broken_; }
  // Whether an image has begun that has not ended.
  bool IsWithinImage() const { return at_ != At::kBetween; }

 private:
  enum class At { kBetween, kSegment, kPixels };

  void Add(unsigned char byte);
  void AddToSegment();
  void AddToPixels(unsigned char before, unsigned char byte);
  void Begin();
  void Drop();

  At at_ = At::kBetween;
  std::vector<unsigned char> image_;  // the one that has begun; between images, the byte before
  std::size_t segment_at_ = 0;        // in `image_`
  std::size_t skipped_ = 0;           // bytes of the segment that are still to come
  bool has_pixels_ = false;           // the image that has begun
  std::deque<std::vector<unsigned char>> whole_;
  std::int64_t broken_ = 0;
};

}  // namespace pliant
