// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What the files of other people's data sets have in common: numbers in names, tables of numbers, depth images.
#pragma once

#include <cmath>
#include <filesystem>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pliant/base/status.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/io/trajectory.h"

namespace pliant {

inline constexpr double kMeter_mm = 1000.0;
// Times that differ by no more belong to the same moment.
inline constexpr double kMaxDifference_s = 0.02;

// The files of a folder that are called PREFIX, digits, SUFFIX, by number; none where there is no folder.
std::map<int, std::filesystem::path> NumberedFiles(const std::filesystem::path& folder, std::string_view prefix,
                                                   std::string_view suffix);
// A file of a folder whose name begins like this, "" where there is none.
std::filesystem::path AnyFile(const std::filesystem::path& folder, std::string_view prefix);
// The files of a folder whose endings are those of videos, in the order of their names.
std::vector<std::filesystem::path> VideosIn(const std::filesystem::path& folder);
// The only file in a folder with this ending, "" where there is none or several.
std::filesystem::path OnlyFile(const std::filesystem::path& folder, std::string_view suffix);

// Which files that a list names are there, asked folder by folder instead of file by file.
class ListedFiles {
 public:
  bool Has(const std::filesystem::path& file);
  // How many of those asked for are not there, if any.
  void WarnOfMissing(const std::filesystem::path& list, std::vector<std::string>* warnings) const;

 private:
  std::map<std::filesystem::path, std::set<std::filesystem::path>> files_;  // by their folder
  int missing_ = 0;
};

// Without blanks, tabs and carriage returns at its ends.
std::string Trimmed(std::string_view text);

struct NumberRow {
  std::int64_t line = 0;  // in the file
  std::vector<double> numbers;
};

// Lines of at least `columns` numbers between blanks, commas or semicolons; empty lines, comments with # and a first
// line of names are passed over. Fails with kNotFound, and with kUnreadable for a line that is none.
Result<std::vector<NumberRow>> ReadNumberRows(const std::filesystem::path& file, std::size_t columns);

// A pose of position and quaternion. Fails with kUnreadable and the line for a quaternion that is none.
struct PoseColumns {
  std::size_t tx = 0;
  std::size_t qx = 3;
  std::size_t qw = 6;  // before qx: qw qx qy qz
};
Result<Rigid3> PoseOfRow(const std::filesystem::path& file, const NumberRow& row, const PoseColumns& columns);

// Of a 4 x 4 matrix, rows first. Fails with kUnreadable where its rotation is none.
Result<Rigid3> PoseOfMatrix(const std::string& where, const std::vector<double>& matrix);

// The value nearest in time; null where none is within `most_s`.
template <class Value>
const Value* NearestInTime(const std::map<double, Value>& values, double time_s, double most_s) {
  auto nearest = values.lower_bound(time_s);
  if (nearest != values.begin() &&
      (nearest == values.end() || time_s - std::prev(nearest)->first < nearest->first - time_s))
    --nearest;
  return nearest != values.end() && std::abs(nearest->first - time_s) <= most_s ? &nearest->second : nullptr;
}

// A world and a camera whose axes are turned round where `axes` is -1.
Rigid3 Mirrored(const Rigid3& world_from_cam, const Eigen::Vector3d& axes);
// Unity's left-handed ones, right-handed: y turned round.
Rigid3 FromUnity(const Rigid3& world_from_cam);

// Of each time the pose nearest to it, as NearestInTime, in mm: that of a camera at body_from_cam.
std::vector<std::optional<Rigid3>> PosesAt(const std::vector<double>& times_s, const std::vector<TimedPose>& poses,
                                           double unit_mm, double most_s, const Rigid3& body_from_cam = {});

// Makes millimeters of what a depth image's file holds.
using ReadDepth = std::function<Result<cv::Mat>(const std::filesystem::path& file)>;

}  // namespace pliant
