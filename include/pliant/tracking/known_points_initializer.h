// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The first map from points whose depth in the reference image is known: those of someone's sparse model that has the
// image (COLMAP's, say), or of a pair of images. At once; a model's own camera motion is not used.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "pliant/base/options.h"
#include "pliant/tracking/initializer.h"

namespace pliant {

struct ModelInitOptions {
  std::string path;    // the model's folder
  double unit_mm = 0;  // what its unit is; 0: not known, the median depth becomes the nominal one
  int min_points = 40;

  void List(OptionTable& table);  // appended to the group "Init"
};

struct KnownPoints {
  std::string_view name;    // of the start, as Init.method has it
  std::string_view source;  // for messages: "the model"
  double unit_mm = 0;       // of the depths; 0: not known, as above
  int min_points = 40;
};

std::unique_ptr<Initializer> MakeKnownPointsInitializer(const KnownPoints& known, double nominal_depth_mm);

}  // namespace pliant
