// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/ray_scene.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include <embree3/rtcore.h>

namespace pliant::simulation {

struct RayScene::State {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  RTCGeometry geometry = nullptr;
  float* vertices = nullptr;  // Embree's, three floats a vertex
  std::span<const std::array<std::uint32_t, 3>> triangles;

  ~State() {
    if (geometry != nullptr) rtcReleaseGeometry(geometry);
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
  Eigen::Vector3d Vertex(std::uint32_t idx) const {
    const float* v = vertices + std::size_t{3} * idx;
    return {v[0], v[1], v[2]};
  }
  void Copy(std::span<const Eigen::Vector3f> positions) const {
    for (std::size_t i = 0; i < positions.size(); ++i) std::copy_n(positions[i].data(), 3, vertices + 3 * i);
  }
};

namespace {

// Where the ray meets the triangle's plane (Moeller and Trumbore, 1997). Embree has decided that it does; rounding may
// leave the weights outside [0, 1] by its own size.
RayHit Refine(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, std::uint32_t triangle_idx,
              const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a;
  const Eigen::Vector3d ac = c - a;
  const Eigen::Vector3d p = direction.cross(ac);
  const double determinant = ab.dot(p);
  if (determinant == 0.0) return {};
  const Eigen::Vector3d from_a = origin - a;
  const Eigen::Vector3d q = from_a.cross(ab);
  RayHit hit;
  hit.point = {triangle_idx, from_a.dot(p) / determinant, direction.dot(q) / determinant};
  hit.distance_mm = ac.dot(q) / determinant;
  return hit;
}

}  // namespace

RayScene::RayScene(std::unique_ptr<State> state) : state_(std::move(state)) {}
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;
RayScene::~RayScene() = default;

Result<RayScene> RayScene::Create(const Surface& surface, Vertices vertices) {
  auto state = std::make_unique<State>();
  const Status failed(ErrorCode::kInsufficient,
                      "the ray tracer (Embree) could not take the scene; there may be too little memory, raise "
                      "Scene.mesh_step_mm");
  state->device = rtcNewDevice(nullptr);
  if (state->device == nullptr) return failed;
  state->scene = rtcNewScene(state->device);
  state->geometry = rtcNewGeometry(state->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  state->vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      state->geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), surface.vertices.size()));
  auto* indices =
      static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(state->geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                          3 * sizeof(std::uint32_t), surface.triangles.size()));
  if (state->vertices == nullptr || indices == nullptr) return failed;
  state->Copy(surface.vertices);
  for (std::size_t i = 0; i < surface.triangles.size(); ++i)
    std::copy_n(surface.triangles[i].data(), 3, indices + 3 * i);
  state->triangles = surface.triangles;
  // Robust: no ray slips through between two triangles.
  unsigned flags = RTC_SCENE_FLAG_ROBUST;
  if (vertices == Vertices::kMoving) {
    flags |= RTC_SCENE_FLAG_DYNAMIC;
    // Only a scene of low quality keeps a tree a mesh and refits it; the mesh's own tree is built with care all the
    // same.
    rtcSetSceneBuildQuality(state->scene, RTC_BUILD_QUALITY_LOW);
    rtcSetGeometryBuildQuality(state->geometry, RTC_BUILD_QUALITY_REFIT);
  }
  rtcSetSceneFlags(state->scene, static_cast<RTCSceneFlags>(flags));
  rtcCommitGeometry(state->geometry);
  rtcAttachGeometry(state->scene, state->geometry);
  rtcCommitScene(state->scene);
  if (rtcGetDeviceError(state->device) != RTC_ERROR_NONE) return failed;
  return RayScene(std::move(state));
}

void RayScene::Move(std::span<const Eigen::Vector3f> vertices) {
  state_->Copy(vertices);
  rtcUpdateGeometryBuffer(state_->geometry, RTC_BUFFER_TYPE_VERTEX, 0);
  rtcCommitGeometry(state_->geometry);
  rtcCommitScene(state_->scene);
}

void RayScene::Intersect(const Eigen::Vector3d& origin, std::span<const Eigen::Vector3d> directions,
                         std::span<RayHit> hits) const {
  std::vector<Ray> rays;
  rays.reserve(directions.size());
  for (const Eigen::Vector3d& direction : directions) rays.push_back({origin, direction});
  Intersect(rays, hits);
}

void RayScene::Intersect(std::span<const Ray> rays, std::span<RayHit> hits) const {
  assert(rays.size() == hits.size());
  constexpr std::size_t kPacket = 8;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  for (std::size_t begin = 0; begin < rays.size(); begin += kPacket) {
    const std::size_t count = std::min(kPacket, rays.size() - begin);
    alignas(32) int valid[kPacket] = {};
    RTCRayHit8 packet;
    for (std::size_t i = 0; i < kPacket; ++i) {
      const auto& [origin, direction] = rays[begin + std::min(i, count - 1)];
      // A ray that does not exist (a pixel outside of the camera's domain) has no direction.
      valid[i] = i < count && direction.squaredNorm() > 0 ? -1 : 0;
      packet.ray.org_x[i] = static_cast<float>(origin.x());
      packet.ray.org_y[i] = static_cast<float>(origin.y());
      packet.ray.org_z[i] = static_cast<float>(origin.z());
      packet.ray.dir_x[i] = static_cast<float>(direction.x());
      packet.ray.dir_y[i] = static_cast<float>(direction.y());
      packet.ray.dir_z[i] = static_cast<float>(direction.z());
      packet.ray.tnear[i] = 0.0F;
      packet.ray.tfar[i] = std::numeric_limits<float>::infinity();
      packet.ray.time[i] = 0.0F;
      packet.ray.mask[i] = 0xffffffffU;
      packet.ray.id[i] = static_cast<unsigned>(i);
      packet.ray.flags[i] = 0;
      packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.primID[i] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect8(valid, state_->scene, &context, &packet);
    for (std::size_t i = 0; i < count; ++i) {
      hits[begin + i] = {};
      if (valid[i] == 0 || packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
      const std::uint32_t idx = packet.hit.primID[i];
      const auto& t = state_->triangles[idx];
      hits[begin + i] = Refine(rays[begin + i].origin, rays[begin + i].direction, idx, state_->Vertex(t[0]),
                               state_->Vertex(t[1]), state_->Vertex(t[2]));
    }
  }
}

void RayScene::VisitNear(const Eigen::Vector3d& center, double radius_mm,
                         const std::function<void(std::uint32_t triangle_idx)>& visit) const {
  RTCPointQuery query;
  query.x = static_cast<float>(center.x());
  query.y = static_cast<float>(center.y());
  query.z = static_cast<float>(center.z());
  query.time = 0.0F;
  query.radius = static_cast<float>(radius_mm);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  const auto callback = [](RTCPointQueryFunctionArguments* arguments) {
    (*static_cast<const std::function<void(std::uint32_t)>*>(arguments->userPtr))(arguments->primID);
    return false;  // the radius stays
  };
  rtcPointQuery(state_->scene, &query, &context, callback, const_cast<std::function<void(std::uint32_t)>*>(&visit));
}

}  // namespace pliant::simulation
