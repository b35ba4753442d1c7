// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/checkpoint.h"

#include <cstdint>
#include <filesystem>
#include <sstream>
#include <system_error>

#include <zlib.h>

#include "io/former_run.h"
#include "io/run_format.h"
#include "pliant/base/files.h"
#include "pliant/base/state_archive.h"
#include "pliant/base/version.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic = "Pliant checkpoint\n";
constexpr std::size_t kMaxHead = 400;  // bytes: a version and a checksum

std::string StateFile(const std::string& run_path) { return run_path + "/" + std::string(kCheckpointState); }

std::uint32_t Checksum(std::string_view bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

// Another compiler, machine or library may round otherwise, and the rest of a run would not be what it would have been.
std::string ThisProgram() {
  std::ostringstream text;
  text << kVersion << " (" << BuildText() << ", libraries " << std::hex << Checksum(LibrariesText()) << ")";
  return text.str();
}

}  // namespace

bool HasCheckpoint(const std::string& run_path) { return Exists(StateFile(run_path)); }

void ForgetCheckpoint(const std::string& run_path) {
  std::error_code error;
  fs::remove(StateFile(run_path), error);  // first: what is left then is no checkpoint
  fs::remove_all(fs::path(run_path) / kCheckpointFolder, error);
}

std::optional<RunSummary> EndedRun(const std::string& run_path) {
  auto summary = ReadRunSummary(run_path + "/run.json");
  const bool ended = summary.ok() &&
                     (summary->status == RunStatus::kCompleted || summary->status == RunStatus::kLost) &&
                     !HasCheckpoint(run_path);
  return ended ? std::optional(*std::move(summary)) : std::nullopt;
}

Status WriteCheckpoint(const std::string& run_path, std::string_view state) {
  std::error_code error;
  fs::create_directories(fs::path(StateFile(run_path)).parent_path(), error);
  if (error) return UnwritableFolder(run_path, error);
  std::string version = ThisProgram();
  std::uint32_t checksum = Checksum(state);
  StateArchive head;
  head(version, checksum);
  FileGroup group;
  auto file = group.Create(StateFile(run_path));
  if (!file.ok()) return file.status();
  for (const std::string_view part : {kMagic, std::string_view(head.bytes()), state})
    if (Status status = file->Append(part); !status.ok()) return status;
  if (Status status = file->Sync(); !status.ok()) return status;
  if (Status status = file->Close(); !status.ok()) return status;
  if (Status status = group.Commit(); !status.ok()) return status;
  for (const fs::path& folder : {fs::path(StateFile(run_path)).parent_path(), fs::path(run_path)})
    if (Status status = SyncFolder(folder); !status.ok()) return status;
  return Status::Ok();
}

Result<std::string> ReadCheckpoint(const std::string& run_path) {
  const std::string path = StateFile(run_path);
  const auto damaged = [&] {
    return Status(ErrorCode::kUnreadable,
                  "the checkpoint " + path + " is damaged; track the sequence anew, with --overwrite");
  };
  auto bytes = ReadFile(path);
  if (!bytes.ok()) return bytes.status();
  if (!bytes->starts_with(kMagic)) return damaged();
  StateArchive head = StateArchive::Reading(bytes->substr(kMagic.size(), kMaxHead));
  std::string version;
  std::uint32_t checksum = 0;
  head(version, checksum);
  if (!head.ok()) return damaged();
  if (version != ThisProgram())
    return Status(ErrorCode::kMismatch, "the checkpoint " + path + " is of version " + Quoted(version) +
                                            ", and this is " + ThisProgram() +
                                            "; resume the run with that program, or track the sequence anew, with "
                                            "--overwrite");
  StateArchive written;
  written(version, checksum);
  bytes->erase(0, kMagic.size() + written.bytes().size());
  if (Checksum(*bytes) != checksum) return damaged();
  return bytes;
}

}  // namespace pliant
