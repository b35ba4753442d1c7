// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The run that a folder holds when another one is written there: set aside until the new one has something to show.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "pliant/base/status.h"

namespace pliant {

// kUnwritable, with the system's reason.
Status UnwritableFolder(const std::filesystem::path& folder, const std::error_code& error);

// What Finish made of a run that is resumed, without its rows and its checkpoint, is deleted.
Status DeleteResults(const std::filesystem::path& folder);

class FormerRun {
 public:
  // Fails with kInvalidArgument where the folder, which is there, holds something else and no run, and kUnwritable.
  static Status CheckFolder(const std::string& folder);
  // Moves the files of a run that has poses from `folder` into a subfolder, and deletes those of one that has none.
  // What a killed run had set aside stays so. Fails as CheckFolder does.
  static Result<FormerRun> SetAside(const std::string& folder);
  // What was set aside by a run that is resumed.
  static FormerRun OfResumed(const std::string& folder);
  FormerRun(FormerRun&& other) noexcept;
  FormerRun& operator=(FormerRun&&) = delete;
  ~FormerRun();  // restores it, unless it was forgotten

  // Whether there is one to restore.
  bool IsAside() const { return !folder_.empty(); }
  // Deletes it.
  void Forget();
  // Deletes the files of the new run and moves those of the former one back.
  void Restore();

 private:
  explicit FormerRun(std::string folder) : folder_(std::move(folder)) {}

  std::string folder_;  // empty: nothing is aside
};

}  // namespace pliant
