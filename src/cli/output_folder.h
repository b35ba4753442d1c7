// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Where a command leaves a run, a sequence or a surface: what is there already is replaced on request only.
#pragma once

#include <optional>
#include <string>

#include "cli/command_line.h"

namespace pliant::cli {

struct OutputFolder {
  enum class Content { kRun, kSequence, kSurface };

  std::string path;
  bool overwrite = false;

  // --output_path and --overwrite.
  void AddTo(CommandLine* line, std::string why, Need need);
  // An exit code where there is a run with poses, a sequence with images or a surface that is not to be replaced (the
  // sentence has been said), or a run where a sequence is to be written. `folder`: `path`, or another one that the
  // command writes.
  std::optional<int> Check(const CommandLine& line, const std::string& folder, Content content) const;
};

}  // namespace pliant::cli
