// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/colmap/database.h"

#include <cstring>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "colmap/sqlite.h"
#include "pliant/base/files.h"
#include "pliant/base/text.h"
#include "pliant/colmap/convert.h"

namespace pliant::colmap {
namespace {

constexpr std::int64_t kMaxImageId = 2147483647;  // pair_id = this * smaller image id + larger
constexpr std::int64_t kMaxColumns = 6;           // of keypoints: x, y and a scale and angle, or an affine shape

using PlaceOfImage = std::map<std::int64_t, std::size_t>;

Status Damaged(const std::string& path, const std::string& what) {
  return {ErrorCode::kUnreadable, "the database " + Quoted(path) + " is damaged: " + what};
}

template <class Number>
Number NumberAt(std::string_view bytes, std::size_t i) {
  Number number;
  std::memcpy(&number, bytes.data() + i * sizeof number, sizeof number);
  return number;
}

// Whether the bytes are so many rows and columns of four bytes each.
bool IsMatrix(std::string_view bytes, std::int64_t rows, std::int64_t columns) {
  return rows >= 0 && columns > 0 && columns <= kMaxColumns &&
         bytes.size() / (4 * static_cast<std::size_t>(columns)) == static_cast<std::size_t>(rows) &&
         bytes.size() % (4 * static_cast<std::size_t>(columns)) == 0;
}

// Before anything is read: the tables of COLMAP's that are, as tables.
Status CheckTables(const std::string& path, SqliteDatabase& file) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> tables = {
      {"cameras", {"camera_id", "width", "height"}},
      {"images", {"image_id", "name", "camera_id"}},
      {"keypoints", {"image_id", "rows", "cols", "data"}},
      {"two_view_geometries", {"pair_id", "rows", "cols", "data"}}};
  for (const auto& [table, columns] : tables) {
    const auto is_stored = file.IsStored(table, columns);
    if (!is_stored.ok()) return is_stored.status();
    if (!*is_stored)
      return {ErrorCode::kUnreadable, "the database " + Quoted(path) + " is none of COLMAP's: it has no table " +
                                          table + " with the columns " + CommaSeparated(columns)};
  }
  return Status::Ok();
}

Result<PlaceOfImage> ReadImages(const std::string& path, SqliteDatabase& file, Database* database) {
  auto rows = SqliteQuery::Create(file,
                                  "SELECT images.image_id, images.name, cameras.width, cameras.height FROM images JOIN "
                                  "cameras ON images.camera_id = cameras.camera_id ORDER BY images.image_id");
  if (!rows.ok()) return rows.status();
  PlaceOfImage places;
  while (true) {
    const auto more = rows->Next();
    if (!more.ok()) return more.status();
    if (!*more) return places;
    if (!places.emplace(rows->Int(0), database->images.size()).second)
      return Damaged(path, "image " + std::to_string(rows->Int(0)) + " comes twice, or has two cameras");
    database->images.push_back({std::string(rows->Text(1)),
                                static_cast<std::uint64_t>(rows->Int(2)),
                                static_cast<std::uint64_t>(rows->Int(3)),
                                {}});
  }
}

Status ReadKeypoints(const std::string& path, SqliteDatabase& file, const PlaceOfImage& places, Database* database) {
  auto rows = SqliteQuery::Create(file, "SELECT image_id, rows, cols, data FROM keypoints ORDER BY image_id");
  if (!rows.ok()) return rows.status();
  while (true) {
    const auto more = rows->Next();
    if (!more.ok()) return more.status();
    if (!*more) return Status::Ok();
    const auto place = places.find(rows->Int(0));
    if (place == places.end()) continue;
    const std::string_view bytes = rows->Bytes(3);
    const std::int64_t columns = rows->Int(2);
    DatabaseImage& image = database->images[place->second];
    if (columns < 2 || !IsMatrix(bytes, rows->Int(1), columns))
      return Damaged(path, "the keypoints of the image " + image.name + " have not the size that it says");
    for (std::size_t at = 0; at < bytes.size() / 4; at += static_cast<std::size_t>(columns))
      image.keypoints.push_back(ToPliant(Point2D{NumberAt<float>(bytes, at), NumberAt<float>(bytes, at + 1)}));
  }
}

// Nothing: one of them is not a keypoint of its image.
std::optional<DatabaseMatches> MatchesOf(std::string_view bytes, std::size_t image_a, std::size_t image_b,
                                         const Database& database) {
  DatabaseMatches matches{image_a, image_b, {}};
  for (std::size_t at = 0; at < bytes.size() / 4; at += 2) {
    matches.keypoints.emplace_back(NumberAt<std::uint32_t>(bytes, at), NumberAt<std::uint32_t>(bytes, at + 1));
    if (matches.keypoints.back().first >= database.images[image_a].keypoints.size() ||
        matches.keypoints.back().second >= database.images[image_b].keypoints.size())
      return std::nullopt;
  }
  return matches;
}

Status ReadMatches(const std::string& path, SqliteDatabase& file, const PlaceOfImage& places, Database* database) {
  auto rows = SqliteQuery::Create(
      file, "SELECT pair_id, rows, cols, data FROM two_view_geometries WHERE rows > 0 ORDER BY pair_id");
  if (!rows.ok()) return rows.status();
  while (true) {
    const auto more = rows->Next();
    if (!more.ok()) return more.status();
    if (!*more) return Status::Ok();
    const auto image_a = places.find(rows->Int(0) / kMaxImageId);
    const auto image_b = places.find(rows->Int(0) % kMaxImageId);
    if (image_a == places.end() || image_b == places.end()) continue;
    const std::string_view bytes = rows->Bytes(3);
    auto matches = rows->Int(2) == 2 && IsMatrix(bytes, rows->Int(1), 2)
                       ? MatchesOf(bytes, image_a->second, image_b->second, *database)
                       : std::nullopt;
    if (!matches)
      return Damaged(path, "the matches of the images " + database->images[image_a->second].name + " and " +
                               database->images[image_b->second].name + " are not of their keypoints");
    database->matches.push_back(*std::move(matches));
  }
}

}  // namespace

Result<Database> ReadDatabase(const std::string& path) {
  if (Status status = CheckIsFile(path); !status.ok()) return status;
  auto file = SqliteDatabase::Open(path, SqliteAccess::kRead);
  if (!file.ok()) return file.status();
  Database database;
  if (Status status = CheckTables(path, *file); !status.ok()) return status;
  const auto places = ReadImages(path, *file, &database);
  if (!places.ok()) return places.status();
  Status status = ReadKeypoints(path, *file, *places, &database);
  if (status.ok()) status = ReadMatches(path, *file, *places, &database);
  if (!status.ok()) return status;
  return database;
}

}  // namespace pliant::colmap
