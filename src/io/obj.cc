// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/obj.h"

#include <cstddef>
#include <cstdint>

#include "pliant/base/files.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

constexpr int kDecimals = 6;

template <class Vector>
void AppendVector(const Vector& vector, std::string* out) {
  for (const float coordinate : vector) {
    *out += ' ';
    AppendFixed(out, coordinate, kDecimals);
  }
}

// A triangle's corner: its vertex, which has the normal of the same number, and its place in the texture; from 1.
void AppendCorner(std::int32_t vertex, std::size_t uv, bool has_uv, std::string* out) {
  *out += ' ';
  AppendInt(out, vertex + 1);
  *out += '/';
  if (has_uv) AppendInt(out, static_cast<std::int64_t>(uv) + 1);
  *out += '/';
  AppendInt(out, vertex + 1);
}

}  // namespace

Status WriteObj(const std::string& path, const Mesh& mesh, const std::string& material_file) {
  const bool has_texture = !material_file.empty();
  std::string out = "# made by Pliant\n";
  if (has_texture) out += "mtllib " + material_file + "\nusemtl tissue\n";
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    out += 'v';
    AppendVector(mesh.vertices[v], &out);
    if (!has_texture)
      for (const std::uint8_t channel : mesh.rgb[v]) {
        out += ' ';
        AppendFixed(&out, channel / 255.0, kDecimals);
      }
    out += '\n';
  }
  for (const auto& uvs : mesh.texture_uvs)
    for (const Eigen::Vector2f& uv : uvs) {
      out += "vt";
      AppendVector(Eigen::Vector2f(uv.x(), 1.0F - uv.y()), &out);  // from the lower left corner
      out += '\n';
    }
  for (const Eigen::Vector3f& normal : mesh.normals) {
    out += "vn";
    AppendVector(normal, &out);
    out += '\n';
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    out += 'f';
    for (std::size_t k = 0; k < 3; ++k) AppendCorner(mesh.triangles[t][k], 3 * t + k, !mesh.texture_uvs.empty(), &out);
    out += '\n';
  }
  return WriteFileAtomically(path, out);
}

Status WriteObjMaterial(const std::string& path, const std::string& texture_file) {
  return WriteFileAtomically(
      path, "# made by Pliant\nnewmtl tissue\nKa 1 1 1\nKd 1 1 1\nKs 0 0 0\nillum 1\nmap_Kd " + texture_file + "\n");
}

}  // namespace pliant
