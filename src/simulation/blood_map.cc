// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/blood_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>
#include <tbb/parallel_for.h>

#include "pliant/base/random.h"
#include "simulation/mottling.h"

namespace pliant::simulation {
namespace {

constexpr float kLowest = -4.0F;
constexpr float kStep = 8.0F / 65535.0F;

// One vessel that grows in steps over the map, sways, thins and branches.
struct Twig {
  double x_mm;
  double y_mm;
  double heading;
  double width_mm;
};

// Vessel density 0 to 255. Twigs run over the right edge and come in again on the left, as the chart does.
cv::Mat DrawVessels(const SimulationOptions::Texture& options, Random random, const cv::Size& size, double width_mm,
                    double height_mm) {
  cv::Mat map = cv::Mat::zeros(size, CV_8UC1);
  constexpr double kTreesPerMm2 = 1.0 / 900.0;
  constexpr double kThinnestMm = 0.09;
  constexpr int kFraction = 4;  // bits of sub-pixel position
  const double per_mm = size.width / width_mm;
  const int trees = static_cast<int>(options.vessels * kTreesPerMm2 * width_mm * height_mm);
  std::vector<Twig> pending;
  for (int tree = 0; tree < trees; ++tree) {
    pending.push_back({random.Uniform(0, width_mm), random.Uniform(0, height_mm),
                       random.Uniform(0, 2 * std::numbers::pi), random.Uniform(0.25, 0.6)});
    while (!pending.empty()) {
      Twig twig = pending.back();
      pending.pop_back();
      double turning = 0;
      while (twig.width_mm > kThinnestMm) {
        constexpr double kStepMm = 0.4;
        turning = 0.9 * turning + random.Normal(0.08);
        twig.heading += turning * 0.5;
        const Twig from = twig;
        twig.x_mm += kStepMm * std::cos(twig.heading);
        twig.y_mm += kStepMm * std::sin(twig.heading);
        twig.width_mm *= 0.988;
        const auto point = [&](const Twig& t, double shift_mm) {
          return cv::Point(static_cast<int>(std::lround((t.x_mm + shift_mm) * per_mm * (1 << kFraction))),
                           static_cast<int>(std::lround(t.y_mm * per_mm * (1 << kFraction))));
        };
        const int thickness = std::max(1, static_cast<int>(std::lround(twig.width_mm * per_mm)));
        const double gray = 255.0 * std::min(1.0, 0.25 + twig.width_mm * 1.4);
        for (const double shift_mm : {-width_mm, 0.0, width_mm})
          cv::line(map, point(from, shift_mm), point(twig, shift_mm), cv::Scalar(gray), thickness, cv::LINE_AA,
                   kFraction);
        if (random.Uniform() < 0.05) {
          const double side = random.Uniform() < 0.5 ? -1.0 : 1.0;
          pending.push_back({twig.x_mm, twig.y_mm, twig.heading + side * random.Uniform(0.4, 1.1),
                             twig.width_mm * random.Uniform(0.5, 0.8)});
          twig.heading -= side * 0.15;
        }
        twig.x_mm = std::fmod(twig.x_mm + width_mm, width_mm);
      }
    }
  }
  cv::GaussianBlur(map, map, cv::Size(), 0.1 * per_mm, 0.1 * per_mm);
  return map;
}

// The position at rest of a position on the chart; the vertices are a grid that is even on the chart.
Eigen::Vector3f PositionAtRest(const Surface& surface, float column, float row) {
  const auto columns = static_cast<std::size_t>(surface.grid->columns);
  const int c = std::clamp(static_cast<int>(column), 0, surface.grid->columns - 2);
  const int r = std::clamp(static_cast<int>(row), 0, surface.grid->rows - 2);
  const float a = column - static_cast<float>(c);
  const float b = row - static_cast<float>(r);
  const Eigen::Vector3f* corner = &surface.vertices[r * columns + c];
  return (1 - b) * ((1 - a) * corner[0] + a * corner[1]) + b * ((1 - a) * corner[columns] + a * corner[columns + 1]);
}

}  // namespace

BloodMap::BloodMap(const SimulationOptions::Texture& options, int seed, const Surface& surface) {
  const SurfaceGrid& grid = *surface.grid;
  const Random random = Random(static_cast<std::uint64_t>(seed)).Child("texture");
  // A power of two around, so that every reduced copy closes on itself exactly.
  const int width = 1 << static_cast<int>(std::ceil(std::log2(grid.chart_width_mm / options.texel_mm)));
  const int height = static_cast<int>(std::ceil(grid.chart_height_mm / options.texel_mm));
  texels_per_mm_x_ = static_cast<float>(width / grid.chart_width_mm);
  texels_per_mm_y_ = static_cast<float>(height / grid.chart_height_mm);
  texel_mm_ = static_cast<float>(options.texel_mm);
  const cv::Mat vessels =
      DrawVessels(options, random.Child("vessels"), {width, height}, grid.chart_width_mm, grid.chart_height_mm);
  const Mottling mottling(options, random.Child("mottling"));
  cv::Mat map(height, width, CV_16UC1);
  tbb::parallel_for(0, height, [&](int y) {
    auto* out = map.ptr<std::uint16_t>(y);
    const auto* vessel = vessels.ptr<std::uint8_t>(y);
    const float row = (static_cast<float>(y) + 0.5F) * static_cast<float>(grid.rows - 1) / static_cast<float>(height);
    for (int x = 0; x < width; ++x) {
      const float column =
          (static_cast<float>(x) + 0.5F) * static_cast<float>(grid.columns - 1) / static_cast<float>(width);
      float value = kMottlingBlood * mottling.At(PositionAtRest(surface, column, row));
      value += kVesselBlood * static_cast<float>(vessel[x]) / 255.0F;
      value *= static_cast<float>(options.contrast);
      out[x] = cv::saturate_cast<std::uint16_t>((value - kLowest) / kStep);
    }
  });
  levels_.push_back(map);
  while (levels_.back().cols > 64 && levels_.back().rows > 64) {
    cv::Mat half;
    cv::resize(levels_.back(), half, cv::Size(levels_.back().cols / 2, (levels_.back().rows + 1) / 2), 0, 0,
               cv::INTER_AREA);
    levels_.push_back(half);
  }
}

float BloodMap::Bilinear(const cv::Mat& level, float x, float y) const {
  const float u = x * static_cast<float>(level.cols) - 0.5F;
  const float v = std::clamp(y * static_cast<float>(level.rows) - 0.5F, 0.0F, static_cast<float>(level.rows - 1));
  const float fu = std::floor(u);
  const float a = u - fu;
  const int x0 = static_cast<int>(fu) & (level.cols - 1);
  const int x1 = (x0 + 1) & (level.cols - 1);
  const int y0 = static_cast<int>(v);
  const int y1 = std::min(y0 + 1, level.rows - 1);
  const float b = v - static_cast<float>(y0);
  const auto* upper = level.ptr<std::uint16_t>(y0);
  const auto* lower = level.ptr<std::uint16_t>(y1);
  const float raw = (1 - b) * ((1 - a) * upper[x0] + a * upper[x1]) + b * ((1 - a) * lower[x0] + a * lower[x1]);
  return raw * kStep + kLowest;
}

float BloodMap::At(float x_mm, float y_mm, float footprint_mm) const {
  const float x = x_mm * texels_per_mm_x_ / static_cast<float>(levels_[0].cols);
  const float y = y_mm * texels_per_mm_y_ / static_cast<float>(levels_[0].rows);
  const float level = std::clamp(std::log2(std::max(footprint_mm / texel_mm_, 1.0F)), 0.0F,
                                 static_cast<float>(levels_.size()) - 1.001F);
  const auto i = static_cast<std::size_t>(level);
  const float t = level - static_cast<float>(i);
  const float fine = Bilinear(levels_[i], x, y);
  if (t < 1e-3F) return fine;
  return fine + t * (Bilinear(levels_[i + 1], x, y) - fine);
}

}  // namespace pliant::simulation
