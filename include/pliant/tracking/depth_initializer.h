// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The first map from a depth image of the reference frame (an RGB-D camera, a simulator, a network), or from a point
// cloud of what its camera saw: metric, at once.
// Tracking stays monocular from there.
#pragma once

#include <memory>
#include <string>

#include "pliant/base/options.h"
#include "pliant/tracking/initializer.h"

namespace pliant {

struct DepthInitOptions {
  double max_depth_step = 0.05;  // relative step among the four pixels around a corner, above it: no point
  int min_points = 40;
  std::string cloud_path;    // a point cloud in the first frame's camera; empty: the sequence's depth images
  double cloud_unit_mm = 1;  // what its unit is

  void List(OptionTable& table);  // appended to the group "Init"
};

std::unique_ptr<Initializer> MakeDepthInitializer(const DepthInitOptions& options);

}  // namespace pliant
