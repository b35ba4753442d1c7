// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/prefetched_sequence.h"

#include <cassert>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <variant>

namespace pliant {

// Two locks: `source_mutex` is held while the source works, which may be long; `queue_mutex` only to look at the queue.
struct PrefetchedSequence::Shared {
  using Read = Result<std::optional<SequenceFrame>>;

  Shared(std::unique_ptr<Sequence> from, int limit) : source(std::move(from)), ahead(static_cast<std::size_t>(limit)) {}

  void ReadAhead();

  std::unique_ptr<Sequence> source;
  const std::size_t ahead;
  std::mutex source_mutex;
  std::mutex queue_mutex;
  std::condition_variable room;     // the queue got shorter, or stop
  std::condition_variable content;  // the queue got longer
  std::deque<std::variant<Read, std::exception_ptr>> queue;
  bool stop = false;
  bool at_end = false;  // Next has given the end
  std::thread thread;
};

void PrefetchedSequence::Shared::ReadAhead() {
  for (bool more = true; more;) {
    {
      std::unique_lock lock(queue_mutex);
      room.wait(lock, [this] { return stop || queue.size() < ahead; });
      if (stop) return;
    }
    std::variant<Read, std::exception_ptr> read = std::exception_ptr();
    try {
      const std::lock_guard lock(source_mutex);
      Read result = source->Next();
      more = !result.ok() || result->has_value();
      read = std::move(result);
    } catch (...) {
      read = std::current_exception();
    }
    {
      const std::lock_guard lock(queue_mutex);
      queue.push_back(std::move(read));
    }
    content.notify_one();
  }
}

PrefetchedSequence::PrefetchedSequence(std::unique_ptr<Sequence> source, int ahead) {
  assert(source != nullptr && ahead >= 1);
  shared_ = std::make_unique<Shared>(std::move(source), ahead);
  shared_->thread = std::thread([shared = shared_.get()] { shared->ReadAhead(); });
}

PrefetchedSequence::~PrefetchedSequence() {
  {
    const std::lock_guard lock(shared_->queue_mutex);
    shared_->stop = true;
  }
  shared_->room.notify_one();
  shared_->thread.join();
}

// The camera and the size never change: no lock.
const Camera& PrefetchedSequence::camera() const { return shared_->source->camera(); }
int PrefetchedSequence::size() const { return shared_->source->size(); }

Result<std::optional<SequenceFrame>> PrefetchedSequence::Next() {
  if (shared_->at_end) return std::optional<SequenceFrame>();
  std::unique_lock lock(shared_->queue_mutex);
  shared_->content.wait(lock, [this] { return !shared_->queue.empty(); });
  std::variant<Shared::Read, std::exception_ptr> read = std::move(shared_->queue.front());
  shared_->queue.pop_front();
  lock.unlock();
  shared_->room.notify_one();
  if (const auto* exception = std::get_if<std::exception_ptr>(&read)) std::rethrow_exception(*exception);
  Shared::Read result = std::move(std::get<Shared::Read>(read));
  if (result.ok() && !result->has_value()) shared_->at_end = true;
  return result;
}

Result<std::optional<cv::Mat>> PrefetchedSequence::Depth(int frame_idx) const {
  const std::lock_guard lock(shared_->source_mutex);
  return shared_->source->Depth(frame_idx);
}

std::optional<Rigid3> PrefetchedSequence::WorldFromCamera(int frame_idx) const {
  const std::lock_guard lock(shared_->source_mutex);
  return shared_->source->WorldFromCamera(frame_idx);
}

std::optional<double> PrefetchedSequence::TimestampS(int frame_idx) const {
  const std::lock_guard lock(shared_->source_mutex);
  return shared_->source->TimestampS(frame_idx);
}

}  // namespace pliant
