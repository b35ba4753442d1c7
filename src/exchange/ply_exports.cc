// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <unordered_map>

#include "exchange/exports.h"
#include "pliant/base/files.h"
#include "pliant/base/staged_folder.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

constexpr const char* kPlyHead = "ply\nformat binary_little_endian 1.0\ncomment made by Pliant; map units (mm)\n";

void AppendPosition(const Eigen::Vector3d& position, std::string* out) {
  for (const double coordinate : position) AppendFloat(out, static_cast<float>(coordinate));
}

void AppendColor(const std::array<std::uint8_t, 3>& rgb, std::string* out) {
  for (const std::uint8_t channel : rgb) AppendBytes(out, channel, 1);
}

}  // namespace

Status ExportPly(const RunSource& source, const ExportOptions& /*options*/, const ExportFolder& folder) {
  std::vector<std::string> names;
  for (const SourceFrame& frame : source.frames) names.push_back(NumberOf(frame) + ".ply");
  if (Status status = CheckAbsent(folder.place, names); !status.ok()) return status;
  return ForEachFrame(source, [&](const SourceFrame& frame, const auto& observations) {
    std::string out = kPlyHead;
    out += "comment dx dy dz: from the undeformed position\nelement vertex " + std::to_string(observations.size()) +
           "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
           "property uchar blue\nproperty int track\nproperty float dx\nproperty float dy\nproperty float dz\n"
           "end_header\n";
    for (const PointObservation& o : observations) {
      const NewPoint& point = FindPoint(source.points, o.id)->point;
      AppendPosition(o.position, &out);
      AppendColor(point.rgb, &out);
      AppendBytes(&out, static_cast<std::uint64_t>(o.id.value), 4);
      AppendPosition(o.position - point.position, &out);
    }
    return WriteFileAtomically(folder.Path(NumberOf(frame) + ".ply"), out);
  });
}

Status ExportTrajectories(const RunSource& source, const ExportOptions& /*options*/, const ExportFolder& folder) {
  FileGroup group;
  auto file = group.Create(folder.Path("trajectories.ply"));
  if (!file.ok()) return file.status();
  const auto edges = source.num_observations - static_cast<std::int64_t>(source.points.size());
  std::string out = kPlyHead;
  out += "element vertex " + std::to_string(source.num_observations) +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
         "property uchar blue\nproperty int track\nproperty int frame\nelement edge " +
         std::to_string(edges) + "\nproperty int vertex1\nproperty int vertex2\nend_header\n";
  Status status = ForEachFrame(source, [&](const SourceFrame& frame, const auto& observations) {
    const auto color = TimeColor(source, frame);
    for (const PointObservation& o : observations) {
      AppendPosition(o.position, &out);
      AppendColor(color, &out);
      AppendBytes(&out, static_cast<std::uint64_t>(o.id.value), 4);
      AppendBytes(&out, static_cast<std::uint64_t>(frame.frame_idx), 4);
    }
    return file->AppendWhenLarge(&out);
  });
  if (!status.ok()) return status;
  // A point's vertex in the frame before, from a second pass.
  std::unordered_map<PointId, std::uint32_t> last;
  std::uint32_t vertex = 0;
  status = ForEachFrame(source, [&](const SourceFrame&, const auto& observations) {
    for (const PointObservation& o : observations) {
      const auto [entry, added] = last.try_emplace(o.id, vertex);
      if (!added) {
        AppendBytes(&out, entry->second, 4);
        AppendBytes(&out, vertex, 4);
        entry->second = vertex;
      }
      ++vertex;
    }
    return file->AppendWhenLarge(&out);
  });
  if (!status.ok()) return status;
  if (Status written = file->Append(out); !written.ok()) return written;
  if (Status closed = file->Close(); !closed.ok()) return closed;
  return group.Commit();
}

}  // namespace pliant
