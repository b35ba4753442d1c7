// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <filesystem>
#include <utility>

#include "colmap/sqlite.h"
#include "exchange/exports.h"
#include "exchange/program.h"
#include "pliant/base/text.h"
#include "pliant/colmap/convert.h"

namespace pliant {
namespace {

constexpr std::int64_t kPairFactor = 2147483647;  // pair_id = this * smaller image id + larger
constexpr std::int64_t kCalibrated = 2;           // TwoViewGeometry::CALIBRATED
constexpr std::int64_t kCameraSensor = 0;

std::int64_t ImageId(const SourceFrame& frame) { return ColmapImageId(frame.frame_idx); }

// Which keypoint a frame's tracks have, by track.
using FrameTracks = std::vector<std::pair<PointId, std::uint32_t>>;

// The matches of two frames: rows of two keypoint indices.
SqliteBlob Matches(const FrameTracks& a, const FrameTracks& b, std::int64_t* count) {
  SqliteBlob blob;
  auto in_b = b.begin();
  for (const auto& [id, keypoint] : a) {
    while (in_b != b.end() && in_b->first < id) ++in_b;
    if (in_b == b.end()) break;
    if (in_b->first != id) continue;
    AppendBytes(&blob.bytes, keypoint, 4);
    AppendBytes(&blob.bytes, in_b->second, 4);
    ++*count;
  }
  return blob;
}

Status AddCamera(SqliteDatabase& database, const Camera& camera) {
  auto row = SqliteInsert::Create(database, "cameras",
                                  {"camera_id", "model", "width", "height", "params", "prior_focal_length"});
  if (!row.ok()) return row.status();
  const colmap::Camera converted = colmap::FromPliant(camera, 1);
  SqliteBlob params;
  for (const double param : converted.params) AppendDouble(&params.bytes, param);
  return row->Add({std::int64_t{1}, std::int64_t{converted.model_id}, static_cast<std::int64_t>(converted.width),
                   static_cast<std::int64_t>(converted.height), params, std::int64_t{1}});
}

// Since COLMAP 3.12: one rig of one camera, one frame an image.
Status AddRigs(SqliteDatabase& database, const RunSource& source) {
  const auto columns = database.Columns("rigs");
  if (!columns.ok()) return columns.status();
  if (columns->empty()) return Status::Ok();
  auto rig = SqliteInsert::Create(database, "rigs", {"rig_id", "ref_sensor_id", "ref_sensor_type"});
  if (!rig.ok()) return rig.status();
  if (Status status = rig->Add({std::int64_t{1}, std::int64_t{1}, kCameraSensor}); !status.ok()) return status;
  auto frames = SqliteInsert::Create(database, "frames", {"frame_id", "rig_id"});
  if (!frames.ok()) return frames.status();
  auto data = SqliteInsert::Create(database, "frame_data", {"frame_id", "data_id", "sensor_id", "sensor_type"});
  if (!data.ok()) return data.status();
  for (const SourceFrame& frame : source.frames) {
    if (Status status = frames->Add({ImageId(frame), std::int64_t{1}}); !status.ok()) return status;
    if (Status status = data->Add({ImageId(frame), ImageId(frame), std::int64_t{1}, kCameraSensor}); !status.ok())
      return status;
  }
  return Status::Ok();
}

// Images with their keypoints; returns which tracks each has.
Result<std::vector<FrameTracks>> AddImages(SqliteDatabase& database, const RunSource& source) {
  auto images = SqliteInsert::Create(database, "images", {"image_id", "name", "camera_id"});
  if (!images.ok()) return images.status();
  auto keypoints = SqliteInsert::Create(database, "keypoints", {"image_id", "rows", "cols", "data"});
  if (!keypoints.ok()) return keypoints.status();
  std::vector<FrameTracks> tracks;
  const Status status = ForEachFrame(source, [&](const SourceFrame& frame, const auto& observations) {
    if (Status added = images->Add({ImageId(frame), frame.name, std::int64_t{1}}); !added.ok()) return added;
    SqliteBlob pixels;
    FrameTracks& of_frame = tracks.emplace_back();
    for (const PointObservation& o : observations) {
      of_frame.emplace_back(o.id, static_cast<std::uint32_t>(of_frame.size()));
      const colmap::Point2D point = colmap::FromPliant(o.pixel, 0);
      AppendFloat(&pixels.bytes, static_cast<float>(point.x));
      AppendFloat(&pixels.bytes, static_cast<float>(point.y));
    }
    std::sort(of_frame.begin(), of_frame.end());
    return keypoints->Add(
        {ImageId(frame), static_cast<std::int64_t>(observations.size()), std::int64_t{2}, std::move(pixels)});
  });
  if (!status.ok()) return status;
  return tracks;
}

// Matches of every two images whose distance is a power of two: all of a track hangs together, and the number of pairs
// is n log n.
Status AddMatches(SqliteDatabase& database, const RunSource& source, const std::vector<FrameTracks>& tracks,
                  std::int64_t min_matches) {
  auto matches = SqliteInsert::Create(database, "matches", {"pair_id", "rows", "cols", "data"});
  if (!matches.ok()) return matches.status();
  auto verified = SqliteInsert::Create(database, "two_view_geometries", {"pair_id", "rows", "cols", "data", "config"});
  if (!verified.ok()) return verified.status();
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    for (std::size_t step = 1; i + step < tracks.size(); step *= 2) {
      std::int64_t count = 0;
      const SqliteBlob blob = Matches(tracks[i], tracks[i + step], &count);
      if (count < min_matches) continue;
      const std::int64_t pair_id = kPairFactor * ImageId(source.frames[i]) + ImageId(source.frames[i + step]);
      if (Status status = matches->Add({pair_id, count, std::int64_t{2}, blob}); !status.ok()) return status;
      if (Status status = verified->Add({pair_id, count, std::int64_t{2}, blob, kCalibrated}); !status.ok())
        return status;
    }
  }
  return Status::Ok();
}

Status Fill(const std::string& path, const RunSource& source, const ExportOptions& options) {
  auto database = SqliteDatabase::Open(path);
  if (!database.ok()) return database.status();
  // COLMAP's keeps what is committed in a log beside it, which is not renamed with it.
  Status status = database->Execute("PRAGMA journal_mode=DELETE");
  if (status.ok()) status = database->Execute("BEGIN");
  if (status.ok()) status = AddCamera(*database, source.camera);
  if (!status.ok()) return status;
  const auto tracks = AddImages(*database, source);
  if (!tracks.ok()) return tracks.status();
  status = AddRigs(*database, source);
  if (status.ok()) status = AddMatches(*database, source, *tracks, options.min_matches);
  if (status.ok()) status = database->Execute("COMMIT");
  return status;
}

}  // namespace

Status ExportDatabase(const RunSource& source, const ExportOptions& options, const ExportFolder& folder) {
  const std::string path = folder.Path("database.db");
  const std::string log = folder.place + "/database_creator.log";  // stays after a failure
  std::error_code error;
  std::filesystem::create_directories(folder.place, error);
  // The program that is installed knows its own schema.
  Status status = RunProgram({"colmap", "database_creator", "--database_path", path}, log);
  if (status.ok()) status = Fill(path, source, options);
  if (!status.ok()) return status;
  for (const char* log_of_former : {"database.db-wal", "database.db-shm", "database_creator.log"})
    std::filesystem::remove(std::filesystem::path(folder.place) / log_of_former, error);
  return Status::Ok();
}

}  // namespace pliant
