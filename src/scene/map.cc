// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/scene/map.h"

#include <algorithm>

namespace pliant {

Landmark* Map::Find(PointId id) {
  const auto it = std::lower_bound(landmarks.begin(), landmarks.end(), id,
                                   [](const Landmark& landmark, PointId wanted) { return landmark.id < wanted; });
  return it != landmarks.end() && it->id == id ? &*it : nullptr;
}

const Landmark* Map::Find(PointId id) const { return const_cast<Map*>(this)->Find(id); }

}  // namespace pliant
