// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/jpeg_images.h"

#include <utility>

namespace pliant {
namespace {

// Markers of ITU-T T.81, table B.1, each behind a byte 0xFF.
constexpr unsigned char kMark = 0xFF;
constexpr unsigned char kHuffmanTables = 0xC4;
constexpr unsigned char kStartOfImage = 0xD8;
constexpr unsigned char kEndOfImage = 0xD9;
constexpr unsigned char kStartOfScan = 0xDA;
constexpr unsigned char kQuantizationTables = 0xDB;
constexpr std::size_t kMarkerBytes = 2;
constexpr std::size_t kMaxImageBytes = 256 << 20;  // no image that is decoded (kMaxImageMegapixels) has as many

// Between the scans of one image. Other markers there are damage.
bool BeginsSegmentBetweenScans(unsigned char marker) {
  return marker == kHuffmanTables || marker == kStartOfScan || marker == kQuantizationTables;
}

}  // namespace

void JpegImages::Begin() {
  image_ = {kMark, kStartOfImage};
  at_ = At::kSegment;
  segment_at_ = image_.size();
  skipped_ = 0;
  has_pixels_ = false;
}

void JpegImages::Drop() {
  image_.clear();
  at_ = At::kBetween;
  ++broken_;
}

// `image_` has got another byte.
void JpegImages::AddToSegment() {
  const std::size_t size = image_.size() - segment_at_;
  if (image_[segment_at_] != kMark) return Drop();
  if (size < 2) return;
  const unsigned char marker = image_[segment_at_ + 1];
  if (size == 2 && marker == kMark) image_.pop_back();  // it may be filled with them
  if (size == 2 && marker == kStartOfImage) {
    ++broken_;
    return Begin();
  }
  if (size < 4 && marker == kEndOfImage) return Drop();
  if (size < 4) return;
  const std::size_t length = std::size_t{image_[segment_at_ + 2]} << 8 | std::size_t{image_[segment_at_ + 3]};
  if (length < 2) return Drop();
  skipped_ = kMarkerBytes + length - size;
  has_pixels_ = has_pixels_ || marker == kStartOfScan;
  at_ = has_pixels_ ? At::kPixels : At::kSegment;
  segment_at_ = image_.size() + skipped_;
}

// `image_` has got `byte` behind `before`. A coded pixel is never 0xFF with a marker behind it.
void JpegImages::AddToPixels(unsigned char before, unsigned char byte) {
  if (before != kMark) return;
  if (byte == kStartOfImage) {
    ++broken_;
    Begin();
  } else if (byte == kEndOfImage) {
    whole_.push_back(std::exchange(image_, {}));
    at_ = At::kBetween;
  } else if (BeginsSegmentBetweenScans(byte)) {
    segment_at_ = image_.size() - kMarkerBytes;
    at_ = At::kSegment;
  }
}

void JpegImages::Add(unsigned char byte) {
  const unsigned char before = image_.empty() ? 0 : image_.back();
  if (at_ == At::kBetween) {
    image_.assign(1, byte);
    if (before == kMark && byte == kStartOfImage) Begin();
    return;
  }
  image_.push_back(byte);
  if (image_.size() > kMaxImageBytes) return Drop();
  if (skipped_ > 0)
    --skipped_;
  else if (at_ == At::kSegment)
    AddToSegment();
  else
    AddToPixels(before, byte);
}

void JpegImages::Add(std::span<const unsigned char> bytes) {
  for (const unsigned char byte : bytes) Add(byte);
}

std::optional<std::vector<unsigned char>> JpegImages::Take() {
  if (whole_.empty()) return std::nullopt;
  std::vector<unsigned char> image = std::move(whole_.front());
  whole_.pop_front();
  return image;
}

}  // namespace pliant
