// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Wall times of the stages of one frame, in milliseconds.
#pragma once

#include <array>
#include <chrono>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/base/options.h"

namespace pliant {

// In the order of the columns of frames.csv.
enum class Stage { kPrepare, kPhotometric, kPose, kAgreement, kGraph, kJoint, kInitialize };
template <>
struct EnumNames<Stage> {
  static constexpr std::array kNames = {
      std::pair{Stage::kPrepare, std::string_view("prepare")},
      std::pair{Stage::kPhotometric, std::string_view("photometric")},
      std::pair{Stage::kPose, std::string_view("pose")},
      std::pair{Stage::kAgreement, std::string_view("agreement")},
      std::pair{Stage::kGraph, std::string_view("graph")},
      std::pair{Stage::kJoint, std::string_view("joint")},
      std::pair{Stage::kInitialize, std::string_view("initialize")},
  };
};

// The names of all stages, in their order.
std::vector<std::string> StageNames();

class StageTimes {
 public:
  void Add(Stage stage, double ms) { ms_[static_cast<std::size_t>(stage)] += ms; }
  // Every stage once, in their order.
  std::vector<std::pair<std::string, double>> ByName() const;

 private:
  std::array<double, EnumNames<Stage>::kNames.size()> ms_ = {};
};

// Adds the time from its construction to its destruction to one stage.
class StageTimer {
 public:
  StageTimer(StageTimes* times, Stage stage) : times_(times), stage_(stage), start_(std::chrono::steady_clock::now()) {}
  ~StageTimer() {
    times_->Add(stage_, std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count());
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  StageTimes* times_;
  Stage stage_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace pliant
