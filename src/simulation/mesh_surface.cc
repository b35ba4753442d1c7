// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The scene `mesh`. Long edges are divided at their middles, each once for both of its triangles, so that there are no
// gaps and the positions of the file's surface stay what they are; normals are the file's, smoothed over its vertices.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include <Eigen/Geometry>

#include "simulation/mesh_file.h"
#include "simulation/surface.h"

namespace pliant::simulation {
namespace {

constexpr std::size_t kMaxTriangles = 30'000'000;

using Triangle = std::array<std::uint32_t, 3>;

Status TooFine(const SimulationOptions::Scene& options) {
  return {ErrorCode::kInvalidArgument, "the mesh " + options.mesh_path +
                                           " does not fit into memory at this resolution; raise Scene.mesh_step_mm or "
                                           "check Scene.mesh_scale"};
}

// Each vertex gets the sum of the area vectors around its position; vertices that differ in uv alone share it.
std::vector<Eigen::Vector3d> SmoothNormals(const MeshFile& mesh) {
  const std::size_t count = mesh.vertices.size();
  std::vector<Eigen::Vector3d> normals(count, Eigen::Vector3d::Zero());
  for (const Triangle& t : mesh.triangles) {
    const Eigen::Vector3d area =
        (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
    for (const std::uint32_t idx : t) normals[idx] += area;
  }
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0U);
  const auto position = [&](std::uint32_t idx) {
    const Eigen::Vector3d& v = mesh.vertices[idx];
    return std::array{v.x(), v.y(), v.z()};
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return position(a) != position(b) ? position(a) < position(b) : a < b;
  });
  for (std::size_t begin = 0; begin < count;) {
    std::size_t end = begin;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    while (end < count && position(order[end]) == position(order[begin])) sum += normals[order[end++]];
    for (; begin < end; ++begin) normals[order[begin]] = sum.normalized();
  }
  return normals;
}

class Divider {
 public:
  Divider(MeshFile& mesh, std::vector<Eigen::Vector3d>& normals, double longest_mm)
      : mesh_(mesh), normals_(normals), longest_sq_(longest_mm * longest_mm) {}

  // One round: every edge that is too long is halved. False where none was.
  bool Round() {
    middles_.clear();
    std::vector<Triangle> divided;
    divided.reserve(mesh_.triangles.size() * 2);
    bool any = false;
    for (const Triangle& t : mesh_.triangles) any = Divide(t, divided) || any;
    mesh_.triangles.swap(divided);
    return any;
  }

 private:
  static constexpr std::uint32_t kShort = 0xffffffffU;

  std::uint32_t Middle(std::uint32_t a, std::uint32_t b) {
    if ((mesh_.vertices[a] - mesh_.vertices[b]).squaredNorm() <= longest_sq_) return kShort;
    const std::uint64_t key = (static_cast<std::uint64_t>(std::min(a, b)) << 32) | std::max(a, b);
    const auto [it, is_new] = middles_.try_emplace(key, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (is_new) {
      mesh_.vertices.emplace_back(0.5 * (mesh_.vertices[a] + mesh_.vertices[b]));
      normals_.emplace_back((normals_[a] + normals_[b]).normalized());
      if (!mesh_.uv.empty()) mesh_.uv.emplace_back(0.5 * (mesh_.uv[a] + mesh_.uv[b]));
    }
    return it->second;
  }

  bool Divide(const Triangle& t, std::vector<Triangle>& out) {
    const std::array middle = {Middle(t[0], t[1]), Middle(t[1], t[2]), Middle(t[2], t[0])};
    const auto halved = std::count_if(middle.begin(), middle.end(), [](std::uint32_t m) { return m != kShort; });
    if (halved == 0) {
      out.push_back(t);
      return false;
    }
    // Turned so that the first edge is halved and, of two, the last one is not.
    int first = 0;
    while (middle[first] == kShort || (halved == 2 && middle[(first + 2) % 3] != kShort)) ++first;
    const std::uint32_t a = t[first];
    const std::uint32_t b = t[(first + 1) % 3];
    const std::uint32_t c = t[(first + 2) % 3];
    const std::uint32_t ab = middle[first];
    const std::uint32_t bc = middle[(first + 1) % 3];
    const std::uint32_t ca = middle[(first + 2) % 3];
    if (halved == 1) {
      out.insert(out.end(), {{a, ab, c}, {ab, b, c}});
    } else if (halved == 2) {
      out.insert(out.end(), {{a, ab, c}, {ab, b, bc}, {ab, bc, c}});
    } else {
      out.insert(out.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    return true;
  }

  MeshFile& mesh_;
  std::vector<Eigen::Vector3d>& normals_;
  double longest_sq_;
  std::unordered_map<std::uint64_t, std::uint32_t> middles_;  // looked up, never walked through
};

Status CheckSize(const SimulationOptions::Scene& options, const MeshFile& mesh) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& v : mesh.vertices) box.extend(v);
  constexpr double kSmallestMm = 5;
  constexpr double kLargestMm = 5000;
  const double across_mm = box.diagonal().norm();
  if (across_mm >= kSmallestMm && across_mm <= kLargestMm) return Status::Ok();
  return {ErrorCode::kInvalidArgument,
          "the mesh " + options.mesh_path + " is " + FormatDouble(across_mm) +
              " mm across, which is no size of an organ; Scene.mesh_scale is the millimeters in a "
              "unit of the file (1000 for meters)"};
}

Surface ToSurface(const MeshFile& mesh, const std::vector<Eigen::Vector3d>& normals) {
  Surface surface;
  surface.triangles = mesh.triangles;
  for (const Eigen::Vector3d& v : mesh.vertices) surface.vertices.emplace_back(v.cast<float>());
  for (const Eigen::Vector3d& n : normals) surface.normals.emplace_back(n.cast<float>());
  surface.image = mesh.image;
  if (!surface.image.empty())
    for (const Eigen::Vector2d& uv : mesh.uv) surface.chart.emplace_back(uv.cast<float>());
  // It swells from the middle of its vertices.
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& v : mesh.vertices) center += v;
  center /= static_cast<double>(mesh.vertices.size());
  double sum_sq = 0;
  for (const Eigen::Vector3d& v : mesh.vertices) sum_sq += (v - center).squaredNorm();
  surface.swell_center.assign(mesh.vertices.size(), center.cast<float>());
  surface.swell_radius_mm = std::sqrt(sum_sq / static_cast<double>(mesh.vertices.size()));
  return surface;
}

}  // namespace

Result<Surface> MakeMeshSurface(const SimulationOptions::Scene& options) {
  if (options.mesh_path.empty())
    return {ErrorCode::kInvalidArgument, "Scene.kind mesh needs Scene.mesh_path, an OBJ, PLY or STL file"};
  Result<MeshFile> mesh = ReadMeshFile(options.mesh_path);
  if (!mesh.ok()) return mesh.status();
  for (Eigen::Vector3d& v : mesh->vertices) v *= options.mesh_scale;
  if (Status status = CheckSize(options, *mesh); !status.ok()) return status;
  std::vector<Eigen::Vector3d> normals = SmoothNormals(*mesh);
  // Three triangles of this edge or fewer to a square of it: said before memory is asked for.
  double area_mm2 = 0;
  for (const Triangle& t : mesh->triangles)
    area_mm2 +=
        0.5 * (mesh->vertices[t[1]] - mesh->vertices[t[0]]).cross(mesh->vertices[t[2]] - mesh->vertices[t[0]]).norm();
  if (3.0 * area_mm2 / (options.mesh_step_mm * options.mesh_step_mm) > static_cast<double>(kMaxTriangles))
    return TooFine(options);
  Divider divider(*mesh, normals, options.mesh_step_mm);
  while (divider.Round())
    if (mesh->triangles.size() > kMaxTriangles) return TooFine(options);
  return ToSurface(*mesh, normals);
}

}  // namespace pliant::simulation
