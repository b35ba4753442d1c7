// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What is known of the frames of a video that were decoded before: enough to find one of them again without decoding
// all that lies before it, and to see that it is the same. Seeking alone is not exact in most containers.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace pliant {

// Of a sample of the image's bytes.
std::uint64_t DigestOf(const cv::Mat& image);

// Of one video file. May be used by several threads, and by several that decode the same file.
class VideoIndex {
 public:
  // Frame `idx` was grabbed; `recorded_ms` is its time by the container. Frames that are known already, or that leave a
  // gap behind the last known one, are passed over.
  void Add(int idx, double recorded_ms);
  // Frame `idx`, which was added, was decoded.
  void SetDigest(int idx, std::uint64_t digest);

  // Its time; nothing where it is not known, or not later than those before.
  std::optional<double> TimeMs(int idx) const;
  std::optional<std::uint64_t> Digest(int idx) const;

 private:
  struct Entry {
    std::optional<double> recorded_ms;
    std::optional<std::uint64_t> digest = {};
  };

  mutable std::mutex mutex_;
  std::vector<Entry> frames_;
  double latest_ms_ = -1;
};

}  // namespace pliant
