// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/video_index.h"

#include <cstddef>

namespace pliant {
namespace {

// FNV-1a, 64 bits.
constexpr std::uint64_t kOffset = 14695981039346656037U;
constexpr std::uint64_t kPrime = 1099511628211U;
// Bytes from one that is looked at to the next: a prime, so that they are of all columns and channels.
constexpr std::size_t kStep = 61;

}  // namespace

std::uint64_t DigestOf(const cv::Mat& image) {
  std::uint64_t digest = kOffset;
  const std::size_t row_bytes = static_cast<std::size_t>(image.cols) * image.elemSize();
  std::size_t column = 0;
  for (int row = 0; row < image.rows; ++row) {
    const std::uint8_t* bytes = image.ptr(row);
    for (; column < row_bytes; column += kStep) digest = (digest ^ bytes[column]) * kPrime;
    column -= row_bytes;
  }
  return digest;
}

void VideoIndex::Add(int idx, double recorded_ms) {
  const std::lock_guard lock(mutex_);
  if (idx != static_cast<int>(frames_.size())) return;
  const bool is_later = recorded_ms > latest_ms_;
  frames_.push_back({is_later ? std::optional(recorded_ms) : std::nullopt});
  if (is_later) latest_ms_ = recorded_ms;
}

void VideoIndex::SetDigest(int idx, std::uint64_t digest) {
  const std::lock_guard lock(mutex_);
  if (idx < static_cast<int>(frames_.size())) frames_[static_cast<std::size_t>(idx)].digest = digest;
}

std::optional<double> VideoIndex::TimeMs(int idx) const {
  const std::lock_guard lock(mutex_);
  if (idx < 0 || idx >= static_cast<int>(frames_.size())) return std::nullopt;
  return frames_[static_cast<std::size_t>(idx)].recorded_ms;
}

std::optional<std::uint64_t> VideoIndex::Digest(int idx) const {
  const std::lock_guard lock(mutex_);
  if (idx < 0 || idx >= static_cast<int>(frames_.size())) return std::nullopt;
  return frames_[static_cast<std::size_t>(idx)].digest;
}

}  // namespace pliant
