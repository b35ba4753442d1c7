// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "io/ply_reader.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <optional>

#include "pliant/base/files.h"
#include "pliant/base/options.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

Status UnreadablePly(const std::string& path, const std::string& what) {
  return {ErrorCode::kUnreadable, Quoted(path) + " " + what};
}

// A number of the machine's own byte order, which is the files'.
template <class Number>
double NumberAt(std::string_view bytes, std::size_t offset) {
  Number value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return static_cast<double>(value);
}

struct PlyProperty {
  std::string name;
  std::size_t width = 0;  // bytes
  bool is_float = false;
  std::size_t offset = 0;  // of a vertex's bytes
  std::size_t column = 0;

  // Of a vertex whose bytes begin at `vertex`.
  double At(std::string_view data, std::size_t vertex) const {
    return width == 4 ? NumberAt<float>(data, vertex + offset) : NumberAt<double>(data, vertex + offset);
  }
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
    if (known.name == type) return PlyProperty{std::string(name), known.width, known.is_float, 0, 0};
  return std::nullopt;
}

struct PlyHeader {
  bool binary = false;
  std::size_t vertices = 0;
  std::vector<PlyProperty> properties;  // of a vertex
  std::size_t stride = 0;               // bytes of a vertex
  std::size_t end = 0;                  // where the data begin

  // Null: there is no such one, or it is not a float.
  const PlyProperty* Find(std::string_view name) const {
    const PlyProperty* found = nullptr;
    for (const PlyProperty& property : properties)
      if (property.name == name && property.is_float) found = &property;
    return found;
  }
};

using Wanted = std::array<const PlyProperty*, 4>;  // x, y, z, sigma; the last one null: there is none

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
        return UnreadablePly(
            path, "is a PLY of the format " + std::string(words[1]) + "; write it little-endian or as ASCII");
      header.binary = words[1] == "binary_little_endian";
    } else if (words[0] == "element" && words.size() > 2) {
      in_vertex = words[1] == "vertex";
      double count = 0;
      if (in_vertex && (!first_element || !ParseDouble(words[2], &count) || !(count >= 0 && count <= 1e9)))
        return UnreadablePly(path, "has no valid number of vertices in its header");
      if (in_vertex) header.vertices = static_cast<std::size_t>(count);
      first_element = false;
    } else if (words[0] == "property" && in_vertex) {
      const auto property = words.size() == 3 ? PropertyOf(words[1], words[2]) : std::nullopt;
      if (!property)
        return UnreadablePly(path, "has a property of its vertices that is not a number: " + std::string(line));
      header.properties.push_back(*property);
      header.properties.back().offset = header.stride;
      header.properties.back().column = header.properties.size() - 1;
      header.stride += property->width;
    }
  }
  return UnreadablePly(path, "is a PLY without the end of its header");
}

Status IsCutOff(const std::string& path, const PlyHeader& header) {
  return UnreadablePly(path, "is cut off: its header says " + std::to_string(header.vertices) + " vertices");
}

void Append(const std::array<double, 4>& numbers, const Wanted& wanted, PlyVertices* vertices) {
  vertices->positions.emplace_back(numbers[0], numbers[1], numbers[2]);
  if (wanted[3] != nullptr) vertices->sigmas.push_back(numbers[3]);
}

Result<PlyVertices> ReadBinary(const std::string& path, const PlyHeader& header, const Wanted& wanted,
                               std::string_view data) {
  if (data.size() / header.stride < header.vertices) return IsCutOff(path, header);
  PlyVertices vertices;
  for (std::size_t i = 0; i < header.vertices; ++i) {
    std::array<double, 4> numbers{};
    for (std::size_t k = 0; k < wanted.size(); ++k)
      if (wanted[k] != nullptr) numbers[k] = wanted[k]->At(data, i * header.stride);
    Append(numbers, wanted, &vertices);
  }
  return vertices;
}

Result<PlyVertices> ReadAscii(const std::string& path, const PlyHeader& header, const Wanted& wanted,
                              std::string_view data) {
  PlyVertices vertices;
  for (std::size_t at = 0; vertices.positions.size() < header.vertices;) {
    if (at >= data.size()) return IsCutOff(path, header);
    const std::size_t end = std::min(data.find('\n', at), data.size());
    std::string_view line = data.substr(at, end - at);
    at = end + 1;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    const auto fields = Split(line, ' ');
    std::array<double, 4> numbers{};
    for (std::size_t k = 0; k < wanted.size(); ++k)
      if (wanted[k] != nullptr &&
          (wanted[k]->column >= fields.size() || !ParseDouble(fields[wanted[k]->column], &numbers[k])))
        return UnreadablePly(path,
                             "has a vertex that is not written as numbers: '" + std::string(line.substr(0, 60)) + "'");
    Append(numbers, wanted, &vertices);
  }
  return vertices;
}

}  // namespace

Result<PlyVertices> ParsePlyVertices(const std::string& path, std::string_view bytes) {
  const auto header = ReadPlyHeader(path, bytes);
  if (!header.ok()) return header.status();
  const Wanted wanted = {header->Find("x"), header->Find("y"), header->Find("z"), header->Find("sigma")};
  if (std::any_of(wanted.begin(), wanted.begin() + 3, [](const PlyProperty* property) { return property == nullptr; }))
    return UnreadablePly(path, "has no x, y and z of its vertices as floats");
  const std::string_view data = bytes.substr(header->end);
  return header->binary ? ReadBinary(path, *header, wanted, data) : ReadAscii(path, *header, wanted, data);
}

Result<PlyVertices> ReadPlyVertices(const std::string& path) {
  const auto bytes = ReadFile(path);
  if (!bytes.ok()) return bytes.status();
  if (!bytes->starts_with("ply")) return UnreadablePly(path, "is not what its name says; copy it again");
  return ParsePlyVertices(path, *bytes);
}

}  // namespace pliant
