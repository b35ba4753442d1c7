// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/sensor.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include <opencv2/imgproc.hpp>
#include <tbb/parallel_for.h>

#include "pliant/base/random.h"
#include "simulation/noise.h"

namespace pliant::simulation {
namespace {

// value^(1/gamma) by a table over the square root, in which the curve is nearly straight.
class GammaCurve {
 public:
  explicit GammaCurve(double gamma) {
    for (std::size_t i = 0; i < table_.size(); ++i) {
      const double root = static_cast<double>(i) / (table_.size() - 2);
      table_[i] = static_cast<float>(255.0 * std::pow(root * root, 1.0 / gamma));
    }
  }
  float operator()(float linear) const {
    const float position = std::sqrt(std::clamp(linear, 0.0F, 1.0F)) * static_cast<float>(table_.size() - 2);
    const auto i = static_cast<std::size_t>(position);
    return table_[i] + (position - static_cast<float>(i)) * (table_[i + 1] - table_[i]);
  }

 private:
  std::array<float, 1026> table_;
};

}  // namespace

double ExposureLevel(std::span<float> luminances) {
  if (luminances.empty()) return 0;
  const auto quantile = luminances.begin() + static_cast<std::ptrdiff_t>(0.9 * static_cast<double>(luminances.size()));
  std::nth_element(luminances.begin(), quantile, luminances.end());
  return *quantile;
}

std::vector<double> ExposureGains(const SimulationOptions::Sensor& options, std::span<const double> levels, double fps,
                                  int seed) {
  Random random = Random(static_cast<std::uint64_t>(seed)).Child("gain");
  const double follow = options.exposure_time_s > 0 ? 1.0 - std::exp(-1.0 / (fps * options.exposure_time_s)) : 1.0;
  std::vector<double> gains;
  double log_level = 0;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const double target = std::log(std::max(levels[i], 1e-6));
    log_level = i == 0 ? target : log_level + follow * (target - log_level);
    gains.push_back(options.exposure * std::exp(-log_level) * (1.0 + random.Normal(options.gain_jitter)));
  }
  return gains;
}

std::uint64_t NoiseSeed(int seed, int frame_idx, Eye eye) {
  const std::uint64_t left = HashBits((static_cast<std::uint64_t>(static_cast<std::uint32_t>(seed)) << 32) |
                                      static_cast<std::uint32_t>(frame_idx));
  return eye == Eye::kLeft ? left : HashBits(left);
}

cv::Mat Develop(const SimulationOptions::Sensor& options, const cv::Mat& radiance, double gain,
                std::uint64_t noise_seed) {
  assert(radiance.type() == CV_32FC3);
  // Noise of neighboring channels is alike (they share a demosaicing): 0.9^2 + 0.19 = 1.
  constexpr float kShared = 0.9F;
  constexpr float kOwn = 0.436F;
  const GammaCurve gamma(options.gamma);
  cv::Mat light = radiance;
  if (options.blur_px > 0)
    cv::GaussianBlur(radiance, light, cv::Size(), options.blur_px, options.blur_px, cv::BORDER_REPLICATE);
  cv::Mat image(light.size(), CV_8UC3);
  const double center_x = 0.5 * (light.cols - 1);
  const double center_y = 0.5 * (light.rows - 1);
  const double corner_sq = std::max(1.0, center_x * center_x + center_y * center_y);
  const auto noise = static_cast<float>(options.noise_levels);
  tbb::parallel_for(0, light.rows, [&](int y) {
    const auto* in = light.ptr<cv::Vec3f>(y);
    auto* out = image.ptr<cv::Vec3b>(y);
    for (int x = 0; x < light.cols; ++x) {
      const double radius_sq = ((x - center_x) * (x - center_x) + (y - center_y) * (y - center_y)) / corner_sq;
      const auto scale = static_cast<float>(gain * (1.0 - options.vignetting * radius_sq));
      const std::uint64_t counter = noise_seed + 4 * (static_cast<std::uint64_t>(y) * light.cols + x);
      const float shared = kShared * NormalFromBits(HashBits(counter));
      for (int c = 0; c < 3; ++c) {
        const float grain = noise * (shared + kOwn * NormalFromBits(HashBits(counter + 1 + c)));
        out[x][c] = cv::saturate_cast<std::uint8_t>(gamma(in[x][c] * scale) + grain);
      }
    }
  });
  return image;
}

}  // namespace pliant::simulation
