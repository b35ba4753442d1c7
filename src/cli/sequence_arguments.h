// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What every command that reads images asks for: where they are, and which part of them.
#pragma once

#include <optional>
#include <string>

#include "cli/command_line.h"
#include "pliant/datasets/open_sequence.h"

namespace pliant::cli {

struct SequenceArguments {
  std::string path;
  std::string camera_path;  // "unknown": a camera with fov_deg
  int fov_deg = 70;
  std::string mask_path;
  int start = 0;
  int end = -1;
  int stride = 1;

  void AddTo(CommandLine* line);
  // An exit code where the arguments contradict each other (the sentence has been said).
  std::optional<int> Check(const CommandLine& line) const;
  SequenceRequest Request() const;
};

// Of a command that reads the images of a run.
void AddCameraOfRun(CommandLine* line, std::string* camera_path);
// Of a command that reads a run alone, unless that was killed.
void AddSequenceOfKilledRun(CommandLine* line, std::string* sequence_path, std::string* camera_path);
void AddMasksOfRun(CommandLine* line, std::string* mask_path);

}  // namespace pliant::cli
