// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The first map from someone's sparse model that has the reference image (COLMAP's, say): its points, at the pixels and
// depths that the model gives them there. At once; the model's own camera motion is not used.
#pragma once

#include <memory>
#include <string>

#include "pliant/base/options.h"
#include "pliant/tracking/initializer.h"

namespace pliant {

struct ModelInitOptions {
  std::string path;    // the model's folder
  double unit_mm = 0;  // what its unit is; 0: not known, the median depth becomes the nominal one
  int min_points = 40;

  void List(OptionTable& table);  // appended to the group "Init"
};

std::unique_ptr<Initializer> MakeModelInitializer(const ModelInitOptions& options, double nominal_depth_mm);

}  // namespace pliant
