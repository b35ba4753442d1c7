// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The commands of the program, one a file. Each takes what follows its name on the command line and gives the exit
// code.
#pragma once

#include <span>
#include <string>

#include "pliant/base/version.h"

namespace pliant::cli {

// What pliant --version says of the program: the version, and behind it the commit, which main.cc alone knows and puts
// here, so that a commit makes nothing else anew.
inline std::string& ProgramVersion() {
  static std::string version = kVersion;
  return version;
}

int CalibrateCommand(std::span<const std::string> args);
int TrackCommand(std::span<const std::string> args);
int SimulateCommand(std::span<const std::string> args);
int EvaluateCommand(std::span<const std::string> args);
int CompareCommand(std::span<const std::string> args);
int TruthCommand(std::span<const std::string> args);
int ImportCommand(std::span<const std::string> args);
int ExportCommand(std::span<const std::string> args);
int DatasetCommand(std::span<const std::string> args);
int ModelCommand(std::span<const std::string> args);
int RefineCommand(std::span<const std::string> args);
int JoinCommand(std::span<const std::string> args);
int SurfaceCommand(std::span<const std::string> args);
int ReportCommand(std::span<const std::string> args);
int DemoCommand(std::span<const std::string> args);

}  // namespace pliant::cli
