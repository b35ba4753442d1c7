// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/stir_file.h"

#include <cmath>
#include <optional>

#include <nlohmann/json.hpp>

#include "pliant/base/files.h"

namespace pliant {
namespace {

using Json = nlohmann::ordered_json;

// Nothing where it is no list of two or three finite numbers.
std::optional<Eigen::Vector3d> PointOf(const Json& json) {
  if (!json.is_array() || json.size() < 2 || json.size() > 3) return std::nullopt;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < json.size(); ++k) {
    if (!json[k].is_number()) return std::nullopt;
    point[static_cast<Eigen::Index>(k)] = json[k].get<double>();
  }
  return point.allFinite() ? std::optional(point) : std::nullopt;
}

}  // namespace

Result<StirPoints> ReadStirPoints(const std::string& path) {
  const auto text = ReadFile(path);
  if (!text.ok()) return text.status();
  const auto wrong = [&path](const std::string& what) { return Status(ErrorCode::kUnreadable, path + " " + what); };
  const Json json = Json::parse(*text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object())
    return wrong("is not a JSON object of points by recording, such as {\"0/left/seq00\": [[160, 604]]}");
  StirPoints points;
  std::optional<std::size_t> dimensions;
  for (const auto& [recording, list] : json.items()) {
    if (!list.is_array()) return wrong("has no list of points for the recording " + recording);
    std::vector<Eigen::Vector3d>& of_recording = points.of_recording[recording];
    for (const Json& entry : list) {
      const auto point = PointOf(entry);
      if (!point)
        return wrong("has a point of the recording " + recording + " that is not two or three finite numbers");
      if (dimensions.value_or(entry.size()) != entry.size())
        return wrong("has points of two and of three numbers; give either pixels or millimeters");
      dimensions = entry.size();
      of_recording.push_back(*point);
    }
  }
  points.dimensions = static_cast<int>(dimensions.value_or(2));
  return points;
}

Status WriteStirPoints(const StirPoints& points, const std::string& path) {
  Json json = Json::object();
  for (const auto& [recording, of_recording] : points.of_recording) {
    Json list = Json::array();
    for (const Eigen::Vector3d& point : of_recording) {
      Json entry = Json::array();
      for (int k = 0; k < points.dimensions; ++k) entry.push_back(point[k]);
      list.push_back(std::move(entry));
    }
    json[recording] = std::move(list);
  }
  return WriteFileAtomically(path, json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace pliant
