// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/scene/map.h"

#include <cmath>

namespace pliant {

double DistanceSigma(const Landmark& landmark, const Rigid3& cam_from_world) {
  if (!(landmark.log_distance_sigma > 0.0)) return 0.0;
  return std::hypot(landmark.log_distance_sigma * (cam_from_world * landmark.position).norm(),
                    (landmark.position - landmark.determined_at).norm());
}

Landmark Moved(const Sim3& other_from_world, const Landmark& landmark) {
  Landmark moved = landmark;
  moved.rest_position = other_from_world * landmark.rest_position;
  moved.position = other_from_world * landmark.position;
  moved.determined_at = other_from_world * landmark.determined_at;
  moved.last_motion = other_from_world.Turn(landmark.last_motion);
  return moved;
}

Landmark* Map::Find(PointId id) { return FindById(landmarks, id); }

const Landmark* Map::Find(PointId id) const { return FindById(landmarks, id); }

}  // namespace pliant
