// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A reference image of the first map, and what came of it so far.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/base/state_archive.h"
#include "pliant/tracking/bootstrapping/initializer.h"
#include "tracking/bootstrapping/waiting_maps.h"

namespace pliant {

struct Reference {
  std::vector<InitFrame> frames = {};                 // itself, and those its points were followed into; empty: none
  std::vector<double> known_depths = {};              // of its points, where they are known
  bool camera_may_stand_still = false;                // as an attempt at a map said
  std::optional<MadeMap> provisional = std::nullopt;  // the best of its maps, put aside
  std::string last_reason = "the first map is attempted beside tracking";  // of the last attempt

  bool IsThere() const { return !frames.empty(); }
  int Points() const { return static_cast<int>(frames.back().observations.size()); }  // in the last frame
  void Serialize(StateArchive& archive);
};

}  // namespace pliant
