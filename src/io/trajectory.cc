// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/trajectory.h"

#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "io/tum_line.h"
#include "pliant/base/files.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

constexpr double kLargestNormError = 1e-2;  // files with three decimals pass, a file in another order does not

Status ParseTrajectoryFields(std::span<const std::string_view> fields, std::span<double> numbers) {
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (!ParseFinite(fields[i], &numbers[i]))
      return {ErrorCode::kUnreadable, Quoted(fields[i]) + " is not a finite number"};
  return Status::Ok();
}

Result<TimedPose> MakePose(double timestamp_s, const Eigen::Vector3d& position, const Eigen::Quaterniond& rotation) {
  if (!(std::abs(rotation.norm() - 1.0) < kLargestNormError))
    return Status(ErrorCode::kUnreadable, "the quaternion has length " + std::to_string(rotation.norm()) + ", not 1");
  return TimedPose{timestamp_s, Rigid3(rotation, position)};
}

Status CheckLater(const LineReader& reader, const std::vector<TimedPose>& poses, const TimedPose& pose) {
  if (poses.empty() || pose.timestamp_s > poses.back().timestamp_s) return Status::Ok();
  return reader.Error("the time is not after the line before; sort the lines by time");
}

Result<TimedPose> ParseEurocLine(std::string_view line) {
  std::vector<std::string_view> fields = Split(line, ',');
  if (fields.size() < 8)
    return Status(
        ErrorCode::kUnreadable,
        "a line begins with 8 numbers and commas between them (timestamp, position, quaternion w x y z), this "
        "one has " +
            std::to_string(fields.size()));
  fields.resize(8);
  for (std::string_view& field : fields) {
    const std::vector<std::string_view> words = Split(field, ' ');
    field = words.size() == 1 ? words.front() : std::string_view();
  }
  std::array<double, 8> v;
  if (Status status = ParseTrajectoryFields(fields, v); !status.ok()) return status;
  if (v[0] != std::floor(v[0]))
    return Status(ErrorCode::kUnreadable,
                  "the time " + std::string(fields[0]) +
                      " is not a whole number; times of EuRoC are nanoseconds: write seconds as TUM's lines (timestamp "
                      "tx ty tz qx qy qz qw), and read them as tum");
  return MakePose(1e-9 * v[0], {v[1], v[2], v[3]}, Eigen::Quaterniond(v[4], v[5], v[6], v[7]));
}

Result<Rigid3> ParseKittiLine(std::string_view line) {
  const std::vector<std::string_view> fields = Split(line, ' ');
  if (fields.size() != 12)
    return Status(ErrorCode::kUnreadable, "a line has 12 numbers (the matrix [R t], row by row), this one has " +
                                              std::to_string(fields.size()));
  std::array<double, 12> v;
  if (Status status = ParseTrajectoryFields(fields, v); !status.ok()) return status;
  const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> matrix(v.data());
  const Eigen::Matrix3d rotation = matrix.leftCols<3>();
  const Eigen::Matrix3d error = rotation * rotation.transpose() - Eigen::Matrix3d::Identity();
  if (!(error.norm() < kLargestNormError) || !(rotation.determinant() > 0))
    return Status(ErrorCode::kUnreadable, "the first three columns of its matrix are not a rotation");
  return Rigid3(Eigen::Quaterniond(rotation), matrix.col(3));
}

// A value a line, comments aside. `check` sees each value with those before it.
template <class Value, class Parse, class Check>
Result<std::vector<Value>> ReadLines(const std::string& path, Parse parse, Check check, OpenLastLine open_last_line,
                                     int* cut_lines) {
  auto reader = LineReader::Open(path);
  if (!reader.ok()) return reader.status();
  std::vector<Value> values;
  for (std::string_view line; reader->Next(&line);) {
    if (line.starts_with('#') || Split(line, ' ').empty()) continue;
    if (!reader->ended() && open_last_line == OpenLastLine::kIsCut) {
      ++*cut_lines;
      break;
    }
    const auto value = parse(line);
    if (!value.ok()) return reader->Error(value.status().message());
    if (Status status = check(*reader, values, *value); !status.ok()) return status;
    values.push_back(*value);
  }
  if (Status status = reader->End(); !status.ok()) return status;
  return values;
}

}  // namespace

void AppendTumLine(std::string* out, double timestamp_s, const Rigid3& world_from_cam) {
  AppendFixed(out, timestamp_s, 6);
  for (const double value : world_from_cam.translation) {
    out->push_back(' ');
    AppendFixed(out, value, 6);
  }
  for (const double value : world_from_cam.rotation.coeffs()) {  // x y z w
    out->push_back(' ');
    AppendFixed(out, value, 9);
  }
  out->push_back('\n');
}

Result<TimedPose> ParseTumLine(std::string_view line) {
  const std::vector<std::string_view> fields = Split(line, ' ');
  if (fields.size() != 8)
    return Status(ErrorCode::kUnreadable, "a line has 8 numbers (timestamp tx ty tz qx qy qz qw), this one has " +
                                              std::to_string(fields.size()));
  std::array<double, 8> v;
  if (Status status = ParseTrajectoryFields(fields, v); !status.ok()) return status;
  return MakePose(v[0], {v[1], v[2], v[3]}, Eigen::Quaterniond(v[7], v[4], v[5], v[6]));
}

Result<std::vector<TimedPose>> ReadTumTrajectory(const std::string& path) {
  int cut_lines = 0;
  return ReadTumTrajectory(path, OpenLastLine::kIsRead, &cut_lines);
}

Result<std::vector<TimedPose>> ReadTumTrajectory(const std::string& path, OpenLastLine open_last_line, int* cut_lines) {
  return ReadLines<TimedPose>(path, ParseTumLine, CheckLater, open_last_line, cut_lines);
}

Result<std::vector<TimedPose>> ReadEurocTrajectory(const std::string& path) {
  int cut_lines = 0;
  return ReadLines<TimedPose>(path, ParseEurocLine, CheckLater, OpenLastLine::kIsRead, &cut_lines);
}

Result<std::vector<Rigid3>> ReadKittiPoses(const std::string& path) {
  int cut_lines = 0;
  const auto any = [](const LineReader&, const std::vector<Rigid3>&, const Rigid3&) { return Status::Ok(); };
  return ReadLines<Rigid3>(path, ParseKittiLine, any, OpenLastLine::kIsRead, &cut_lines);
}

Status WriteTumTrajectory(const std::string& path, std::span<const TimedPose> poses) {
  std::string text;
  for (const TimedPose& pose : poses) AppendTumLine(&text, pose.timestamp_s, pose.world_from_cam);
  return WriteFileAtomically(path, text);
}

}  // namespace pliant
