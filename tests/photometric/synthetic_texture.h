// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A band-limited texture known at every real position, so that any warp of it is exact up to 8-bit rounding.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include <opencv2/core.hpp>

#include "pliant/base/random.h"

namespace pliant {

class SyntheticTexture {
 public:
  // Waves of 8 to 60 px, standard deviation about 28 gray levels around 120.
  explicit SyntheticTexture(std::uint64_t seed, double shortest_px = 8) {
    Random random(seed);
    constexpr int kWaves = 36;
    for (int i = 0; i < kWaves; ++i) {
      const double wavelength = shortest_px * std::pow(60 / shortest_px, random.Uniform());
      const double angle = random.Uniform(0, std::numbers::pi);
      const double k = 2 * std::numbers::pi / wavelength;
      waves_.push_back({k * std::cos(angle), k * std::sin(angle), random.Uniform(0, 2 * std::numbers::pi)});
    }
  }

  double At(double x, double y) const {
    double sum = 0;
    for (const Wave& wave : waves_) sum += std::cos(wave.kx * x + wave.ky * y + wave.phase);
    return 120 + 6.6 * sum;
  }

  // Image whose pixel p shows gain * At(texture_from_pixel(p)) + bias, with normal noise.
  template <class Map>
  cv::Mat Render(cv::Size size, const Map& texture_from_pixel, double gain = 1, double bias = 0, double noise_sigma = 0,
                 std::uint64_t noise_seed = 0) const {
    Random random(noise_seed);
    cv::Mat image(size, CV_8UC1);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const cv::Point2d p = texture_from_pixel(cv::Point2d(x, y));
        const double noise = noise_sigma > 0 ? random.Normal(noise_sigma) : 0;
        image.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(gain * At(p.x, p.y) + bias + noise);
      }
    }
    return image;
  }

 private:
  struct Wave {
    double kx, ky, phase;
  };
  std::vector<Wave> waves_;
};

}  // namespace pliant
