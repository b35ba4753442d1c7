// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The first map from a depth image of the reference frame (an RGB-D camera, a simulator, stereo): metric, at once.
// Tracking stays monocular from there.
#pragma once

#include <memory>

#include "pliant/base/options.h"
#include "pliant/tracking/initializer.h"

namespace pliant {

struct DepthInitOptions {
  double max_depth_step = 0.05;  // relative step among the four pixels around a corner, above it: no point
  int min_points = 40;

  void List(OptionTable& table);  // appended to the group "Init"
};

std::unique_ptr<Initializer> MakeDepthInitializer(const DepthInitOptions& options);

}  // namespace pliant
