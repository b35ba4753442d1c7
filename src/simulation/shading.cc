// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/shading.h"

#include <algorithm>
#include <cmath>

namespace pliant::simulation {
namespace {

constexpr float kMinBlood = -4.0F;
constexpr float kMaxBlood = 4.0F;
constexpr float kReferenceMm = 50.0F;
constexpr float kFinestFacetMm = 0.2F;

}  // namespace

Shader::Shader(const SimulationOptions::Light& options, const Surface& surface, const Paint& paint, double pixel_rad)
    : options_(options), surface_(surface), paint_(paint), pixel_rad_(static_cast<float>(pixel_rad)) {
  // Linear color of mucosa, and how fast blood takes each channel away (blue, green, red).
  const Eigen::Array3f mucosa(0.19F, 0.235F, 0.68F);
  const Eigen::Array3f absorption(0.78F, 0.85F, 0.25F);
  for (int i = 0; i < kAlbedoSteps; ++i) {
    const float blood_amount = kMinBlood + (kMaxBlood - kMinBlood) * static_cast<float>(i) / (kAlbedoSteps - 1);
    albedo_[i] = (mucosa * (-absorption * blood_amount).exp()).min(0.95F).matrix();
  }
}

Shader::SurfacePosition Shader::PositionOf(const std::array<std::uint32_t, 3>& t, float b1, float b2) const {
  const float b0 = 1.0F - b1 - b2;
  SurfacePosition position;
  if (!surface_.chart.empty())
    position.chart = b0 * surface_.chart[t[0]] + b1 * surface_.chart[t[1]] + b2 * surface_.chart[t[2]];
  if (paint_.solid)
    position.at_rest = b0 * surface_.vertices[t[0]] + b1 * surface_.vertices[t[1]] + b2 * surface_.vertices[t[2]];
  return position;
}

const Eigen::Vector3f& Shader::AlbedoOf(float blood) const {
  const int step = static_cast<int>(std::lround((blood - kMinBlood) / (kMaxBlood - kMinBlood) * (kAlbedoSteps - 1)));
  return albedo_[std::clamp(step, 0, kAlbedoSteps - 1)];
}

Eigen::Vector3f Shader::Facet(const std::array<std::uint32_t, 3>& t, const SurfacePosition& position,
                              const Eigen::Vector3f& normal, float size_mm) const {
  // What is mottled is also uneven: its slope tilts the normal. Two axes on the triangle first: the chart's, or any.
  const Eigen::Vector3f ab = surface_.vertices[t[1]] - surface_.vertices[t[0]];
  const Eigen::Vector3f ac = surface_.vertices[t[2]] - surface_.vertices[t[0]];
  Eigen::Vector3f x_axis;
  Eigen::Vector3f y_axis;
  if (paint_.map) {
    const Eigen::Vector2f chart_ab = surface_.chart[t[1]] - surface_.chart[t[0]];
    const Eigen::Vector2f chart_ac = surface_.chart[t[2]] - surface_.chart[t[0]];
    const float area = chart_ab.x() * chart_ac.y() - chart_ab.y() * chart_ac.x();
    if (area == 0.0F) return normal;
    x_axis = ((ab * chart_ac.y() - ac * chart_ab.y()) / area).normalized();
    y_axis = ((ac * chart_ab.x() - ab * chart_ac.x()) / area).normalized();
  } else {
    x_axis = ab.normalized();
    y_axis = ab.cross(ac).cross(ab).normalized();
  }
  const auto blood = [&](const Eigen::Vector2f& on_chart, const Eigen::Vector3f& in_space) {
    return paint_.Blood(position.chart + size_mm * on_chart, position.at_rest + size_mm * in_space, size_mm);
  };
  const float here = blood(Eigen::Vector2f::Zero(), Eigen::Vector3f::Zero());
  const float slope_x = (blood(Eigen::Vector2f::UnitX(), x_axis) - here) / size_mm;
  const float slope_y = (blood(Eigen::Vector2f::UnitY(), y_axis) - here) / size_mm;
  const auto height = static_cast<float>(options_.unevenness_mm);
  return (normal - height * (slope_x * x_axis + slope_y * y_axis)).normalized();
}

Eigen::Vector3f Shader::Radiance(const RayHit& hit, const Eigen::Vector3d& direction,
                                 const Eigen::Vector3d& light_from_eye,
                                 const std::vector<Eigen::Vector3f>& normals) const {
  const auto& t = surface_.triangles[hit.point.triangle_idx];
  const auto b1 = static_cast<float>(hit.point.b1);
  const auto b2 = static_cast<float>(hit.point.b2);
  const float b0 = 1.0F - b1 - b2;
  const Eigen::Vector3f normal = (b0 * normals[t[0]] + b1 * normals[t[1]] + b2 * normals[t[2]]).normalized();
  const SurfacePosition position = PositionOf(t, b1, b2);
  const Eigen::Vector3f to_eye = -direction.cast<float>();
  const float cosine = std::clamp(normal.dot(to_eye), 0.0F, 1.0F);
  const auto distance = static_cast<float>(hit.distance_mm);
  const Eigen::Vector3f light_from_position = distance * to_eye + light_from_eye.cast<float>();
  const float light_distance = light_from_position.norm();
  const Eigen::Vector3f to_light = light_from_position / light_distance;
  const float light_cosine = std::clamp(normal.dot(to_light), 0.0F, 1.0F);

  // A slanted wall spreads the pixel over more of it, one way only: the geometric mean of both.
  const float footprint_mm = distance * pixel_rad_ / std::sqrt(std::max(cosine, 0.08F));
  const Eigen::Vector3f albedo = paint_.image ? paint_.image->At(position.chart, footprint_mm)
                                              : AlbedoOf(paint_.Blood(position.chart, position.at_rest, footprint_mm));

  const auto ambient = static_cast<float>(options_.ambient);
  const float fall_off = (kReferenceMm / light_distance) * (kReferenceMm / light_distance);
  Eigen::Vector3f radiance = albedo * ((1.0F - ambient) * light_cosine + ambient);
  // The mean facet must be near enough to the light for a rough one to mirror it.
  if (surface_.is_wet && options_.specular > 0 && cosine > 0.85F) {
    const Eigen::Vector3f facet = Facet(t, position, normal, std::max(footprint_mm, kFinestFacetMm));
    const float mirror = std::clamp(facet.dot((to_eye + to_light).normalized()), 0.1F, 1.0F);
    const float tan_sq = 1.0F / (mirror * mirror) - 1.0F;
    const auto slope = static_cast<float>(options_.roughness);
    radiance.array() += static_cast<float>(options_.specular) * std::exp(-tan_sq / (slope * slope));
  }
  return fall_off * radiance;
}

}  // namespace pliant::simulation
