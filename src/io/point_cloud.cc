// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/point_cloud.h"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <utility>

#include "io/npy.h"
#include "io/ply_reader.h"
#include "pliant/base/files.h"
#include "pliant/base/options.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

using Points = std::vector<Eigen::Vector3d>;

Status Unreadable(const std::string& path, const std::string& what) {
  return {ErrorCode::kUnreadable, Quoted(path) + " " + what};
}

Result<Points> ReadNpy(const std::string& path, std::string_view bytes) {
  const auto array = ParseNpy(Quoted(path), bytes);
  if (!array.ok()) return array.status();
  if (array->kind != NpyArray::Kind::kFloat || array->shape.size() != 2 || array->shape[1] < 3)
    return Unreadable(path, "is not an array of N x 3 floats, but of the shape " + ShapeText(array->shape) +
                                " and the type " + array->type + "; save it as np.float32 of this shape");
  Points points;
  for (std::size_t i = 0; i < array->shape[0]; ++i) {
    const std::size_t first = i * array->shape[1];
    points.emplace_back(array->At(first), array->At(first + 1), array->At(first + 2));
  }
  return points;
}

Result<Points> ReadPly(const std::string& path, std::string_view bytes) {
  auto vertices = ParsePlyVertices(path, bytes);
  if (!vertices.ok()) return vertices.status();
  return std::move(vertices->positions);
}

Result<Points> ReadTextCloud(const std::string& path) {
  auto reader = LineReader::Open(path);
  if (!reader.ok()) return reader.status();
  Points points;
  std::string_view line;
  while (reader->Next(&line)) {
    const auto fields = Words(line);
    if (fields.empty() || fields[0].starts_with('#')) continue;
    Eigen::Vector3d point;
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      if (static_cast<std::size_t>(axis) >= fields.size() ||
          !ParseDouble(fields[static_cast<std::size_t>(axis)], &point[axis]))
        return reader->Error("a point has three numbers");
    points.push_back(point);
  }
  if (Status status = reader->End(); !status.ok()) return status;
  return points;
}

}  // namespace

Result<Points> ReadPointCloud(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  Result<Points> points = Status(ErrorCode::kUnreadable, "");
  if (extension == ".npy" || extension == ".ply") {
    const auto bytes = ReadFile(path);
    if (!bytes.ok()) return bytes.status();
    const bool is_npy = IsNpy(*bytes);
    if (!is_npy && !bytes->starts_with("ply")) return Unreadable(path, "is not what its name says; copy it again");
    points = is_npy ? ReadNpy(path, *bytes) : ReadPly(path, *bytes);
  } else {
    points = ReadTextCloud(path);
  }
  if (!points.ok()) return points.status();
  std::erase_if(*points, [](const Eigen::Vector3d& point) { return !point.allFinite(); });
  if (points->empty()) return Status(ErrorCode::kInsufficient, Quoted(path) + " has no point");
  return points;
}

}  // namespace pliant
