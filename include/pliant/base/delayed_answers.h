// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Work that takes longer than one step of a loop: its answer is taken in a step that is fixed when it is asked for.
// Whether it is there sooner does not matter, so that results do not depend on how fast the machine is; where it is
// later the step waits, or, where no step may, a later one takes it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "pliant/base/parallel.h"
#include "pliant/base/state_archive.h"

namespace pliant {

// Where the work is done. It does not change what is taken when.
enum class WorkPlace {
  kHere,    // on the calling thread, when it is asked for
  kBeside,  // on a thread of its own, of low priority, one job after the other
};

template <class Answer>
class DelayedAnswers {
 public:
  DelayedAnswers() = default;
  // Waits for the job that runs; those that wait are dropped.
  ~DelayedAnswers() {
    Drop();
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    changed_.notify_all();
    if (worker_.joinable()) worker_.join();
  }
  DelayedAnswers(const DelayedAnswers&) = delete;
  DelayedAnswers& operator=(const DelayedAnswers&) = delete;

  // For the step `due`, no earlier than that of the one before. A job beside has to own what it reads, or what it reads
  // has to outlive this unchanged; what it throws, Take throws.
  void Ask(int due, WorkPlace place, std::function<Answer()> job) {
    auto task = std::make_shared<std::packaged_task<Answer()>>(std::move(job));
    asked_.push_back({due, task->get_future()});
    if (place == WorkPlace::kHere) {
      (*task)();
      return;
    }
    {
      const std::lock_guard lock(mutex_);
      waiting_.push_back(std::move(task));
    }
    changed_.notify_all();
    if (!worker_.joinable()) worker_ = std::thread([this] { Work(); });
  }

  // Whether nothing was asked for that is not taken.
  bool IsEmpty() const { return asked_.empty(); }

  // How many were asked for and are not taken.
  std::size_t size() const { return asked_.size(); }

  // The same as Take, but for an answer that is not there: nothing.
  std::optional<Answer> TakeIfThere(int step) {
    const bool is_there =
        !asked_.empty() && asked_.front().answer.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    return is_there ? Take(step) : std::nullopt;
  }

  // The oldest answer that is due in this step or was before, waited for; nothing: there is none.
  std::optional<Answer> Take(int step) {
    if (asked_.empty() || asked_.front().due > step) return std::nullopt;
    std::future<Answer> answer = std::move(asked_.front().answer);
    asked_.pop_front();
    return answer.get();
  }

  // Waits for all that was asked for; none of it is asked again when it is read.
  void Serialize(StateArchive& archive) {
    std::vector<std::pair<int, Answer>> answers;
    if (!archive.reads())
      for (Asked& asked : asked_) answers.emplace_back(asked.due, asked.answer.get());
    archive(answers);
    asked_.clear();
    for (auto& [due, answer] : answers) {
      std::promise<Answer> given;
      given.set_value(std::move(answer));
      asked_.push_back({due, given.get_future()});
    }
  }

  // No answer that was asked for is wanted any more.
  void Drop() {
    asked_.clear();
    const std::lock_guard lock(mutex_);
    waiting_.clear();
  }

 private:
  struct Asked {
    int due;
    std::future<Answer> answer;
  };

  void Work() {
    LowerThreadPriority();
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return stop_ || !waiting_.empty(); });
      if (stop_) return;
      const auto task = std::move(waiting_.front());
      waiting_.pop_front();
      lock.unlock();
      (*task)();
      lock.lock();
    }
  }

  std::deque<Asked> asked_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::shared_ptr<std::packaged_task<Answer()>>> waiting_;
  bool stop_ = false;
  std::thread worker_;
};

}  // namespace pliant
