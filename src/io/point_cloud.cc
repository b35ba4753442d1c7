// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/point_cloud.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "io/npy.h"
#include "pliant/base/files.h"
#include "pliant/base/options.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

using Points = std::vector<Eigen::Vector3d>;

Status Unreadable(const std::string& path, const std::string& what) {
  return {ErrorCode::kUnreadable, Quoted(path) + " " + what};
}

// A number of the machine's own byte order, which is the files'.
template <class Number>
double At(std::string_view bytes, std::size_t offset) {
  Number value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return static_cast<double>(value);
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

struct PlyProperty {
  std::string name;
  std::size_t width = 0;  // bytes
  bool is_float = false;
};

std::optional<PlyProperty> PropertyOf(std::string_view type, std::string_view name) {
  struct Type {
    std::string_view name;
    std::size_t width;
    bool is_float;
  };
  constexpr Type kTypes[] = {{"char", 1, false},  {"uchar", 1, false},  {"int8", 1, false},  {"uint8", 1, false},
                             {"short", 2, false}, {"ushort", 2, false}, {"int16", 2, false}, {"uint16", 2, false},
                             {"int", 4, false},   {"uint", 4, false},   {"int32", 4, false}, {"uint32", 4, false},
                             {"float", 4, true},  {"float32", 4, true}, {"double", 8, true}, {"float64", 8, true}};
  for (const Type& known : kTypes)
    if (known.name == type) return PlyProperty{std::string(name), known.width, known.is_float};
  return std::nullopt;
}

struct PlyHeader {
  bool binary = false;
  std::size_t vertices = 0;
  std::vector<PlyProperty> properties;  // of a vertex
  std::size_t end = 0;                  // where the data begin
};

// The vertices must come first, as they do in every file that is written in practice.
Result<PlyHeader> ReadPlyHeader(const std::string& path, std::string_view bytes) {
  PlyHeader header;
  bool in_vertex = false;
  bool first_element = true;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
    std::string_view line = bytes.substr(at, end - at);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    at = end + 1;
    const auto words = Split(line, ' ');
    if (words.empty()) continue;
    if (words[0] == "end_header") {
      header.end = std::min(at, bytes.size());
      return header;
    }
    if (words[0] == "format" && words.size() > 1) {
      if (words[1] != "ascii" && words[1] != "binary_little_endian")
        return Unreadable(path,
                          "is a PLY of the format " + std::string(words[1]) + "; write it little-endian or as ASCII");
      header.binary = words[1] == "binary_little_endian";
    } else if (words[0] == "element" && words.size() > 2) {
      in_vertex = words[1] == "vertex";
      double count = 0;
      if (in_vertex && (!first_element || !ParseDouble(words[2], &count) || !(count >= 0 && count <= 1e9)))
        return Unreadable(path, "has no valid number of vertices in its header");
      if (in_vertex) header.vertices = static_cast<std::size_t>(count);
      first_element = false;
    } else if (words[0] == "property" && in_vertex) {
      const auto property = words.size() == 3 ? PropertyOf(words[1], words[2]) : std::nullopt;
      if (!property)
        return Unreadable(path, "has a property of its vertices that is not a number: " + std::string(line));
      header.properties.push_back(*property);
    }
  }
  return Unreadable(path, "is a PLY without the end of its header");
}

Result<Points> ReadPly(const std::string& path, std::string_view bytes) {
  const auto header = ReadPlyHeader(path, bytes);
  if (!header.ok()) return header.status();
  std::array<std::size_t, 3> columns{};
  std::array<std::size_t, 3> offsets{};
  std::array<const PlyProperty*, 3> of{};
  std::size_t stride = 0;
  for (std::size_t column = 0; column < header->properties.size(); ++column) {
    const PlyProperty& property = header->properties[column];
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (property.name == std::string(1, "xyz"[axis]) && property.is_float) {
        columns[axis] = column;
        offsets[axis] = stride;
        of[axis] = &property;
      }
    stride += property.width;
  }
  if (std::any_of(of.begin(), of.end(), [](const PlyProperty* property) { return property == nullptr; }))
    return Unreadable(path, "has no x, y and z of its vertices as floats");
  const std::string_view data = bytes.substr(header->end);
  Points points;
  if (header->binary) {
    if (data.size() / stride < header->vertices)
      return Unreadable(path, "is cut off: its header says " + std::to_string(header->vertices) + " vertices");
    for (std::size_t i = 0; i < header->vertices; ++i) {
      Eigen::Vector3d point;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t offset = i * stride + offsets[axis];
        point[static_cast<Eigen::Index>(axis)] =
            of[axis]->width == 4 ? At<float>(data, offset) : At<double>(data, offset);
      }
      points.push_back(point);
    }
    return points;
  }
  std::size_t at = 0;
  while (points.size() < header->vertices) {
    if (at >= data.size())
      return Unreadable(path, "is cut off: its header says " + std::to_string(header->vertices) + " vertices");
    const std::size_t end = std::min(data.find('\n', at), data.size());
    std::string_view line = data.substr(at, end - at);
    at = end + 1;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    const auto fields = Split(line, ' ');
    Eigen::Vector3d point;
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (columns[axis] >= fields.size() ||
          !ParseDouble(fields[columns[axis]], &point[static_cast<Eigen::Index>(axis)]))
        return Unreadable(path,
                          "has a vertex that is not written as numbers: '" + std::string(line.substr(0, 60)) + "'");
    points.push_back(point);
  }
  return points;
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
