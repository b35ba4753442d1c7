// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/set_files.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <utility>

#include "pliant/base/files.h"
#include "pliant/base/options.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> FilesOf(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator(); entry.increment(error))
    if (std::error_code ignored; entry->is_regular_file(ignored)) files.push_back(entry->path());
  return files;
}

constexpr double kQuaternionError = 0.01;
constexpr double kRounding = 1e-6;
constexpr int kMaxFrames = 10'000'000;

}  // namespace

std::map<int, fs::path> NumberedFiles(const fs::path& folder, std::string_view prefix, std::string_view suffix) {
  std::map<int, fs::path> found;
  for (const fs::path& file : FilesOf(folder)) {
    const std::string name = file.filename().string();
    if (name.size() <= prefix.size() + suffix.size() || !name.starts_with(prefix) || !name.ends_with(suffix)) continue;
    const char* begin = name.data() + prefix.size();
    const char* end = name.data() + name.size() - suffix.size();
    int number = 0;
    const auto parsed = std::from_chars(begin, end, number);
    if (parsed.ec == std::errc() && parsed.ptr == end && number >= 0 && number < kMaxFrames)
      found.emplace(number, file);
  }
  return found;
}

fs::path AnyFile(const fs::path& folder, std::string_view prefix) {
  for (const fs::path& file : FilesOf(folder))
    if (file.filename().string().starts_with(prefix)) return file;
  return {};
}

std::vector<fs::path> VideosIn(const fs::path& folder) {
  constexpr std::string_view kEndings[] = {".mp4", ".avi", ".mov", ".mkv", ".m4v", ".webm", ".mpg", ".mpeg", ".wmv"};
  std::vector<fs::path> videos;
  for (const fs::path& file : FilesOf(folder)) {
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (std::find(std::begin(kEndings), std::end(kEndings), ending) != std::end(kEndings)) videos.push_back(file);
  }
  std::sort(videos.begin(), videos.end());
  return videos;
}

fs::path OnlyFile(const fs::path& folder, std::string_view suffix) {
  fs::path only;
  for (const fs::path& file : FilesOf(folder)) {
    const std::string name = file.filename().string();
    if (!name.ends_with(suffix) || name.starts_with(".")) continue;
    if (!only.empty()) return {};
    only = file;
  }
  return only;
}

bool ListedFiles::Has(const fs::path& file) {
  const fs::path folder = file.parent_path();
  const auto [known, is_new] = files_.try_emplace(folder);
  if (is_new)
    for (const fs::path& found : FilesOf(folder)) known->second.insert(found.filename());
  const bool has = known->second.contains(file.filename());
  if (!has) ++missing_;
  return has;
}

void ListedFiles::WarnOfMissing(const fs::path& list, std::vector<std::string>* warnings) const {
  if (missing_ > 0)
    warnings->push_back(std::to_string(missing_) + " files that " + list.string() +
                        " names are not there; they are passed over");
}

std::string Trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return std::string(text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1));
}

Result<std::vector<NumberRow>> ReadNumberRows(const fs::path& file, std::size_t columns) {
  auto reader = LineReader::Open(file.string());
  if (!reader.ok()) return reader.status();
  std::vector<NumberRow> rows;
  std::string_view line;
  bool first = true;
  while (reader->Next(&line)) {
    const std::vector<std::string_view> words = Words(line);
    if (words.empty() || words.front().starts_with('#')) continue;
    auto numbers = ParseNumbers(line);
    const bool is_header = first && !numbers && std::isalpha(static_cast<unsigned char>(words.front().front())) != 0;
    first = false;
    if (is_header) continue;
    if (!numbers || numbers->size() < columns)
      return reader->Error("a line needs " + std::to_string(columns) + " numbers; '" + std::string(line.substr(0, 60)) +
                           "' does not have them");
    rows.push_back({reader->number(), *std::move(numbers)});
  }
  if (Status status = reader->End(); !status.ok()) return status;
  return rows;
}

Result<Rigid3> PoseOfRow(const fs::path& file, const NumberRow& row, const PoseColumns& columns) {
  const std::vector<double>& n = row.numbers;
  const Eigen::Quaterniond rotation(n[columns.qw], n[columns.qx], n[columns.qx + 1], n[columns.qx + 2]);
  if (!(std::abs(rotation.norm() - 1.0) < kQuaternionError))
    return Status(ErrorCode::kUnreadable,
                  PathAndLine(file.string(), row.line) + ": the quaternion is not of unit length");
  return Rigid3(rotation, Eigen::Vector3d(n[columns.tx], n[columns.tx + 1], n[columns.tx + 2]));
}

Result<Rigid3> PoseOfMatrix(const std::string& where, const std::vector<double>& m) {
  const Eigen::RowVector4d last(m[12], m[13], m[14], m[15]);
  if ((last - Eigen::RowVector4d(0, 0, 0, 1)).norm() > kRounding)
    return Status(ErrorCode::kUnreadable, where + ": the matrix is not a pose; its last row is not 0 0 0 1");
  Eigen::Matrix3d rotation;
  rotation << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
  if (!(rotation * rotation.transpose()).isIdentity(kQuaternionError) || !(rotation.determinant() > 0.0))
    return Status(ErrorCode::kUnreadable,
                  where + ": the matrix is not a pose; its first three columns are not a rotation");
  return Rigid3(rotation, Eigen::Vector3d(m[3], m[7], m[11]));
}

Rigid3 Mirrored(const Rigid3& world_from_cam, const Eigen::Vector3d& axes) {
  return {Eigen::Matrix3d(axes.asDiagonal() * world_from_cam.RotationMatrix() * axes.asDiagonal()),
          axes.cwiseProduct(world_from_cam.translation)};
}

Rigid3 FromUnity(const Rigid3& world_from_cam) { return Mirrored(world_from_cam, {1, -1, 1}); }

std::vector<std::optional<Rigid3>> PosesAt(const std::vector<double>& times_s, const std::vector<TimedPose>& poses,
                                           double unit_mm, double most_s, const Rigid3& body_from_cam) {
  std::map<double, Rigid3> by_time;
  for (const auto& [time_s, pose] : poses)
    by_time.emplace(time_s, Rigid3(pose.rotation, unit_mm * pose.translation) * body_from_cam);
  std::vector<std::optional<Rigid3>> found;
  for (const double time_s : times_s) {
    const Rigid3* nearest = NearestInTime(by_time, time_s, most_s);
    found.push_back(nearest != nullptr ? std::optional(*nearest) : std::nullopt);
  }
  return found;
}

}  // namespace pliant
