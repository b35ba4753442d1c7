// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// From light to gray levels: lens blur, vignetting, exposure, noise of the light, saturation, gamma, noise of the
// electronics, sharpening, 8 bits.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pliant/simulation/options.h"
#include "pliant/simulation/simulator.h"

namespace pliant::simulation {

// The light of a frame that the exposure is set by: the 90 % quantile of its samples. Sorts them.
double ExposureLevel(std::span<float> luminances);

// The gain of every frame from its light: an automatic exposure that follows with a time constant and starts settled,
// with the jitter of the electronics on top.
std::vector<double> ExposureGains(const SimulationOptions::Sensor& options, std::span<const double> levels, double fps,
                                  int seed);

// What the noise of an image is drawn from.
std::uint64_t NoiseSeed(int seed, int frame_idx, Eye eye);

// CV_32FC3 linear light -> CV_8UC3. Noise depends on its seed and the pixel alone.
cv::Mat Develop(const SimulationOptions::Sensor& options, const cv::Mat& radiance, double gain,
                std::uint64_t noise_seed);

}  // namespace pliant::simulation
