// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/scene/map.h"

namespace pliant {

Landmark* Map::Find(PointId id) { return FindById(landmarks, id); }

const Landmark* Map::Find(PointId id) const { return FindById(landmarks, id); }

}  // namespace pliant
