// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/base/staged_folder.h"

#include <system_error>
#include <utility>

#include "pliant/base/files.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// What is in `from` is to be in `to`.
void AddRenamings(const fs::path& from, const fs::path& to, std::vector<Renaming>* renamings, std::error_code* error) {
  for (fs::directory_iterator entry(from, *error), end; !*error && entry != end; entry.increment(*error)) {
    const fs::path place = to / entry->path().filename();
    std::error_code absent;
    if (entry->is_directory(absent) && fs::is_directory(place, absent))
      AddRenamings(entry->path(), place, renamings, error);
    else
      renamings->push_back({entry->path().string(), place.string()});
  }
}

}  // namespace

StagedFolder::StagedFolder(fs::path folder, fs::path staged, FolderLock lock, bool was_made)
    : lock_(std::move(lock)), folder_(std::move(folder)), staged_(std::move(staged)), was_made_(was_made) {}

StagedFolder::StagedFolder(StagedFolder&& other) noexcept
    : lock_(std::move(other.lock_)),
      folder_(std::move(other.folder_)),
      staged_(std::exchange(other.staged_, {})),
      was_made_(other.was_made_) {}

StagedFolder::~StagedFolder() {
  std::error_code error;
  if (staged_.empty()) return;
  fs::remove_all(staged_, error);
  if (was_made_) fs::remove(folder_, error);  // fails where something is in it
}

Status CheckAbsent(const fs::path& folder, const std::vector<std::string>& names) {
  for (const std::string& name : names)
    if (Exists((folder / name).string()))
      return {ErrorCode::kInvalidArgument,
              Quoted((folder / name).string()) + " is there already; delete it or give another --output_path"};
  return Status::Ok();
}

Result<StagedFolder> StagedFolder::Create(const fs::path& folder, const std::vector<std::string>& names) {
  if (Status status = CheckAbsent(folder, names); !status.ok()) return status;
  std::error_code error;
  const bool was_made = fs::create_directories(folder, error);
  if (error) return Unwritable(folder);
  auto lock = FolderLock::Take(folder);
  if (!lock.ok()) return lock.status();
  StagedFolder result(folder, folder / kUnfinished, *std::move(lock), was_made);
  fs::remove_all(result.staged_, error);  // that of an export that was killed
  fs::create_directories(result.staged_, error);
  if (error) return Unwritable(result.staged_);
  return result;
}

Status StagedFolder::AddFolder(const std::string& name) const {
  std::error_code error;
  fs::create_directories(Path(name), error);
  return error ? Unwritable(Path(name)) : Status::Ok();
}

Status StagedFolder::Commit() {
  std::error_code error;
  std::vector<Renaming> renamings;
  AddRenamings(staged_, folder_, &renamings, &error);
  return error ? Unwritable(folder_) : RenameTogether(renamings);
}

}  // namespace pliant
