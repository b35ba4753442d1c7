// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/progress.h"

#include <algorithm>
#include <ostream>
#include <utility>

#include <unistd.h>

#include "pliant/base/text.h"

namespace pliant::cli {
namespace {

constexpr int kBarWidth = 24;
constexpr std::string_view kPercent = "%";
constexpr std::chrono::milliseconds kDrawEvery{100};  // faster than the eye needs, and cheap
constexpr std::string_view kToLineStartAndClear = "\r\x1b[K";

}  // namespace

ProgressStyle ProgressStyleOfStandardError() {
  return isatty(STDERR_FILENO) != 0 ? ProgressStyle::kBar : ProgressStyle::kLines;
}

Progress::Progress(std::ostream& out, ProgressStyle style, std::string what, int total, std::string unit)
    : out_(out),
      style_(style),
      what_(std::move(what)),
      total_(total),
      unit_(std::move(unit)),
      start_(Clock::now()),
      drawn_(start_) {}

Progress::~Progress() {
  if (line_open_) out_ << std::endl;
}

// By the mean rate so far.
std::string Progress::Rate(int done, Clock::time_point now) const {
  const double seconds = std::chrono::duration<double>(now - start_).count();
  if (seconds <= 0) return "";
  std::string text;
  if (unit_ != kPercent) text += "  " + Digits(done / seconds, 1) + " " + unit_ + "/s";
  if (done > 0 && done < total_) text += "  " + Digits(seconds / done * (total_ - done), 0) + " s left";
  return text;
}

std::string Progress::Line(int done, std::string_view detail, Clock::time_point now) const {
  std::string line = what_ + "  ";
  if (style_ == ProgressStyle::kBar && total_ > 0) {
    const int filled = std::clamp(static_cast<int>(static_cast<long long>(kBarWidth) * done / total_), 0, kBarWidth);
    line += "[" + std::string(static_cast<std::size_t>(filled), '=') +
            std::string(static_cast<std::size_t>(kBarWidth - filled), ' ') + "]  ";
  }
  line += std::to_string(done);
  if (unit_ == kPercent)
    line += " %";
  else if (total_ > 0)
    line += "/" + std::to_string(total_);
  line += Rate(done, now);
  if (!detail.empty()) line += "  " + std::string(detail);
  return line;
}

void Progress::Update(int done, std::string_view detail, Clock::time_point now) {
  const bool last = total_ > 0 && done >= total_;
  if (style_ == ProgressStyle::kBar && (last || !line_open_ || now - drawn_ >= kDrawEvery)) {
    out_ << kToLineStartAndClear << Line(done, detail, now) << std::flush;
    drawn_ = now;
    line_open_ = true;
  } else if (style_ == ProgressStyle::kLines && (last || done / kLinesEvery > lines_)) {
    out_ << Line(done, detail, now) << std::endl;
    lines_ = done / kLinesEvery;
  }
}

void Progress::Note(std::string_view text) {
  if (style_ == ProgressStyle::kQuiet) return;
  if (line_open_) out_ << kToLineStartAndClear;
  line_open_ = false;
  out_ << text << std::endl;
}

}  // namespace pliant::cli
