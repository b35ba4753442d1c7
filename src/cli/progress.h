// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How far a command is: one line that is drawn over on a terminal, plain lines elsewhere (every kLinesEvery frames,
// and two seconds after the one before, so that a log stays readable), JSON or nothing on request (messages.h).
//   track  [=========>          ]  45/100  41.3 frames/s  2 s left  498 points
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace pliant::cli {

enum class ProgressStyle {
  kBar,    // for terminals
  kLines,  // for files and pipes
  kJson,   // for programs, as kLines
  kQuiet,
};

// The style for standard error as it is, and as TheLogging() wants it: kBar on a terminal, else kLines.
ProgressStyle ProgressStyleOfStandardError();

class Progress {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr int kLinesEvery = 25;

  // On standard error, in its style. `total` <= 0: not known. `unit` is what is counted; of "%" no rate is shown.
  explicit Progress(std::string what, int total = 0, std::string unit = "frames");
  // `out` must outlive this.
  Progress(std::ostream& out, ProgressStyle style, std::string what, int total, std::string unit = "frames");
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();  // ends the line that is drawn over

  // `done` items are finished; `detail` is shown behind the rate ("498 points").
  void Update(int done, std::string_view detail) { Update(done, detail, Clock::now()); }
  void Update(int done, std::string_view detail, Clock::time_point now);
  // A line of its own, above the bar.
  void Note(std::string_view text);
  // Takes the bar away until it is drawn again, for other messages.
  void ClearBar();

 private:
  // The mean so far, and what it says of the end; 0: not known.
  struct Speed {
    double per_second = 0;
    double seconds_left = 0;
  };
  Speed SpeedAt(int done, Clock::time_point now) const;
  std::string JsonLine(int done, std::string_view detail, Clock::time_point now) const;
  std::string Line(int done, std::string_view detail, Clock::time_point now) const;

  std::ostream& out_;
  ProgressStyle style_;
  std::string what_;
  int total_;
  std::string unit_;
  Clock::time_point start_;
  Clock::time_point drawn_;
  int lines_ = 0;  // multiples of kLinesEvery that have been reached
  bool line_open_ = false;
};

// The progress of a job that has several tasks, and its end on request: a bar for each task that takes longer than
// kSilence.
class JobBars {
 public:
  static constexpr std::chrono::seconds kSilence{1};

  // Ends the job when `stop` is set; must outlive it. `unit` is what its tasks count.
  explicit JobBars(const std::atomic<bool>& stop, std::string unit = "frames") : stop_(stop), unit_(std::move(unit)) {}

  // As a JobProgress: false: stop.
  bool operator()(std::string_view task, int done, int total);

 private:
  const std::atomic<bool>& stop_;
  std::string unit_;
  std::string task_;
  Progress::Clock::time_point start_;
  std::optional<Progress> bar_;
};

// What `job`, which takes a JobProgress, gives; its bars are gone then.
template <class Job>
auto WithBars(const std::atomic<bool>& stop, const Job& job, std::string unit = "frames") {
  JobBars bars(stop, std::move(unit));
  return job(std::ref(bars));
}

}  // namespace pliant::cli
