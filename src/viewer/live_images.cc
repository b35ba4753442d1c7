// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/live_images.h"

#include <chrono>
#include <iterator>

#include "pliant/base/parallel.h"
#include "viewer/view_images.h"

namespace pliant {
namespace {

constexpr std::chrono::milliseconds kBetweenImages(100);

}  // namespace

LiveImages::LiveImages(int width_px, int quality, double max_mb)
    : width_px_(width_px), quality_(quality), max_mb_(max_mb), thread_([this] { Run(); }) {}

LiveImages::~LiveImages() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void LiveImages::Add(int frame_idx, const cv::Mat& image) {
  {
    const std::lock_guard lock(mutex_);
    next_ = {frame_idx, image};
  }
  changed_.notify_all();
}

std::string LiveImages::At(int frame_idx) const {
  const std::lock_guard lock(mutex_);
  const auto found = jpeg_.find(frame_idx);
  return found != jpeg_.end() ? found->second : std::string();
}

std::vector<int> LiveImages::Frames() const {
  const std::lock_guard lock(mutex_);
  std::vector<int> frames;
  for (const auto& [frame_idx, jpeg] : jpeg_) frames.push_back(frame_idx);
  return frames;
}

double LiveImages::scale() const {
  const std::lock_guard lock(mutex_);
  return scale_;
}

void LiveImages::Run() {
  LowerThreadPriority();
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return ended_ || next_; });
    if (ended_) return;
    const auto [frame_idx, image] = *std::exchange(next_, std::nullopt);
    lock.unlock();
    const cv::Mat small = Shrink(image, width_px_);
    std::string jpeg = ToJpeg(small, quality_);
    lock.lock();
    scale_ = static_cast<double>(small.cols) / image.cols;
    mb_ += (static_cast<double>(jpeg.size()) - static_cast<double>(jpeg_[frame_idx].size())) / 1e6;
    jpeg_[frame_idx] = std::move(jpeg);
    if (mb_ > max_mb_) {
      for (auto entry = jpeg_.begin(); entry != jpeg_.end() && std::next(entry) != jpeg_.end(); ++entry) {
        const auto forgotten = std::next(entry);
        mb_ -= static_cast<double>(forgotten->second.size()) / 1e6;
        jpeg_.erase(forgotten);
      }
    }
    changed_.wait_for(lock, kBetweenImages, [&] { return ended_; });
  }
}

}  // namespace pliant
