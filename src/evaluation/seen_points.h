// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The points of a tracked frame as pixels and depths.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pliant/evaluation/run_input.h"

namespace pliant {

struct SeenPoints {
  std::vector<Eigen::Vector2d> pixels;
  std::vector<double> depths;  // z in the run's camera, map units, positive
};

// Points behind the camera are left out. `frame` has a pose.
inline SeenPoints SeenPointsOf(const EvaluationFrame& frame) {
  SeenPoints points;
  for (const PointObservation& observation : frame.observations) {
    const double depth = (*frame.cam_from_world * observation.position).z();
    if (!(depth > 0) || !observation.pixel.allFinite()) continue;
    points.pixels.push_back(observation.pixel);
    points.depths.push_back(depth);
  }
  return points;
}

}  // namespace pliant
