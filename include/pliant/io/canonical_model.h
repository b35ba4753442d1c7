// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The canonical COLMAP model of a run: one point a track, at its undeformed position, and every tracked image with its
// keypoints. It shows a run in COLMAP's viewers; it is not consistent with bundle adjustment, because the scene moved.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/colmap/model.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/scene/frame_report.h"

namespace pliant {

class StateArchive;

struct CanonicalImage {
  int frame_idx = 0;  // its observations carry this; the image's id is frame_idx + 1
  std::string name;
  Rigid3 cam_from_world;
  int submap = 0;
};

struct CanonicalPoint {
  NewPoint point;                     // the point's id is the COLMAP point's
  double error_px = 0;                // mean reprojection error over its observations
  std::int64_t num_observations = 0;  // that it has in the images; below 2 it is left out
  int submap = 0;
  double mean_sigma = 0;  // of its distance from the camera, over its observations, map units; 0: not known
};

inline std::uint32_t ColmapImageId(int frame_idx) { return static_cast<std::uint32_t>(frame_idx) + 1; }

// The point with this id in a vector that is sorted by it, or null.
template <class Points>
auto FindPoint(Points& points, PointId id) -> decltype(points.data()) {
  const auto found =
      std::lower_bound(points.begin(), points.end(), id,
                       [](const CanonicalPoint& point, PointId wanted) { return point.point.id < wanted; });
  return found != points.end() && found->point.id == id ? &*found : nullptr;
}

void Serialize(StateArchive& archive, CanonicalImage& image);
void Serialize(StateArchive& archive, CanonicalPoint& point);

// Counts one more observation; a point that does not project there adds nothing to its mean error.
void CountObservation(const Camera& camera, const Rigid3& cam_from_world, const PointObservation& observation,
                      CanonicalPoint* point);

// Writes cameras, images and points3D into `folder`, which must exist. `images` are sorted by frame, `points` by id;
// the keypoints are streamed from observations.csv in `run_path`, several times if need be, so that memory stays
// bounded (about 40 MB) however long the run. Fails with kUnwritable, or as the reading of observations.csv does.
Status WriteCanonicalModel(const std::string& folder, colmap::Format format, const Camera& camera,
                           std::span<const CanonicalImage> images, std::span<const CanonicalPoint> points,
                           const std::string& run_path);

}  // namespace pliant
