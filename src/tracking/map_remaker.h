// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A map made again, of frames through which its points and others were followed, by the deforming window
// (docs/method.md, eq. W13 and G5).
#pragma once

#include "pliant/base/status.h"
#include "pliant/tracking/initializer.h"
#include "pliant/tracking/window_initializer.h"
#include "tracking/window_solution.h"

namespace pliant {

class MapRemaker {
 public:
  MapRemaker(const WindowInitOptions& options, double nominal_depth_mm)
      : options_(options), nominal_depth_mm_(nominal_depth_mm) {}

  // Of all frames of the input, of which some between the first and the last may be left out. kWait: they make no map
  // that is certain; kNewReference: the scene is none that is asked for, or is seen too little.
  InitOutcome Remake(const InitInput& input, WindowScene scene) const;

 private:
  // What is missing for a map; ok when the outcome is one.
  Status Make(const InitInput& input, WindowScene scene, InitOutcome* outcome) const;

  WindowInitOptions options_;
  double nominal_depth_mm_;
};

}  // namespace pliant
