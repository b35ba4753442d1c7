// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Files and folders that appear in a folder together, when all of them are written, or not at all. Programs that count
// the images of a folder must not find those of another export beside them: CheckAbsent says what is there already.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pliant/base/folder_lock.h"
#include "pliant/base/status.h"

namespace pliant {

// Fails with kInvalidArgument where `folder` has one of `names`.
Status CheckAbsent(const std::filesystem::path& folder, const std::vector<std::string>& names);

class StagedFolder {
 public:
  // The subfolder in which entries are written. A program that was killed leaves it; the next one deletes it.
  static constexpr const char* kUnfinished = ".unfinished";

  // `names` may appear in `folder`, which is made if need be. Fails as CheckAbsent does, and with kUnwritable, also
  // while another one writes there.
  static Result<StagedFolder> Create(const std::filesystem::path& folder, const std::vector<std::string>& names);
  StagedFolder(StagedFolder&& other) noexcept;
  StagedFolder& operator=(StagedFolder&&) = delete;
  ~StagedFolder();  // what was not committed is deleted, and the folder where Create made it and it is empty

  // Where entries are written until Commit, and one of them.
  const std::filesystem::path& path() const { return staged_; }
  std::filesystem::path Path(const std::string& name) const { return staged_ / name; }
  // Makes a subfolder. Fails with kUnwritable.
  Status AddFolder(const std::string& name) const;
  // Moves everything to its place, or nothing. A folder that is there gets what it lacks; a file that is there is
  // replaced. Fails with kUnwritable.
  Status Commit();

 private:
  StagedFolder(std::filesystem::path folder, std::filesystem::path staged, FolderLock lock, bool was_made);

  FolderLock lock_;
  std::filesystem::path folder_;
  std::filesystem::path staged_;  // empty: nothing to delete
  bool was_made_ = false;         // the folder, by Create
};

}  // namespace pliant
