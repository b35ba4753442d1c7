// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The first map from one rectified pair: corners of the left image, found in the right one along their row, at once and
// in true millimeters. What follows is tracked with the left images alone.
#pragma once

#include "pliant/base/options.h"
#include "pliant/photometric/stereo_matching.h"

namespace pliant {

struct StereoStartOptions {
  StereoMatchingOptions matching;
  int min_points = 40;  // fewer matches make no map

  void List(OptionTable& table);  // appended to the group "Init"
};

}  // namespace pliant
