// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// From a posed scene to images. The light of a pixel is the mean of its samples; they are spread over the pixel's area
// and over the time that the shutter is open, in which the camera and the material move. The frame's time is the middle
// of the exposure, where rows are exposed at different times that of the middle one: depth and every other truth belong
// to it. The mesh stands where it is at that time; the material's
// motion within the exposure is taken off the rays' origins, linear in time and as large as at the point that the
// center of a pixel near by shows (deformations are smooth over a few pixels).
#pragma once

#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pliant/camera/camera.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/simulation/options.h"
#include "pliant/simulation/simulator.h"
#include "simulation/paint.h"
#include "simulation/ray_scene.h"
#include "simulation/ray_table.h"
#include "simulation/shading.h"
#include "simulation/surface.h"

namespace pliant::simulation {

// Where things are at a time, s.
struct Motions {
  std::function<Rigid3(double time_s)> world_from_cam;
  // Where a material point is; empty: nothing moves.
  std::function<Eigen::Vector3d(const MaterialPoint& point, double time_s)> position;
};

// The pose of the right camera of a stereo pair from the left one's.
Rigid3 RightCamera(const Rigid3& world_from_left, double baseline_mm);

class Renderer {
 public:
  // Makes the texture and meters the exposure of every frame by the scene at rest, so that any frame can be rendered by
  // itself. Keeps references to options, camera and surface. `at_rest`: the surface's rays, not moved.
  Renderer(const SimulationOptions& options, const Camera& camera, const Surface& surface, const RayScene& at_rest,
           Motions motions);

  // `posed` and `normals`: the scene at the frame's time.
  SimulatedFrame Render(int frame_idx, const RayScene& posed, const std::vector<Eigen::Vector3f>& normals) const;

 private:
  // Where the camera is while the shutter is open, one of each a time step.
  struct Exposure {
    std::vector<double> lags_s;              // a sample's time by the frame's
    std::vector<Eigen::Matrix3d> rotations;  // world_from_cam at that time
    std::vector<Eigen::Vector3d> origins;
    std::vector<Eigen::Vector3d> light_from_cam;  // the light seen from the camera then, in the world
  };
  // What the rows of one image have in common.
  struct Shot {
    const RayScene& scene;
    const std::vector<Eigen::Vector3f>& normals;
    double time_s;
    double baseline_mm;
    Rigid3 world_from_cam;   // at the frame's time
    Exposure exposure = {};  // of rows that are exposed at the frame's time
  };
  Exposure MakeExposure(double time_s, double baseline_mm, double row_lag_s) const;
  // When a row is exposed by the frame's time: rolling shutter, interlacing.
  double RowLag(int y) const;
  // From the first to the last moment that an image sees.
  double SpanOfExposure() const;
  Shot MakeShot(int frame_idx, Eye eye, const RayScene& posed, const std::vector<Eigen::Vector3f>& normals) const;
  void RenderRow(const Shot& shot, int y, cv::Vec3f* light, float* depth_mm) const;
  std::vector<Eigen::Vector3d> MaterialVelocities(const Shot& shot, std::span<const RayHit> centers) const;
  void MeterExposure(const RayScene& at_rest);
  double TimeOf(int frame_idx) const { return frame_idx / options_.trajectory.fps; }

  const SimulationOptions& options_;
  const Camera& camera_;
  const Surface& surface_;
  Motions motions_;
  RayTable rays_;
  Paint paint_;
  Shader shader_;
  std::vector<double> gains_;  // one a frame
};

}  // namespace pliant::simulation
