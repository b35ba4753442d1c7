// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What lies between the scene and the sensor: drops of fluid on the front lens and debris that floats before it. Both
// are out of focus, cover the image only, and have no part in depth or any other truth. Who is there at a time depends
// on the seed and the time alone.
#pragma once

#include <opencv2/core/mat.hpp>

#include "pliant/simulation/options.h"
#include "pliant/simulation/simulator.h"

namespace pliant::simulation {

// Drops appear, stay, and slide off the lower edge; through one the scene is seen blurred and bent towards its middle.
// Debris is bright (mucus) or dark (stool) and drifts; the two cameras of a stereo pair see the same debris and have
// drops of their own. `light`: CV_32FC3, linear, changed in place; `gain` brings it to 1 where the sensor saturates.
void CoverLens(const SimulationOptions& options, double focal_px, double gain, double time_s, Eye eye, cv::Mat* light);

}  // namespace pliant::simulation
