// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/tracking/stage_times.h"

namespace pliant {

std::vector<std::string> StageNames() {
  std::vector<std::string> names;
  for (const auto& [stage, name] : EnumNames<Stage>::kNames) names.emplace_back(name);
  return names;
}

std::vector<std::pair<std::string, double>> StageTimes::ByName() const {
  std::vector<std::pair<std::string, double>> times;
  for (const auto& [stage, name] : EnumNames<Stage>::kNames)
    times.emplace_back(name, ms_[static_cast<std::size_t>(stage)]);
  return times;
}

}  // namespace pliant
