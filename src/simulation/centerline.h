// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The line that the tube and the camera follow: from the origin along +z, bending gently and irregularly in two planes,
// with a frame that does not twist about it.
#pragma once

#include <vector>

#include "pliant/geometry/rigid3.h"

namespace pliant::simulation {

class Centerline {
 public:
  // `bend_deg_per_cm` bounds the curvature in each plane. Reaches from 0 to `length_mm`.
  Centerline(double length_mm, double bend_deg_per_cm, int seed);

  // The frame at a position along the line: its origin lies on the line, z points along it. Arguments beyond the ends
  // are moved to the ends.
  Rigid3 WorldFromFrame(double s_mm) const;

 private:
  std::vector<Rigid3> frames_;  // every kStepMm
};

}  // namespace pliant::simulation
