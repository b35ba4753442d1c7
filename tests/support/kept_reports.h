// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// An observer that keeps what a run reports.
#pragma once

#include <string>
#include <vector>

#include "pliant/pipeline/track.h"

namespace pliant {

class KeptReports final : public TrackObserver {
 public:
  void OnStart(int /*frames*/) override {}
  void OnWarning(const std::string& sentence) override { warnings.push_back(sentence); }
  void OnFrame(const FrameReport& report) override { reports.push_back(report); }

  std::vector<std::string> warnings;
  std::vector<FrameReport> reports;
};

}  // namespace pliant
