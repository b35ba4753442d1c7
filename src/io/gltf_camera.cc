// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "io/gltf_builder.h"

namespace pliant::gltf {
namespace {

// The camera's view begins and ends at so many times the median distance of the vertices from where it begins.
constexpr float kNear = 0.02F;
constexpr float kFar = 200.0F;
constexpr double kWidestViewDeg = 150.0;  // to both sides; a pinhole's view ends before 180

// Of the vertices from the first camera, m.
float MedianDistance(const MeshAnimation& animation) {
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  if (!animation.path.empty()) center = animation.path.front().world_from_cam.translation.cast<float>();
  std::vector<float> distances;
  for (const Eigen::Vector3f& vertex : animation.mesh.vertices)
    distances.push_back(kMetersPerUnit * (vertex - center).norm());
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::ranges::nth_element(distances, middle);
  return std::max(*middle, 1e-6F);
}

// Where a pixel cannot be unprojected, as in the black corners of an endoscope's image: of the nearest one towards the
// image's center that can.
std::optional<Eigen::Vector3d> RayTowards(const Camera& camera, const Eigen::Vector2d& pixel) {
  constexpr int kSteps = 20;
  const Eigen::Vector2d center(0.5 * (camera.width() - 1), 0.5 * (camera.height() - 1));
  for (int step = kSteps; step > 0; --step)
    if (auto ray = camera.Unproject(center + static_cast<double>(step) / kSteps * (pixel - center))) return ray;
  return std::nullopt;
}

// Half the width and height, at the distance 1, of the smallest view around the optical axis that shows the whole
// image, as far as a pinhole can.
Eigen::Vector2d HalfViewOf(const Camera& camera) {
  constexpr int kSteps = 32;  // along each side
  constexpr double kLeast = 1e-6;
  const double largest = std::tan(0.5 * kWidestViewDeg * std::numbers::pi / 180.0);
  const double right = camera.width() - 0.5;
  const double bottom = camera.height() - 0.5;
  Eigen::Vector2d half = Eigen::Vector2d::Constant(kLeast);
  for (int step = 0; step <= kSteps; ++step) {
    const double x = std::lerp(-0.5, right, static_cast<double>(step) / kSteps);
    const double y = std::lerp(-0.5, bottom, static_cast<double>(step) / kSteps);
    for (const Eigen::Vector2d& pixel :
         {Eigen::Vector2d(x, -0.5), Eigen::Vector2d(x, bottom), Eigen::Vector2d(-0.5, y), Eigen::Vector2d(right, y)})
      if (const auto ray = RayTowards(camera, pixel))
        half = half.cwiseMax((ray->head<2>().cwiseAbs() / std::max(ray->z(), kLeast)).cwiseMin(largest));
  }
  return half;
}

tinygltf::Value IntrinsicsOf(const Camera& camera) {
  tinygltf::Value::Array params;
  for (const double param : camera.params()) params.emplace_back(param);
  tinygltf::Value::Object intrinsics;
  intrinsics.emplace("model", tinygltf::Value(std::string(camera.model_name())));
  intrinsics.emplace("width", tinygltf::Value(camera.width()));
  intrinsics.emplace("height", tinygltf::Value(camera.height()));
  intrinsics.emplace("params", tinygltf::Value(std::move(params)));
  return tinygltf::Value(std::move(intrinsics));
}
}  // namespace

void AddCamera(const MeshAnimation& animation, ModelBuilder* builder) {
  tinygltf::Camera camera;
  camera.type = "perspective";
  const Eigen::Vector2d half = HalfViewOf(animation.camera);
  camera.perspective.yfov = 2.0 * std::atan(half.y());
  camera.perspective.aspectRatio = half.x() / half.y();
  camera.extras = IntrinsicsOf(animation.camera);
  const float distance = MedianDistance(animation);
  camera.perspective.znear = static_cast<double>(kNear * distance);
  camera.perspective.zfar = static_cast<double>(kFar * distance);
  builder->model().cameras.push_back(camera);
  tinygltf::Node node;
  node.name = "camera";
  node.camera = 0;
  builder->model().nodes.push_back(node);
}

}  // namespace pliant::gltf
