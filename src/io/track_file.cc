// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/track_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <string_view>
#include <utility>

#include "io/npy.h"
#include "io/track_arrays.h"
#include "pliant/base/files.h"
#include "pliant/base/options.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

constexpr std::array<std::string_view, 5> kTrackColumns = {"frame", "track_id", "u_px", "v_px", "sigma_px"};
constexpr std::size_t kNeededTrackColumns = 4;
constexpr std::size_t kNoColumn = static_cast<std::size_t>(-1);
constexpr std::string_view kSqliteMagic = "SQLite format 3";

using TrackColumns = std::array<std::size_t, kTrackColumns.size()>;

// Without the blanks around it, and the quotes within these.
std::string_view Bare(std::string_view field) {
  const auto trimmed = [](std::string_view text) {
    const std::size_t begin = text.find_first_not_of(" \t");
    if (begin == std::string_view::npos) return std::string_view();
    return text.substr(begin, text.find_last_not_of(" \t") + 1 - begin);
  };
  field = trimmed(field);
  if (field.size() >= 2 && field.starts_with('"') && field.ends_with('"'))
    field = trimmed(field.substr(1, field.size() - 2));
  return field;
}

std::vector<std::string_view> BareFields(std::string_view line) {
  std::vector<std::string_view> fields = Split(line, ',');
  for (std::string_view& field : fields) field = Bare(field);
  return fields;
}

// The beginning of a line, for a message, whatever file it is of.
std::string Shown(std::string_view line) {
  constexpr std::size_t kMaxLength = 60;
  std::string shown(line.substr(0, kMaxLength));
  for (char& c : shown)
    if (c < ' ' || c > '~') c = '?';
  return Quoted(shown + (line.size() > kMaxLength ? "..." : ""));
}

// Where the columns stand; nothing where a needed one is missing.
std::optional<TrackColumns> ColumnsOf(const std::vector<std::string_view>& header) {
  TrackColumns columns{};
  for (std::size_t k = 0; k < kTrackColumns.size(); ++k) {
    const auto found = std::ranges::find(header, kTrackColumns[k]);
    if (found == header.end() && k < kNeededTrackColumns) return std::nullopt;
    columns[k] = found == header.end() ? kNoColumn : static_cast<std::size_t>(found - header.begin());
  }
  return columns;
}

// The name of a column that comes twice; empty: none does.
std::string_view RepeatedColumn(const std::vector<std::string_view>& header) {
  for (const std::string_view column : kTrackColumns)
    if (std::ranges::count(header, column) > 1) return column;
  return {};
}

// Also one with a point, "12.0", as programs write that keep all numbers as floats.
bool ParseIndex(std::string_view text, int* value) {
  double number = 0;
  if (ParseInt(text, value)) return *value >= 0;
  if (!ParseFinite(text, &number) || number != std::floor(number)) return false;
  if (number < 0 || number > std::numeric_limits<int>::max()) return false;
  *value = static_cast<int>(number);
  return true;
}

struct TrackRow {
  PointId id;
  TrackPixel seen;
};

// Empty: the row is right; else what is wrong with it.
std::string ParseTrackRow(const std::vector<std::string_view>& fields, const TrackColumns& columns, TrackRow* row) {
  const auto field = [&](std::size_t k) { return fields[columns[k]]; };
  if (!ParseIndex(field(0), &row->seen.frame_idx)) return Quoted(field(0)) + " is not a frame's number";
  int id = 0;
  if (!ParseIndex(field(1), &id)) return Quoted(field(1)) + " is not a track_id, a whole number from 0 to 2147483647";
  row->id.value = id;
  for (const int axis : {0, 1})
    if (const std::string_view text = field(2 + static_cast<std::size_t>(axis));
        !ParseFinite(text, &row->seen.pixel[axis]))
      return Quoted(text) + " is not a finite number; leave out the rows of points that are not seen";
  if (columns[4] != kNoColumn && (!ParseFinite(field(4), &row->seen.sigma_px) || row->seen.sigma_px < 0))
    return Quoted(field(4)) + " is not a standard deviation; write 0 where it is not known";
  return {};
}

Result<TrackFile> ReadTrackCsv(const std::string& path) {
  auto reader = LineReader::Open(path);
  if (!reader.ok()) return reader.status();
  std::string_view line;
  const auto header = reader->Next(&line) ? BareFields(line) : std::vector<std::string_view>();
  const auto columns = ColumnsOf(header);
  const std::size_t count = header.size();
  if (!columns)
    return Status(ErrorCode::kUnreadable,
                  Quoted(path) +
                      " is no file of tracks: neither NumPy's .npz or .npy, nor a database of COLMAP, nor a CSV whose "
                      "first line names frame,track_id,u_px,v_px" +
                      (header.empty() ? "; it is empty" : "; its first line is " + Shown(line)));
  if (const std::string_view repeated = RepeatedColumn(header); !repeated.empty())
    return Status(ErrorCode::kUnreadable, "the first line of " + Quoted(path) + " names " + std::string(repeated) +
                                              " more than once; give each column a name of its own");
  std::map<PointId, std::map<int, TrackPixel>> tracks;
  while (reader->Next(&line)) {
    if (Bare(line).empty()) continue;
    const auto columns_here = static_cast<std::size_t>(std::ranges::count(line, ',')) + 1;
    if (columns_here != count)
      return reader->Error("a row has " + std::to_string(count) + " columns, as the first line, this one has " +
                           std::to_string(columns_here) + (reader->ended() ? "" : "; the file is cut off"));
    const auto fields = BareFields(line);
    TrackRow row;
    if (const std::string wrong = ParseTrackRow(fields, *columns, &row); !wrong.empty()) return reader->Error(wrong);
    if (!tracks[row.id].emplace(row.seen.frame_idx, row.seen).second)
      return reader->Error("track " + std::to_string(row.id.value) + " comes twice in frame " +
                           std::to_string(row.seen.frame_idx) + "; a track has one pixel a frame");
  }
  if (Status status = reader->End(); !status.ok()) return status;
  TrackFile file;
  for (const auto& [id, pixels] : tracks) {
    PixelTrack& track = file.tracks.emplace_back(PixelTrack{id, {}});
    for (const auto& [frame_idx, seen] : pixels) track.pixels.push_back(seen);
  }
  return file;
}

bool IsWhole(const Eigen::Vector2d& pixel) { return pixel == pixel.array().round().matrix(); }

// What all forms have in common.
Status CheckPixels(const std::string& path, TrackFile* file) {
  bool seen = false;
  bool whole = true;
  bool half = true;  // rounded to whole pixels whose first one's center is not at 0
  for (const PixelTrack& track : file->tracks)
    for (const TrackPixel& pixel : track.pixels) {
      if (!pixel.visible) continue;
      seen = true;
      whole = whole && IsWhole(pixel.pixel);
      half = half && IsWhole(pixel.pixel - Eigen::Vector2d(0.5, 0.5));
    }
  if (!seen)
    return {ErrorCode::kInsufficient, Quoted(path) + " has no point that is seen in a frame" +
                                          (file->tracks.empty() ? ": it has no track"
                                           : file->frames       ? ": all of its visibility is False"
                                                                : "")};
  if (whole || half)
    file->notes.push_back("the pixels in " + Quoted(path) + " are whole numbers" + (half ? " and a half" : "") +
                          ": rounded pixels are off by 0.29 px, root mean square; give fractions where the tracker "
                          "has them");
  return Status::Ok();
}

// As what its first bytes say that it is.
Result<TrackFile> ReadByContent(const std::string& path) {
  if (!Exists(path)) return Status(ErrorCode::kNotFound, "there is no file of tracks at " + Quoted(path));
  if (Status status = CheckIsFile(path); !status.ok()) return status;
  std::string begin(kSqliteMagic.size(), '\0');
  std::ifstream(path, std::ios::binary).read(begin.data(), static_cast<std::streamsize>(begin.size()));
  if (begin == kSqliteMagic) return ReadTrackDatabase(path);
  if (!IsNpy(begin) && !IsZip(begin)) return ReadTrackCsv(path);
  const auto bytes = ReadFile(path);
  if (!bytes.ok()) return bytes.status();
  return ReadTrackArrays(path, *bytes);
}

}  // namespace

Result<TrackFile> ReadTrackFile(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    return Status(ErrorCode::kUnreadable, Quoted(path) + " is a folder; name the file of the tracks");
  auto file = ReadByContent(path);
  if (!file.ok()) return file;
  if (Status status = CheckPixels(path, &*file); !status.ok()) return status;
  return file;
}

Status WriteTrackCsv(const std::string& path, std::span<const PixelTrack> tracks) {
  bool sigmas = false;
  std::map<int, std::map<PointId, const TrackPixel*>> frames;
  for (const PixelTrack& track : tracks)
    for (const TrackPixel& seen : track.pixels) {
      if (!seen.visible) continue;
      frames[seen.frame_idx][track.id] = &seen;
      sigmas = sigmas || seen.sigma_px > 0;
    }
  FileGroup group;
  auto file = group.Create(path);
  if (!file.ok()) return file.status();
  std::string rows = sigmas ? "frame,track_id,u_px,v_px,sigma_px\n" : "frame,track_id,u_px,v_px\n";
  Status status;
  for (const auto& [frame_idx, points] : frames) {
    for (const auto& [id, seen] : points) {
      AppendInt(&rows, frame_idx);
      rows += ',';
      AppendInt(&rows, id.value);
      for (const double coordinate : seen->pixel) {
        rows += ',';
        AppendFixed(&rows, coordinate, 4);
      }
      if (sigmas) {
        rows += ',';
        AppendFixed(&rows, seen->sigma_px, 4);
      }
      rows += '\n';
    }
    if (status = file->AppendWhenLarge(&rows); !status.ok()) return status;
  }
  status = file->Append(rows);
  if (status.ok()) status = file->Close();
  return status.ok() ? group.Commit() : status;
}

}  // namespace pliant
