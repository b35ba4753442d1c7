// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Values made ahead of time: one background thread calls a producer and keeps a few of its values ready, so that
// reading the next image overlaps with tracking this one. The order, and so every result, is that of plain calls.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace pliant {

template <class T>
class Prefetcher {
 public:
  // Nothing: the end. The producer is called by one thread at a time, and no more after the end. What it throws, Next
  // throws.
  using Producer = std::function<std::optional<T>()>;

  // At most `ahead` >= 1 values wait; `ahead` = 0: no thread, the producer runs inside Next.
  Prefetcher(Producer produce, int ahead) : produce_(std::move(produce)), ahead_(static_cast<std::size_t>(ahead)) {
    if (ahead_ > 0) worker_ = std::thread([this] { Work(); });
  }
  ~Prefetcher() {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    changed_.notify_all();
    if (worker_.joinable()) worker_.join();
  }
  Prefetcher(const Prefetcher&) = delete;
  Prefetcher& operator=(const Prefetcher&) = delete;

  // The next value; nothing at the end, and ever after.
  std::optional<T> Next() {
    if (ahead_ == 0) {
      std::optional<T> value;
      if (!ended_) value = produce_();
      ended_ = !value.has_value();
      return value;
    }
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !ready_.empty() || ended_; });
    if (ready_.empty()) {
      if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
      return std::nullopt;
    }
    std::optional<T> value = std::move(ready_.front());
    ready_.pop_front();
    changed_.notify_all();
    return value;
  }

 private:
  void Work() {
    while (true) {
      {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return stop_ || ready_.size() < ahead_; });
        if (stop_) return;
      }
      std::optional<T> value;
      std::exception_ptr failure;
      try {
        value = produce_();
      } catch (...) {
        failure = std::current_exception();
      }
      const std::lock_guard lock(mutex_);
      failure_ = failure;
      if (value) {
        ready_.push_back(*std::move(value));
      } else {
        ended_ = true;
      }
      changed_.notify_all();
      if (ended_) return;
    }
  }

  Producer produce_;
  std::size_t ahead_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<T> ready_;
  std::exception_ptr failure_;
  bool ended_ = false;
  bool stop_ = false;
  std::thread worker_;
};

}  // namespace pliant
