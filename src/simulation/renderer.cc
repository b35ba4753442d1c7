// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/renderer.h"

#include <algorithm>
#include <utility>

#include <tbb/parallel_for.h>

#include "simulation/interruptions.h"
#include "simulation/lens.h"
#include "simulation/sensor.h"

namespace pliant::simulation {
namespace {

// Pixels of a tile this wide sample the exposure at different times, so that fast motion blurs instead of showing
// double.
constexpr int kTile = 2;

// To and fro, so that the mean time of every pixel with an even number of samples is the frame's.
int TimeStep(int sample_idx, int x, int y) {
  constexpr int kSteps = kTile * kTile;
  const int in_tile = (y % kTile) * kTile + x % kTile;
  return sample_idx * kSteps + (sample_idx % 2 == 0 ? in_tile : kSteps - 1 - in_tile);
}

// Neighbors in a row that share a velocity.
constexpr std::size_t kVelocityPixels = 4;

}  // namespace

Rigid3 RightCamera(const Rigid3& world_from_left, double baseline_mm) {
  return {world_from_left.rotation, world_from_left * Eigen::Vector3d(baseline_mm, 0, 0)};
}

Renderer::Renderer(const SimulationOptions& options, const Camera& camera, const Surface& surface,
                   const RayScene& at_rest, Motions motions)
    : options_(options),
      camera_(camera),
      surface_(surface),
      motions_(std::move(motions)),
      rays_(camera, options.sensor.samples),
      paint_(options.texture, options.scene.seed, surface, at_rest),
      shader_(options.light, surface, paint_, 1.0 / (camera.MeanFocalLengthPx() * rays_.samples_per_side())) {
  MeterExposure(at_rest);
}

void Renderer::MeterExposure(const RayScene& at_rest) {
  constexpr int kAcross = 40;
  constexpr int kDown = 30;
  std::vector<double> levels(static_cast<std::size_t>(options_.trajectory.frames));
  tbb::parallel_for(0, options_.trajectory.frames, [&](int frame_idx) {
    const Rigid3 world_from_cam = motions_.world_from_cam(TimeOf(frame_idx));
    std::vector<Ray> rays;
    for (int y = 0; y < kDown; ++y)
      for (int x = 0; x < kAcross; ++x)
        rays.push_back({world_from_cam.translation,
                        world_from_cam.rotation * rays_.Center((x * 2 + 1) * camera_.width() / (2 * kAcross),
                                                               (y * 2 + 1) * camera_.height() / (2 * kDown))});
    std::vector<RayHit> hits(rays.size());
    at_rest.Intersect(rays, hits);
    std::vector<float> luminances;
    for (std::size_t i = 0; i < hits.size(); ++i)
      if (hits[i].hit())
        luminances.push_back(
            shader_.Radiance(hits[i], rays[i].direction, Eigen::Vector3d::Zero(), surface_.normals).mean());
    levels[frame_idx] = ExposureLevel(luminances);
  });
  gains_ = ExposureGains(options_.sensor, levels, options_.trajectory.fps, options_.scene.seed);
}

double Renderer::RowLag(int y) const {
  const SimulationOptions::Sensor& sensor = options_.sensor;
  const double rolling_s = sensor.readout_s * ((y + 0.5) / camera_.height() - 0.5);
  if (sensor.interlaced == Switch::kOff) return rolling_s;
  return rolling_s + (y % 2 == 0 ? -0.25 : 0.25) / options_.trajectory.fps;
}

double Renderer::SpanOfExposure() const {
  const SimulationOptions::Sensor& sensor = options_.sensor;
  const double fields_s = sensor.interlaced == Switch::kOn ? 0.5 / options_.trajectory.fps : 0.0;
  return sensor.shutter_s + sensor.readout_s + fields_s;
}

Renderer::Exposure Renderer::MakeExposure(double time_s, double baseline_mm, double row_lag_s) const {
  Exposure exposure;
  const int steps = (rays_.rays_per_pixel() - 1) * kTile * kTile;
  for (int i = 0; i < steps; ++i) {
    exposure.lags_s.push_back(row_lag_s + options_.sensor.shutter_s * ((i + 0.5) / steps - 0.5));
    const Rigid3 world_from_left = motions_.world_from_cam(time_s + exposure.lags_s.back());
    exposure.rotations.push_back(world_from_left.RotationMatrix());
    exposure.origins.push_back(RightCamera(world_from_left, baseline_mm).translation);
    exposure.light_from_cam.emplace_back(world_from_left.translation - exposure.origins.back());
  }
  return exposure;
}

Renderer::Shot Renderer::MakeShot(int frame_idx, Eye eye, const RayScene& posed,
                                  const std::vector<Eigen::Vector3f>& normals) const {
  const double baseline_mm = eye == Eye::kLeft ? 0.0 : options_.camera.baseline_mm;
  const double time_s = TimeOf(frame_idx);
  return {.scene = posed,
          .normals = normals,
          .time_s = time_s,
          .baseline_mm = baseline_mm,
          .world_from_cam = RightCamera(motions_.world_from_cam(time_s), baseline_mm),
          .exposure = MakeExposure(time_s, baseline_mm, 0.0)};
}

std::vector<Eigen::Vector3d> Renderer::MaterialVelocities(const Shot& shot, std::span<const RayHit> centers) const {
  std::vector<Eigen::Vector3d> velocities(centers.size(), Eigen::Vector3d::Zero());
  const double span_s = SpanOfExposure();
  if (!motions_.position || span_s == 0.0) return velocities;
  for (std::size_t i = 0; i < centers.size(); ++i) {
    if (i % kVelocityPixels != 0) {
      velocities[i] = velocities[i - 1];
      continue;
    }
    if (!centers[i].hit()) continue;
    velocities[i] = (motions_.position(centers[i].point, shot.time_s + 0.5 * span_s) -
                     motions_.position(centers[i].point, shot.time_s - 0.5 * span_s)) /
                    span_s;
  }
  return velocities;
}

void Renderer::RenderRow(const Shot& shot, int y, cv::Vec3f* light, float* depth_mm) const {
  const std::span<const Eigen::Vector3f> in_cam = rays_.Row(y);
  const auto width = static_cast<std::size_t>(camera_.width());
  const auto per_pixel = static_cast<std::size_t>(rays_.rays_per_pixel());
  const std::size_t samples = per_pixel - 1;
  const Eigen::Matrix3d rotation = shot.world_from_cam.RotationMatrix();
  std::vector<Ray> rays(width);
  std::vector<RayHit> hits(width);
  for (std::size_t x = 0; x < width; ++x)  // the last ray of a pixel goes through its center
    rays[x] = {shot.world_from_cam.translation, rotation * in_cam[(x + 1) * per_pixel - 1].cast<double>()};
  shot.scene.Intersect(rays, hits);
  for (std::size_t x = 0; x < width; ++x) {
    const double z = hits[x].hit() ? hits[x].distance_mm * in_cam[(x + 1) * per_pixel - 1].z() : 0.0;
    depth_mm[x] = static_cast<float>(std::max(0.0, z));
  }
  const std::vector<Eigen::Vector3d> velocities = MaterialVelocities(shot, hits);

  const double row_lag_s = RowLag(y);
  const Exposure of_row = row_lag_s == 0 ? Exposure() : MakeExposure(shot.time_s, shot.baseline_mm, row_lag_s);
  const Exposure& exposure = row_lag_s == 0 ? shot.exposure : of_row;
  rays.resize(width * samples);
  hits.resize(rays.size());
  for (std::size_t x = 0; x < width; ++x) {
    for (std::size_t i = 0; i < samples; ++i) {
      const int step = TimeStep(static_cast<int>(i), static_cast<int>(x), y);
      rays[x * samples + i] = {exposure.origins[step] - exposure.lags_s[step] * velocities[x],
                               exposure.rotations[step] * in_cam[x * per_pixel + i].cast<double>()};
    }
  }
  shot.scene.Intersect(rays, hits);
  for (std::size_t x = 0; x < width; ++x) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (std::size_t i = 0; i < samples; ++i) {
      const std::size_t idx = x * samples + i;
      if (!hits[idx].hit()) continue;
      const int step = TimeStep(static_cast<int>(i), static_cast<int>(x), y);
      sum += shader_.Radiance(hits[idx], rays[idx].direction, exposure.light_from_cam[step], shot.normals);
    }
    sum /= static_cast<float>(samples);
    light[x] = {sum[0], sum[1], sum[2]};
  }
}

SimulatedFrame Renderer::Render(int frame_idx, const RayScene& posed,
                                const std::vector<Eigen::Vector3f>& normals) const {
  SimulatedFrame frame;
  const cv::Size size(camera_.width(), camera_.height());
  const auto photograph = [&](Eye eye) {
    const Shot shot = MakeShot(frame_idx, eye, posed, normals);
    cv::Mat light(size, CV_32FC3);
    cv::Mat depth(size, CV_32FC1);
    tbb::parallel_for(0, size.height, [&](int y) { RenderRow(shot, y, light.ptr<cv::Vec3f>(y), depth.ptr<float>(y)); });
    if (eye == Eye::kLeft) frame.depth = depth;
    CoverLens(options_, camera_.MeanFocalLengthPx(), gains_[frame_idx], shot.time_s, eye, &light);
    Interrupt(options_, gains_[frame_idx], shot.time_s, &light);
    return Develop(options_.sensor, light, gains_[frame_idx], NoiseSeed(options_.scene.seed, frame_idx, eye));
  };
  frame.image = photograph(Eye::kLeft);
  if (options_.camera.baseline_mm > 0) frame.right = photograph(Eye::kRight);
  return frame;
}

}  // namespace pliant::simulation
