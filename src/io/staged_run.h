// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A run folder that appears whole or not at all, for runs that are computed before they are written: its files are
// written beside those of the run that the folder holds, and take their place together.
#pragma once

#include <string>
#include <utility>

#include "pliant/base/staged_folder.h"
#include "pliant/base/status.h"

namespace pliant {

class StagedRun {
 public:
  // Makes the folder (and those above it), and takes it. Fails with kInvalidArgument where it holds something else and
  // no run, and kUnwritable, also while another run is written there.
  static Result<StagedRun> Create(const std::string& folder);

  // Where the run is written (RunWriter) until Commit; what is there otherwise is deleted with this object.
  std::string path() const { return staged_.path().string(); }
  // Replaces the run that the folder holds. Where this fails, with kUnwritable, that one is still there.
  Status Commit();

 private:
  StagedRun(std::string folder, StagedFolder staged) : folder_(std::move(folder)), staged_(std::move(staged)) {}

  std::string folder_;
  StagedFolder staged_;
};

}  // namespace pliant
