// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/trajectory.h"

#include <array>
#include <cmath>

#include "pliant/base/text.h"
#include "io/tum_line.h"

namespace pliant {

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
  constexpr double kLargestNormError = 1e-2;  // files with three decimals pass, a file in another order does not
  const std::vector<std::string_view> fields = Split(line, ' ');
  const auto invalid = [](const std::string& what) { return Status(ErrorCode::kUnreadable, what); };
  if (fields.size() != 8)
    return invalid("a line has 8 numbers (timestamp tx ty tz qx qy qz qw), this one has " +
                   std::to_string(fields.size()));
  std::array<double, 8> v;
  for (std::size_t i = 0; i < 8; ++i)
    if (!ParseFinite(fields[i], &v[i])) return invalid(Quoted(fields[i]) + " is not a finite number");
  const Eigen::Quaterniond rotation(v[7], v[4], v[5], v[6]);
  if (!(std::abs(rotation.norm() - 1.0) < kLargestNormError))
    return invalid("the quaternion has length " + std::to_string(rotation.norm()) + ", not 1");
  return TimedPose{v[0], Rigid3(rotation, Eigen::Vector3d(v[1], v[2], v[3]))};
}

Result<std::vector<TimedPose>> ReadTumTrajectory(const std::string& path) {
  int cut_lines = 0;
  return ReadTumTrajectory(path, OpenLastLine::kIsRead, &cut_lines);
}

Result<std::vector<TimedPose>> ReadTumTrajectory(const std::string& path, OpenLastLine open_last_line, int* cut_lines) {
  auto reader = LineReader::Open(path);
  if (!reader.ok()) return reader.status();
  std::vector<TimedPose> poses;
  for (std::string_view line; reader->Next(&line);) {
    if (line.starts_with('#') || Split(line, ' ').empty()) continue;
    if (!reader->ended() && open_last_line == OpenLastLine::kIsCut) {
      ++*cut_lines;
      break;
    }
    const auto pose = ParseTumLine(line);
    if (!pose.ok()) return reader->Error(pose.status().message());
    if (!poses.empty() && !(pose->timestamp_s > poses.back().timestamp_s))
      return reader->Error("the time is not after the line before; sort the lines by time");
    poses.push_back(*pose);
  }
  return poses;
}

Status WriteTumTrajectory(const std::string& path, std::span<const TimedPose> poses) {
  auto file = OutputFile::Create(path);
  if (!file.ok()) return file.status();
  std::string text;
  for (const TimedPose& pose : poses) AppendTumLine(&text, pose.timestamp_s, pose.world_from_cam);
  if (Status status = file->Append(text); !status.ok()) return status;
  return file->Close();
}

}  // namespace pliant
