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

// Standard normal noise of the three channels of a pixel. Noise of neighboring channels is alike (they share a
// demosaicing): 0.9^2 + 0.19 = 1.
cv::Vec3f UnitNoise(std::uint64_t counter) {
  constexpr float kShared = 0.9F;
  constexpr float kOwn = 0.436F;
  const float shared = kShared * NormalFromBits(HashBits(counter));
  cv::Vec3f noise;
  for (int c = 0; c < 3; ++c) noise[c] = shared + kOwn * NormalFromBits(HashBits(counter + 1 + c));
  return noise;
}

// Noise of variance 1 with the correlation that the options ask for; empty where there is neither read nor shot noise.
cv::Mat LightNoise(const SimulationOptions::Sensor& options, const cv::Size& size, std::uint64_t noise_seed) {
  if (options.read_noise == 0 && options.shot_noise == 0) return {};
  const std::uint64_t own_seed = HashBits(~noise_seed);
  cv::Mat noise(size, CV_32FC3);
  tbb::parallel_for(0, size.height, [&](int y) {
    auto* row = noise.ptr<cv::Vec3f>(y);
    for (int x = 0; x < size.width; ++x)
      row[x] = UnitNoise(own_seed + 4 * (static_cast<std::uint64_t>(y) * size.width + x));
  });
  if (options.noise_correlation_px == 0) return noise;
  const int radius = static_cast<int>(std::ceil(3 * options.noise_correlation_px));
  cv::Mat kernel = cv::getGaussianKernel(2 * radius + 1, options.noise_correlation_px, CV_32F);
  kernel /= cv::norm(kernel);  // so that the variance stays
  cv::Mat smooth;
  cv::sepFilter2D(noise, smooth, CV_32F, kernel, kernel);
  return smooth;
}

void Sharpen(const SimulationOptions::Sensor& options, cv::Mat* levels) {
  cv::Mat blurred;
  cv::GaussianBlur(*levels, blurred, cv::Size(), options.sharpening_px, options.sharpening_px, cv::BORDER_REPLICATE);
  cv::addWeighted(*levels, 1 + options.sharpening, blurred, -options.sharpening, 0, *levels);
}

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
  const GammaCurve gamma(options.gamma);
  cv::Mat light = radiance;
  // Rows of two fields show two moments, which a lens does not mix: there the blur is along the rows alone.
  const cv::Size kernel(0, options.interlaced == Switch::kOn ? 1 : 0);
  if (options.blur_px > 0)
    cv::GaussianBlur(radiance, light, kernel, options.blur_px, options.blur_px, cv::BORDER_REPLICATE);
  const cv::Mat light_noise = LightNoise(options, light.size(), noise_seed);
  const double read_variance = options.read_noise * options.read_noise;
  const double shot_variance = options.shot_noise * options.shot_noise;
  cv::Mat levels(light.size(), CV_32FC3);
  const double center_x = 0.5 * (light.cols - 1);
  const double center_y = 0.5 * (light.rows - 1);
  const double corner_sq = std::max(1.0, center_x * center_x + center_y * center_y);
  const auto noise = static_cast<float>(options.noise_levels);
  tbb::parallel_for(0, light.rows, [&](int y) {
    const auto* in = light.ptr<cv::Vec3f>(y);
    const auto* unit = light_noise.empty() ? nullptr : light_noise.ptr<cv::Vec3f>(y);
    auto* out = levels.ptr<cv::Vec3f>(y);
    for (int x = 0; x < light.cols; ++x) {
      const double radius_sq = ((x - center_x) * (x - center_x) + (y - center_y) * (y - center_y)) / corner_sq;
      const auto scale = static_cast<float>(gain * (1.0 - options.vignetting * radius_sq));
      const cv::Vec3f grain = UnitNoise(noise_seed + 4 * (static_cast<std::uint64_t>(y) * light.cols + x));
      for (int c = 0; c < 3; ++c) {
        float linear = in[x][c] * scale;
        if (unit != nullptr)
          linear += static_cast<float>(std::sqrt(read_variance + shot_variance * std::max(0.0F, linear))) * unit[x][c];
        out[x][c] = gamma(linear) + noise * grain[c];
      }
    }
  });
  if (options.sharpening > 0) Sharpen(options, &levels);
  cv::Mat image;
  levels.convertTo(image, CV_8UC3);
  return image;
}

}  // namespace pliant::simulation
