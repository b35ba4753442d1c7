// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How far a command is: one line that is drawn over on a terminal, plain lines elsewhere (every kLinesEvery frames, so
// that a log stays readable), nothing on request.
//   track  [=========>          ]  45/100  41.3 frames/s  2 s left  498 points
#pragma once

#include <chrono>
#include <iosfwd>
#include <string>
#include <string_view>

namespace pliant::cli {

enum class ProgressStyle {
  kBar,    // for terminals
  kLines,  // for files and pipes
  kQuiet,
};

// The style for standard error as it is: kBar on a terminal, else kLines.
ProgressStyle ProgressStyleOfStandardError();

class Progress {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr int kLinesEvery = 25;

  // `out` must outlive this. `total` <= 0: not known. `unit` is what is counted; of "%" no rate is shown.
  Progress(std::ostream& out, ProgressStyle style, std::string what, int total, std::string unit = "frames");
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();  // ends the line that is drawn over

  // `done` items are finished; `detail` is shown behind the rate ("498 points").
  void Update(int done, std::string_view detail) { Update(done, detail, Clock::now()); }
  void Update(int done, std::string_view detail, Clock::time_point now);
  // A line of its own, above the bar.
  void Note(std::string_view text);

 private:
  std::string Rate(int done, Clock::time_point now) const;
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

}  // namespace pliant::cli
