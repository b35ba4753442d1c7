// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/mesh_values.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

#include <Eigen/Geometry>

#include "pliant/base/statistics.h"

namespace pliant {
namespace {

constexpr double kUsualShare = 0.98;  // of the values, that the colors tell apart

// The two keys around a frame, and the share of the later one.
struct BetweenKeys {
  std::size_t before = 0;
  std::size_t after = 0;
  float share = 0;
};

// A mesh whose keys lie on both sides of a gap is that of the key on the frame's own side.
BetweenKeys KeysAround(const GltfMesh& mesh, int frame_idx) {
  const std::vector<MeshKey>& keys = mesh.keys;
  const auto next = std::ranges::find_if(keys, [&](const MeshKey& key) { return key.frame_idx > frame_idx; });
  const auto index = static_cast<std::size_t>(next - keys.begin());
  BetweenKeys around{index > 0 ? index - 1 : 0, std::min(index, keys.size() - 1), 0};
  const auto gap = std::ranges::find_if(mesh.gaps, [&](const MotionGap& candidate) {
    return keys[around.before].frame_idx <= candidate.last_frame_idx &&
           candidate.next_frame_idx <= keys[around.after].frame_idx;
  });
  if (gap != mesh.gaps.end()) {
    const std::size_t own = frame_idx <= gap->last_frame_idx ? around.before : around.after;
    return {own, own, 0};
  }
  const int length = keys[around.after].frame_idx - keys[around.before].frame_idx;
  if (length > 0)
    around.share = static_cast<float>(frame_idx - keys[around.before].frame_idx) / static_cast<float>(length);
  return around;
}

float TwiceTheArea(std::span<const Eigen::Vector3f> positions, const Triangle& triangle) {
  const auto at = [&](std::size_t k) { return positions[static_cast<std::size_t>(triangle[k])]; };
  return (at(1) - at(0)).cross(at(2) - at(0)).norm();
}

// Area of the triangles around a vertex by that of the undeformed ones, minus 1.
std::vector<float> AreaChanges(std::span<const Eigen::Vector3f> undeformed, std::span<const Eigen::Vector3f> positions,
                               std::span<const Triangle> seamless) {
  std::vector<float> before(positions.size(), 0.0F);
  std::vector<float> after(positions.size(), 0.0F);
  for (const Triangle& triangle : seamless) {
    const float area_before = TwiceTheArea(undeformed, triangle);
    const float area_after = TwiceTheArea(positions, triangle);
    for (const std::int32_t v : triangle) {
      before[static_cast<std::size_t>(v)] += area_before;
      after[static_cast<std::size_t>(v)] += area_after;
    }
  }
  std::vector<float> changes;
  for (std::size_t v = 0; v < positions.size(); ++v)
    changes.push_back(before[v] > 0.0F ? after[v] / before[v] - 1.0F : kUnknown);
  return changes;
}

// Between two keys it changes evenly, where both know it.
std::vector<float> ErrorsAt(const ViewedMesh& mesh, int frame_idx) {
  const std::size_t vertices = mesh.surface.mesh.vertices.size();
  if (mesh.errors_mm.empty()) return std::vector<float>(vertices, kUnknown);
  const BetweenKeys around = KeysAround(mesh.surface, frame_idx);
  if (around.share == 0.0F) return mesh.errors_mm[around.before];
  std::vector<float> errors;
  for (std::size_t v = 0; v < vertices; ++v) {
    // Not std::lerp, which may give the other one where one is not a number.
    const float before = mesh.errors_mm[around.before][v];
    errors.push_back(before + around.share * (mesh.errors_mm[around.after][v] - before));
  }
  return errors;
}

}  // namespace

bool IsKnownIn(const GltfMesh& mesh, int frame_idx) {
  const bool in_gap = std::ranges::any_of(mesh.gaps, [&](const MotionGap& gap) {
    return gap.last_frame_idx < frame_idx && frame_idx < gap.next_frame_idx;
  });
  return mesh.keys.empty() ||
         (mesh.keys.front().frame_idx <= frame_idx && frame_idx <= mesh.keys.back().frame_idx && !in_gap);
}

std::vector<Eigen::Vector3f> PositionsAt(const GltfMesh& mesh, int frame_idx) {
  assert(IsKnownIn(mesh, frame_idx));
  if (mesh.keys.empty()) return mesh.mesh.vertices;
  const BetweenKeys around = KeysAround(mesh, frame_idx);
  std::vector<Eigen::Vector3f> positions;
  for (std::size_t v = 0; v < mesh.mesh.vertices.size(); ++v)
    positions.emplace_back((1.0F - around.share) * mesh.keys[around.before].positions[v] +
                           around.share * mesh.keys[around.after].positions[v]);
  return positions;
}

std::vector<Triangle> SeamlessTriangles(const Mesh& mesh) {
  std::map<std::array<float, 3>, std::int32_t> first;
  std::vector<std::int32_t> same;
  for (const Eigen::Vector3f& vertex : mesh.vertices)
    same.push_back(
        first.try_emplace({vertex.x(), vertex.y(), vertex.z()}, static_cast<std::int32_t>(same.size())).first->second);
  std::vector<Triangle> triangles = mesh.triangles;
  for (Triangle& triangle : triangles)
    for (std::int32_t& v : triangle) v = same[static_cast<std::size_t>(v)];
  return triangles;
}

std::vector<float> MeshValues(const ViewedMesh& mesh, SurfaceColor color, int frame_idx,
                              std::span<const Eigen::Vector3f> positions, std::span<const Triangle> seamless) {
  const Mesh& undeformed = mesh.surface.mesh;
  if (color == SurfaceColor::kAreaChange) return AreaChanges(undeformed.vertices, positions, seamless);
  if (color == SurfaceColor::kUncertainty) return undeformed.sigmas;
  if (color == SurfaceColor::kError) return ErrorsAt(mesh, frame_idx);
  std::vector<float> displacements;
  for (std::size_t v = 0; v < positions.size(); ++v)
    displacements.push_back((positions[v] - undeformed.vertices[v]).norm());
  return displacements;
}

ValueRange RangeOfMeshes(const View& view, SurfaceColor color) {
  std::vector<double> magnitudes;
  for (const ViewedRun& run : view.runs)
    for (const ViewedMesh& mesh : run.meshes) {
      const std::vector<Triangle> seamless = SeamlessTriangles(mesh.surface.mesh);
      for (const MeshKey& key : mesh.surface.keys)
        for (const float value : MeshValues(mesh, color, key.frame_idx, key.positions, seamless))
          if (std::isfinite(value)) magnitudes.push_back(std::abs(value));
    }
  if (magnitudes.empty()) return {};
  const double high = Quantile(std::move(magnitudes), kUsualShare);
  if (!(high > 0.0)) return {};
  return {color == SurfaceColor::kAreaChange ? -high : 0.0, high};
}

}  // namespace pliant
