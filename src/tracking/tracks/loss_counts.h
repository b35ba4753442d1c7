// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Points that were given up, counted by reason.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pliant {

class LossCounts {
 public:
  void Add(std::string_view reason, int count) {
    if (count == 0) return;
    for (auto& [name, total] : counts_)
      if (name == reason) {
        total += count;
        return;
      }
    counts_.emplace_back(reason, count);
  }
  void Add(const LossCounts& others) {
    for (const auto& [reason, count] : others.counts_) Add(reason, count);
  }

  // In the order of the first of each.
  const std::vector<std::pair<std::string, int>>& by_reason() const { return counts_; }
  int total() const {
    int total = 0;
    for (const auto& [reason, count] : counts_) total += count;
    return total;
  }

 private:
  std::vector<std::pair<std::string, int>> counts_;
};

}  // namespace pliant
