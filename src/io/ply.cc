// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/ply.h"

#include <cassert>

#include "pliant/base/files.h"
#include "pliant/base/text.h"

namespace pliant {

Status WritePly(const std::string& path, std::span<const NewPoint> points, std::span<const double> sigmas) {
  assert(sigmas.empty() || sigmas.size() == points.size());
  FileGroup group;
  auto file = group.Create(path);
  if (!file.ok()) return file.status();
  std::string out = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(points.size()) +
                    "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
                    "property uchar green\nproperty uchar blue\n" +
                    (sigmas.empty() ? "" : "property float sigma\n") + "end_header\n";
  for (std::size_t i = 0; i < points.size(); ++i) {
    const NewPoint& point = points[i];
    for (const double coordinate : point.position) AppendFloat(&out, static_cast<float>(coordinate));
    for (const std::uint8_t channel : point.rgb) AppendBytes(&out, channel, 1);
    if (!sigmas.empty()) AppendFloat(&out, static_cast<float>(sigmas[i]));
    if (Status status = file->AppendWhenLarge(&out); !status.ok()) return status;
  }
  if (Status status = file->Append(out); !status.ok()) return status;
  if (Status status = file->Close(); !status.ok()) return status;
  return group.Commit();
}

Status WritePly(const std::string& path, const Mesh& mesh) {
  FileGroup group;
  auto file = group.Create(path);
  if (!file.ok()) return file.status();
  std::string out = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(mesh.vertices.size()) +
                    "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\n"
                    "property float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
                    "property float sigma\n" +
                    (mesh.ids.empty() ? "" : "property int vertex\n") +
                    (mesh.views.empty() ? "" : "property uchar view\n") + "element face " +
                    std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    for (const float coordinate : mesh.vertices[v]) AppendFloat(&out, coordinate);
    for (const float coordinate : mesh.normals[v]) AppendFloat(&out, coordinate);
    for (const std::uint8_t channel : mesh.rgb[v]) AppendBytes(&out, channel, 1);
    AppendFloat(&out, mesh.sigmas[v]);
    if (!mesh.ids.empty()) AppendBytes(&out, static_cast<std::uint32_t>(mesh.ids[v]), 4);
    if (!mesh.views.empty()) AppendBytes(&out, mesh.views[v], 1);
    if (Status status = file->AppendWhenLarge(&out); !status.ok()) return status;
  }
  for (const auto& triangle : mesh.triangles) {
    AppendBytes(&out, 3, 1);
    for (const std::int32_t v : triangle) AppendBytes(&out, static_cast<std::uint32_t>(v), 4);
    if (Status status = file->AppendWhenLarge(&out); !status.ok()) return status;
  }
  if (Status status = file->Append(out); !status.ok()) return status;
  if (Status status = file->Close(); !status.ok()) return status;
  return group.Commit();
}

}  // namespace pliant
