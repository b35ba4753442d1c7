// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/scene/map.h"

namespace pliant {

Landmark Moved(const Sim3& other_from_world, const Landmark& landmark) {
  Landmark moved = landmark;
  moved.rest_position = other_from_world * landmark.rest_position;
  moved.position = other_from_world * landmark.position;
  moved.last_motion = other_from_world.Turn(landmark.last_motion);
  return moved;
}

Landmark* Map::Find(PointId id) { return FindById(landmarks, id); }

const Landmark* Map::Find(PointId id) const { return FindById(landmarks, id); }

}  // namespace pliant
