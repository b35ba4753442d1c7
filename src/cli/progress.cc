// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/progress.h"

#include <algorithm>
#include <iostream>
#include <utility>

#include <unistd.h>

#include "cli/messages.h"
#include "pliant/base/text.h"

namespace pliant::cli {
namespace {

constexpr int kBarWidth = 24;
constexpr std::string_view kPercent = "%";
constexpr std::chrono::milliseconds kDrawEvery{100};  // faster than the eye needs, and cheap
constexpr std::chrono::seconds kLineAfter{2};         // since the one before, however little was done
constexpr std::string_view kToLineStartAndClear = "\r\x1b[K";

}  // namespace

ProgressStyle ProgressStyleOfStandardError() {
  if (TheLogging().level < LogLevel::kInfo) return ProgressStyle::kQuiet;
  if (TheLogging().format == LogFormat::kJson) return ProgressStyle::kJson;
  return isatty(STDERR_FILENO) != 0 ? ProgressStyle::kBar : ProgressStyle::kLines;
}

Progress::Progress(std::string what, int total, std::string unit)
    : Progress(std::cerr, ProgressStyleOfStandardError(), std::move(what), total, std::move(unit)) {}

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

Progress::Speed Progress::SpeedAt(int done, Clock::time_point now) const {
  const double seconds = std::chrono::duration<double>(now - start_).count();
  if (seconds <= 0 || done <= 0) return {};
  return {done / seconds, done < total_ ? seconds / done * (total_ - done) : 0};
}

std::string Progress::JsonLine(int done, std::string_view detail, Clock::time_point now) const {
  std::string members = "\"task\":" + JsonString(what_) + ",\"done\":" + std::to_string(done);
  if (total_ > 0) members += ",\"total\":" + std::to_string(total_);
  members += ",\"unit\":" + JsonString(unit_);
  const Speed speed = SpeedAt(done, now);
  if (speed.per_second > 0) members += ",\"per_second\":" + Digits(speed.per_second, 3);
  if (total_ > 0 && speed.per_second > 0) members += ",\"seconds_left\":" + Digits(speed.seconds_left, 1);
  if (!detail.empty()) members += ",\"text\":" + JsonString(detail);
  return EventLine("progress", members);
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
  const Speed speed = SpeedAt(done, now);
  if (unit_ != kPercent && speed.per_second > 0) line += "  " + Digits(speed.per_second, 1) + " " + unit_ + "/s";
  if (speed.seconds_left > 0) line += "  " + Digits(speed.seconds_left, 0) + " s left";
  if (!detail.empty()) line += "  " + std::string(detail);
  return line;
}

void Progress::Update(int done, std::string_view detail, Clock::time_point now) {
  const bool last = total_ > 0 && done >= total_;
  if (style_ == ProgressStyle::kBar && (last || !line_open_ || now - drawn_ >= kDrawEvery)) {
    out_ << kToLineStartAndClear << Line(done, detail, now) << std::flush;
    drawn_ = now;
    line_open_ = true;
  } else if ((style_ == ProgressStyle::kLines || style_ == ProgressStyle::kJson) &&
             (last || done / kLinesEvery > lines_ || now - drawn_ >= kLineAfter)) {
    out_ << (style_ == ProgressStyle::kJson ? JsonLine(done, detail, now) : Line(done, detail, now) + "\n")
         << std::flush;
    lines_ = done / kLinesEvery;
    drawn_ = now;
  }
}

void Progress::ClearBar() {
  if (line_open_) out_ << kToLineStartAndClear;
  line_open_ = false;
}

void Progress::Note(std::string_view text) {
  if (style_ == ProgressStyle::kQuiet) return;
  ClearBar();
  out_ << (style_ == ProgressStyle::kJson ? EventLine("note", "\"text\":" + JsonString(text)) : Printable(text) + "\n")
       << std::flush;
}

bool JobBars::operator()(std::string_view task, int done, int total) {
  if (!bar_ || task != task_) {
    bar_.reset();
    task_ = task;
    start_ = Progress::Clock::now();
    bar_.emplace(task_, total, unit_);
  }
  if (Progress::Clock::now() - start_ >= kSilence) bar_->Update(done, "");
  return !stop_.load();
}

}  // namespace pliant::cli
