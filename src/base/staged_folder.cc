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

constexpr const char* kUnfinished = ".unfinished";

}  // namespace

StagedFolder::StagedFolder(fs::path folder, fs::path staged) : folder_(std::move(folder)), staged_(std::move(staged)) {}

StagedFolder::StagedFolder(StagedFolder&& other) noexcept
    : folder_(std::move(other.folder_)), staged_(std::exchange(other.staged_, {})) {}

StagedFolder::~StagedFolder() {
  std::error_code error;
  if (!staged_.empty()) fs::remove_all(staged_, error);
}

Result<StagedFolder> StagedFolder::Create(const fs::path& folder, const std::vector<std::string>& names) {
  for (const std::string& name : names)
    if (Exists((folder / name).string()))
      return Status(ErrorCode::kInvalidArgument,
                    Quoted((folder / name).string()) + " is there already; delete it or give another --output_path");
  StagedFolder result(folder, folder / kUnfinished);
  std::error_code error;
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
  for (fs::directory_iterator entry(staged_, error), end; !error && entry != end; entry.increment(error)) {
    fs::rename(entry->path(), folder_ / entry->path().filename(), error);
    if (error) return Unwritable(folder_ / entry->path().filename());
  }
  return error ? Unwritable(folder_) : Status::Ok();
}

}  // namespace pliant
