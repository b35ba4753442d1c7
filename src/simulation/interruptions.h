// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What takes the view away for a while, in part or in whole: a tool that passes, defocus, the dark. Each comes by the
// clock, first when its period has passed once; depth and every other truth know nothing of it.
#pragma once

#include <opencv2/core/mat.hpp>

#include "pliant/simulation/options.h"

namespace pliant::simulation {

// `light`: CV_32FC3, linear, changed in place; `gain` brings it to 1 where the sensor saturates. Both cameras of a
// stereo pair see the same.
void Interrupt(const SimulationOptions& options, double gain, double time_s, cv::Mat* light);

}  // namespace pliant::simulation
