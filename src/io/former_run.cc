// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/former_run.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "io/run_format.h"
#include "pliant/base/staged_folder.h"
#include "pliant/base/text.h"
#include "pliant/io/run_summary.h"
#include "pliant/io/run_writer.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAside = ".former_run";

// Whether the calibration in the run's folder was found by the run itself, and is not its user's.
bool HasOwnCamera(const RunDescription& run, const fs::path& folder) {
  const fs::path camera = run.camera;
  if (run.refined_from.empty() || camera.filename() != kEstimatedCamera) return false;
  std::error_code error;
  return fs::equivalent(camera.parent_path(), folder.filename() == kAside ? folder.parent_path() : folder, error);
}

// Files, and then the folders of models, where `folder` has them. A killed run says of no submaps, and has no models.
std::vector<std::string> FilesOfRun(const fs::path& folder) {
  const auto run = ReadRunSummary((folder / "run.json").string());
  const int submaps = run.ok() ? run->submaps : 0;
  std::vector<std::string> names(kRunFiles.begin(), kRunFiles.end());
  if (run.ok() && HasOwnCamera(run->description, folder)) names.emplace_back(kEstimatedCamera);
  std::error_code error;
  const auto is_there = [&](int submap) { return fs::exists(folder / SubmapModel(submap, submaps), error); };
  int counted = 1;  // what run.json claims may be anything
  while (counted < submaps && is_there(counted)) ++counted;
  for (int submap = 0; submap < counted; ++submap) {
    if (submap > 0) names.push_back(SubmapPly(submap));
    for (const std::string_view name : kModelFiles)
      names.push_back(SubmapModel(submap, submaps) + "/" + std::string(name));
  }
  for (int submap = 0; submaps > 1 && submap < counted; ++submap) names.push_back(SubmapModel(submap, submaps));
  names.emplace_back("sparse");
  names.emplace_back(kCheckpointState);
  names.push_back(std::string(kCheckpointState) + ".tmp");
  for (const std::string_view rows : kRowFiles)
    names.push_back(std::string(kCheckpointFolder) + "/" + std::string(rows));
  names.emplace_back(kCheckpointFolder);
  std::erase_if(names, [&](const std::string& name) { return !fs::exists(folder / name, error); });
  return names;
}

// Folders that hold somebody else's files stay.
template <class Keep>
Status DeleteBut(const fs::path& folder, const Keep& keep) {
  std::error_code error;
  for (const std::string& name : FilesOfRun(folder)) {
    if (keep(name)) continue;
    fs::remove(folder / name, error);
    if (error && error != std::errc::directory_not_empty) return UnwritableFolder(folder, error);
  }
  return Status::Ok();
}

Status Delete(const fs::path& folder) {
  return DeleteBut(folder, [](const std::string&) { return false; });
}

Status MoveRun(const fs::path& from, const fs::path& to) {
  std::error_code error;
  for (const std::string& name : FilesOfRun(from)) {
    if (fs::is_directory(from / name, error)) {
      fs::remove(from / name, error);  // which is empty now, or not ours
      continue;
    }
    fs::create_directories((to / name).parent_path(), error);
    if (!error) fs::rename(from / name, to / name, error);
    if (error) return UnwritableFolder(to, error);
  }
  return Status::Ok();
}

}  // namespace

Status UnwritableFolder(const fs::path& folder, const std::error_code& error) {
  return {ErrorCode::kUnwritable, "cannot write into " + Quoted(folder.string()) + ": " + error.message() +
                                      "; choose another folder or change its permissions"};
}

Status DeleteResults(const fs::path& folder) {
  return DeleteBut(folder, [](const std::string& name) {
    return name == "run.json" || name == "config.yaml" || name.starts_with(kCheckpointFolder) ||
           std::ranges::find(kRowFiles, name) != kRowFiles.end();
  });
}

bool HoldsRun(const fs::path& folder) {
  std::error_code error;
  const auto size = fs::file_size(folder / "trajectory.txt", error);
  return !error && size > 0 && fs::exists(folder / "run.json", error);
}

FormerRun::FormerRun(FormerRun&& other) noexcept : folder_(std::exchange(other.folder_, {})) {}

FormerRun::~FormerRun() { Restore(); }

Status FormerRun::CheckFolder(const std::string& folder) {
  std::error_code error;
  bool is_empty = true;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    is_empty = is_empty && entry->path().filename() == StagedFolder::kUnfinished;
  if (error) return UnwritableFolder(folder, error);
  if (is_empty || fs::exists(fs::path(folder) / kAside, error) || ReadRunSummary(folder + "/run.json").ok())
    return Status::Ok();
  return {ErrorCode::kInvalidArgument,
          "the folder " + Quoted(folder) + " holds files that are not a run's; give a new or an empty folder"};
}

Result<FormerRun> FormerRun::SetAside(const std::string& folder) {
  if (Status status = CheckFolder(folder); !status.ok()) return status;
  const fs::path aside = fs::path(folder) / kAside;
  std::error_code error;
  const bool was_aside = fs::exists(aside, error);
  if (HoldsRun(folder)) {
    fs::remove_all(aside, error);
    if (Status moved = MoveRun(folder, aside); !moved.ok()) {
      const Status back = MoveRun(aside, folder);
      return back.ok() ? moved : back;
    }
    return FormerRun(folder);
  }
  if (Status status = Delete(folder); !status.ok()) return status;
  return FormerRun(was_aside ? folder : std::string());
}

FormerRun FormerRun::OfResumed(const std::string& folder) {
  std::error_code error;
  return FormerRun(fs::exists(fs::path(folder) / kAside, error) ? folder : std::string());
}

void FormerRun::Forget() {
  if (!IsAside()) return;
  std::error_code error;
  fs::remove_all(fs::path(std::exchange(folder_, {})) / kAside, error);
}

void FormerRun::Restore() {
  if (!IsAside()) return;
  const fs::path folder = std::exchange(folder_, {});
  const fs::path aside = folder / kAside;
  std::error_code error;
  if (!Delete(folder).ok()) return;
  if (MoveRun(aside, folder).ok()) fs::remove_all(aside, error);
}

}  // namespace pliant
