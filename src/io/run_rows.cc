// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/run_rows.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <vector>

#include "io/former_run.h"
#include "io/run_format.h"
#include "pliant/base/files.h"
#include "pliant/base/text.h"
#include "pliant/io/run_reader.h"
#include "pliant/io/trajectory.h"
#include "pliant/scene/serialize.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// The lines of a file, each through `change`, which has its number from 0.
template <class Change>
Status RewriteLines(FileGroup& group, const std::string& path, const Change& change) {
  auto lines = LineReader::Open(path);
  if (!lines.ok()) return lines.status();
  auto file = group.Create(path);
  if (!file.ok()) return file.status();
  std::string rows;
  std::size_t number = 0;
  for (std::string_view line; lines->Next(&line); ++number) {
    if (Status status = change(number, line, &rows); !status.ok()) return status;
    if (Status status = file->AppendWhenLarge(&rows); !status.ok()) return status;
  }
  if (Status status = lines->End(); !status.ok()) return status;
  if (Status status = file->Append(rows); !status.ok()) return status;
  return file->Close();
}

Status MoveTrajectory(FileGroup& group, const std::string& path, std::span<const CanonicalImage> images) {
  return RewriteLines(group, path, [&](std::size_t k, std::string_view line, std::string* rows) {
    double timestamp_s = 0;
    if (!ParseFinite(line.substr(0, line.find(' ')), &timestamp_s) || k >= images.size())
      return Status(ErrorCode::kMismatch, Quoted(path) + " was changed meanwhile");
    AppendTumLine(rows, timestamp_s, images[k].cam_from_world.Inverse());
    return Status::Ok();
  });
}

Status MoveFrames(FileGroup& group, const std::string& path, std::span<const RunFrameWorld> worlds) {
  std::size_t column = 0;
  return RewriteLines(group, path, [&](std::size_t number, std::string_view line, std::string* rows) {
    const std::vector<std::string_view> fields = Split(line, ',');
    if (number == 0) {
      column = static_cast<std::size_t>(std::ranges::find(fields, kSubmapColumn) - fields.begin());
      rows->append(line).push_back('\n');
      return Status::Ok();
    }
    if (column >= fields.size() || number > worlds.size())
      return Status(ErrorCode::kMismatch, Quoted(path) + " was changed meanwhile");
    const auto begin = static_cast<std::size_t>(fields[column].data() - line.data());
    rows->append(line.substr(0, begin)).append(std::to_string(worlds[number - 1].submap));
    rows->append(line.substr(begin + fields[column].size())).push_back('\n');
    return Status::Ok();
  });
}

Status MoveObservations(FileGroup& group, const std::string& run_path, std::span<const RunFrameWorld> worlds) {
  auto file = group.Create(run_path + "/observations.csv");
  if (!file.ok()) return file.status();
  std::string rows = std::string(kObservationColumns) + "\n";
  std::vector<int> frames_idx;
  for (const RunFrameWorld& world : worlds) frames_idx.push_back(world.frame_idx);
  Status status = ForEachFrame(run_path, frames_idx, [&](std::size_t k, const auto& observations) {
    for (PointObservation seen : observations) {
      if (worlds[k].moved_by) {
        seen.position = *worlds[k].moved_by * seen.position;
        seen.sigma *= worlds[k].moved_by->scale;
      }
      AppendObservation(&rows, worlds[k].frame_idx, seen);
    }
    return file->AppendWhenLarge(&rows);
  });
  if (!status.ok()) return status;
  if (Status written = file->Append(rows); !written.ok()) return written;
  return file->Close();
}

// `to` appears when all of it is there: TakeKeptRows would take a part of it for the whole.
std::error_code CopyWhole(const fs::path& from, const fs::path& to) {
  fs::path beside = to;
  beside += ".tmp";
  std::error_code error;
  fs::copy_file(from, beside, fs::copy_options::overwrite_existing, error);
  if (!error) fs::rename(beside, to, error);
  std::error_code ignored;
  if (error) fs::remove(beside, ignored);
  return error;
}

}  // namespace

void AppendObservation(std::string* out, int frame_idx, const PointObservation& o) {
  AppendInt(out, frame_idx);
  out->push_back(',');
  AppendInt(out, o.id.value);
  for (const double pixel : o.pixel) {
    out->push_back(',');
    AppendFixed(out, pixel, 4);
  }
  for (const double coordinate : o.position) {
    out->push_back(',');
    AppendFixed(out, coordinate, 6);
  }
  out->push_back(',');
  AppendFixed(out, o.ssim, 4);
  out->push_back(',');
  AppendFixed(out, o.sigma, 6);
  out->push_back('\n');
}

Status MoveRunRows(const std::string& run_path, std::span<const RunFrameWorld> worlds,
                   std::span<const CanonicalImage> images) {
  const bool changed = std::ranges::any_of(
      worlds, [](const RunFrameWorld& world) { return world.moved_by || world.submap != world.written_submap; });
  if (!changed) return Status::Ok();
  FileGroup group;
  if (Status status = MoveTrajectory(group, run_path + "/trajectory.txt", images); !status.ok()) return status;
  if (Status status = MoveFrames(group, run_path + "/frames.csv", worlds); !status.ok()) return status;
  if (Status status = MoveObservations(group, run_path, worlds); !status.ok()) return status;
  return group.Commit();
}

void Serialize(StateArchive& archive, RunFrameWorld& world) { archive.Members<4>(world); }

Status KeepRows(const std::string& run_path) {
  std::error_code error;
  for (const std::string_view name : kRowFiles) {
    const fs::path kept = fs::path(run_path) / kCheckpointFolder / name;
    fs::remove(kept, error);
    fs::create_hard_link(fs::path(run_path) / name, kept, error);
    if (error) error = CopyWhole(fs::path(run_path) / name, kept);  // a file system without links
    if (error) return UnwritableFolder(kept.parent_path(), error);
  }
  return Status::Ok();
}

Status TakeKeptRows(const std::string& run_path) {
  std::error_code error;
  for (const std::string_view name : kRowFiles) {
    const fs::path kept = fs::path(run_path) / kCheckpointFolder / name;
    if (!fs::exists(kept, error)) continue;
    fs::rename(kept, fs::path(run_path) / name, error);
    if (error) return UnwritableFolder(run_path, error);
    fs::remove(kept, error);  // two names of one file are not renamed
  }
  return Status::Ok();
}

}  // namespace pliant
