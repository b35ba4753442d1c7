// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The options of a simulation that --help describes (Manual::main_options).
#pragma once

#include <string_view>
#include <vector>

namespace pliant::cli {

inline std::vector<std::string_view> MainSimulationOptions() {
  return {"Scene.kind",
          "Scene.seed",
          "Deformation.amplitude_mm",
          "Deformation.omega_rad_s",
          "Deformation.wavelength_mm",
          "Deformation.breathing_mm",
          "Camera.model",
          "Camera.width",
          "Camera.height",
          "Camera.params",
          "Camera.baseline_mm",
          "Trajectory.kind",
          "Trajectory.frames",
          "Trajectory.fps",
          "Trajectory.speed_mm_s",
          "Trajectory.path"};
}

}  // namespace pliant::cli
