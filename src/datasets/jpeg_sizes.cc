// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/jpeg_sizes.h"

#include <algorithm>

namespace pliant {
namespace {

// Markers of ITU-T T.81, table B.1, each behind a byte 0xFF.
constexpr unsigned char kMark = 0xFF;
constexpr unsigned char kStartOfImage = 0xD8;
constexpr unsigned char kStartOfScan = 0xDA;
constexpr std::size_t kMarkerBytes = 2;
constexpr std::size_t kFrameHeadBytes = 9;  // marker, length, precision, height, width

// SOF0 to SOF15, but for the three markers among them that hold tables.
bool BeginsFrame(unsigned char marker) {
  return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}

int BigEndian(unsigned char high, unsigned char low) { return high << 8 | low; }

}  // namespace

// `read_` has got another byte.
void JpegSizes::AddToSegment() {
  if (read_[0] != kMark) at_ = At::kPixels;  // damaged: on to the next image
  if (read_.size() == 2 && read_[1] == kMark) read_.pop_back();
  if (at_ != At::kSegment || read_.size() < 4) return;
  if (BeginsFrame(read_[1])) {
    if (read_.size() < kFrameHeadBytes) return;
    const cv::Size size(BigEndian(read_[7], read_[8]), BigEndian(read_[5], read_[6]));
    if (images_ > 0 && size != size_) change_ = Change{size_, size, images_};
    size_ = size;
    ++images_;
  }
  if (read_[1] == kStartOfScan) at_ = At::kPixels;
  const std::size_t end = kMarkerBytes + static_cast<std::size_t>(BigEndian(read_[2], read_[3]));
  skipped_ = end - std::min(end, read_.size());
  read_.clear();
}

void JpegSizes::Add(unsigned char byte) {
  if (skipped_ > 0) {
    --skipped_;
    return;
  }
  if (at_ == At::kSegment) {
    read_.push_back(byte);
    AddToSegment();
    return;
  }
  // A coded pixel is never 0xFF with this behind it.
  const bool begins_image = !read_.empty() && read_[0] == kMark && byte == kStartOfImage;
  read_.assign(1, byte);
  if (!begins_image) return;
  at_ = At::kSegment;
  read_.clear();
}

std::size_t JpegSizes::BytesBeforeChange(std::span<const unsigned char> bytes) {
  if (change_) return 0;
  if (at_ == At::kBegin && !bytes.empty()) at_ = bytes[0] == kMark ? At::kPixels : At::kOther;
  if (at_ == At::kOther) return bytes.size();
  std::size_t image_at = 0;  // in `bytes`
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const At before = at_;
    Add(bytes[i]);
    if (before != At::kSegment && at_ == At::kSegment) image_at = i == 0 ? 0 : i - 1;
    if (change_) return image_at;
  }
  return bytes.size();
}

}  // namespace pliant
