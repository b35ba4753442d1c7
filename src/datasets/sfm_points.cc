// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/sfm_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "pliant/base/files.h"
#include "pliant/base/text.h"
#include "pliant/colmap/convert.h"
#include "pliant/colmap/model.h"
#include "pliant/datasets/native_layout.h"

namespace pliant {
namespace {

constexpr std::array<std::string_view, 4> kColumns = {"frame", "u_px", "v_px", "depth"};
using ColumnPlaces = std::array<std::size_t, kColumns.size()>;

Result<ColumnPlaces> FindColumns(const LineReader& reader, const std::vector<std::string_view>& header) {
  ColumnPlaces places{};
  for (std::size_t i = 0; i < kColumns.size(); ++i) {
    const auto found = std::find(header.begin(), header.end(), kColumns[i]);
    if (found == header.end())
      return reader.Error("the header has no column " + std::string(kColumns[i]) +
                          "; it must name frame,u_px,v_px,depth");
    places[i] = static_cast<std::size_t>(found - header.begin());
  }
  return places;
}

Status AddRow(const LineReader& reader, const std::vector<std::string_view>& fields, const ColumnPlaces& places,
              SfmPoints* points) {
  std::int64_t frame_idx = 0;
  if (!ParseInt64(fields[places[0]], &frame_idx) || frame_idx < 0 || frame_idx > std::numeric_limits<int>::max())
    return reader.Error(Quoted(fields[places[0]]) + " is not the number of a frame");
  std::array<double, 3> values{};
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!ParseFinite(fields[places[i + 1]], &values[i]))
      return reader.Error(Quoted(fields[places[i + 1]]) + " is not a finite number; leave out what is not known");
  if (!(values[2] > 0))
    return reader.Error("the depth " + std::string(fields[places[3]]) +
                        " is not positive; leave out points behind the "
                        "camera");
  (*points)[static_cast<int>(frame_idx)].push_back({{values[0], values[1]}, values[2]});
  return Status::Ok();
}

// By the file names of frames: their numbers.
std::map<std::string, int> FramesByName(const Sequence& sequence) {
  std::map<std::string, int> frames;
  for (int idx = 0; idx < sequence.size(); ++idx)
    if (const auto name = sequence.Name(idx)) frames.emplace(std::filesystem::path(*name).filename().string(), idx);
  return frames;
}

Status CheckSize(const colmap::Model& model, const std::filesystem::path& folder, const Camera& camera) {
  const auto size = [](auto width, auto height) { return std::to_string(width) + "x" + std::to_string(height); };
  const std::string ours = size(camera.width(), camera.height());
  for (const colmap::Camera& theirs : model.cameras)
    if (size(theirs.width, theirs.height) != ours)
      return {ErrorCode::kMismatch, "the model " + folder.string() + " has images of " +
                                        size(theirs.width, theirs.height) + " and the sequence has " + ours +
                                        "; reconstruct from the images of the sequence"};
  return Status::Ok();
}

std::vector<SfmPoint> PointsOf(const colmap::Image& image, const Rigid3& cam_from_world,
                               const colmap::PointsById& points3D) {
  std::vector<SfmPoint> points;
  for (const colmap::Point2D& keypoint : image.points2D) {
    const auto point = points3D.find(keypoint.point3D_id);
    if (point == points3D.end()) continue;
    const double depth = (cam_from_world * colmap::ToPliant(*point->second)).z();
    if (depth > 0) points.push_back({colmap::ToPliant(keypoint), depth});
  }
  return points;
}

}  // namespace

Result<SfmPoints> ReadSfmPoints(const std::filesystem::path& path) {
  auto reader = LineReader::Open(path.string());
  if (!reader.ok()) return reader.status();
  SfmPoints points;
  std::optional<ColumnPlaces> places;
  std::size_t columns = 0;
  std::string_view line;
  while (reader->Next(&line)) {
    const std::vector<std::string_view> fields = Split(line, ',');
    if (!places) {
      const Result<ColumnPlaces> found = FindColumns(*reader, fields);
      if (!found.ok()) return found.status();
      places = *found;
      columns = fields.size();
      continue;
    }
    if (line.empty()) continue;
    if (fields.size() != columns)
      return reader->Error("a row has " + std::to_string(fields.size()) + " columns and the header has " +
                           std::to_string(columns));
    if (Status status = AddRow(*reader, fields, *places, &points); !status.ok()) return status;
  }
  if (Status status = reader->End(); !status.ok()) return status;
  if (!places)
    return Status(ErrorCode::kUnreadable, path.string() + " is empty; its first line must be frame,u_px,v_px,depth");
  return points;
}

Result<SfmPoints> ReadSfmModel(const std::filesystem::path& folder, const Sequence& sequence) {
  const auto model = colmap::ReadModel(folder.string());
  if (!model.ok()) return model.status();
  if (Status status = CheckSize(*model, folder, sequence.camera()); !status.ok()) return status;
  const std::map<std::string, int> frames = FramesByName(sequence);
  const colmap::PointsById points3D = colmap::ById(model->points3D);
  SfmPoints points;
  for (const colmap::Image& image : model->images) {
    const auto frame = frames.find(std::filesystem::path(image.name).filename().string());
    if (frame == frames.end()) continue;
    const auto cam_from_world = colmap::ToPliant(image.cam_from_world);
    if (!cam_from_world.ok()) return cam_from_world.status();
    points[frame->second] = PointsOf(image, *cam_from_world, points3D);
  }
  if (points.empty())
    return Status(ErrorCode::kMismatch, "none of the " + std::to_string(model->images.size()) +
                                            " images of the model " + folder.string() +
                                            " has the name of an image of the sequence; give the model of its images");
  return points;
}

Result<SfmPoints> ReadSfmPointsOfSequence(const std::filesystem::path& path) {
  const std::filesystem::path file = path / native::kSfmPointsFile;
  std::error_code error;
  if (!std::filesystem::is_directory(path / native::kImageFolder, error) || !Exists(file.string())) return SfmPoints();
  return ReadSfmPoints(file);
}

}  // namespace pliant
