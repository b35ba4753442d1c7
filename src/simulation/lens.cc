// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/lens.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <opencv2/imgproc.hpp>
#include <tbb/parallel_for.h>

#include "pliant/base/random.h"

namespace pliant::simulation {
namespace {

// Somebody who comes, stays for a while and goes.
struct Visitor {
  Random random;  // of everything about it
  double age;     // 0 when it comes, 1 when it has gone
};

// Those who are there at a time, `mean_count` on average: twice as many slots, each used or not during every stay.
std::vector<Visitor> VisitorsAt(double time_s, double mean_count, double stay_s, const Random& random) {
  const int slots = static_cast<int>(std::ceil(2.0 * mean_count));
  std::vector<Visitor> visitors;
  for (int slot = 0; slot < slots; ++slot) {
    const Random at_slot = random.Child(std::to_string(slot));
    const double stays = time_s / stay_s + Random(at_slot).Uniform();
    const double stay = std::floor(stays);
    Random visit = at_slot.Child(std::to_string(static_cast<long long>(stay)));
    if (visit.Uniform() < mean_count / slots) visitors.push_back({visit, stays - stay});
  }
  return visitors;
}

double SmoothStep(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

// An uneven round outline.
struct Outline {
  Eigen::Vector2d center;
  double radius_px = 1;
  double stretch = 1;  // of the axis along `heading`
  double heading_rad = 0;
  double oval = 0;
  double oval_phase = 0;
  double corner = 0;
  double corner_phase = 0;

  double ReachPx() const { return radius_px * std::max(stretch, 1.0) * (1.0 + oval + corner); }
  // 0 at the center, 1 on the outline.
  double At(const Eigen::Vector2d& pixel) const {
    const Eigen::Vector2d d = pixel - center;
    const double along = (std::cos(heading_rad) * d.x() + std::sin(heading_rad) * d.y()) / stretch;
    const double across = -std::sin(heading_rad) * d.x() + std::cos(heading_rad) * d.y();
    const double angle = std::atan2(across, along);
    const double here =
        radius_px * (1.0 + oval * std::cos(2.0 * angle + oval_phase) + corner * std::cos(3.0 * angle + corner_phase));
    return std::hypot(along, across) / here;
  }
};

Outline DrawOutline(Random& random, double radius_px, double most_stretch) {
  Outline outline;
  outline.radius_px = radius_px;
  outline.stretch = random.Uniform(1.0, most_stretch);
  outline.heading_rad = random.Uniform(0, std::numbers::pi);
  outline.oval = random.Uniform(0.0, 0.12);
  outline.oval_phase = random.Uniform(0, 2 * std::numbers::pi);
  outline.corner = random.Uniform(0.0, 0.07);
  outline.corner_phase = random.Uniform(0, 2 * std::numbers::pi);
  return outline;
}

// Calls `paint(pixel, radius in the outline, value)` for the pixels within an outline.
template <class Paint>
void ForPixelsIn(const Outline& outline, cv::Mat& light, const Paint& paint) {
  const double reach = outline.ReachPx();
  const int x0 = std::max(0, static_cast<int>(std::floor(outline.center.x() - reach)));
  const int x1 = std::min(light.cols - 1, static_cast<int>(std::ceil(outline.center.x() + reach)));
  const int y0 = std::max(0, static_cast<int>(std::floor(outline.center.y() - reach)));
  const int y1 = std::min(light.rows - 1, static_cast<int>(std::ceil(outline.center.y() + reach)));
  if (x0 > x1 || y0 > y1) return;
  tbb::parallel_for(y0, y1 + 1, [&](int y) {
    auto* row = light.ptr<cv::Vec3f>(y);
    for (int x = x0; x <= x1; ++x) {
      const Eigen::Vector2d pixel(x, y);
      const double radius = outline.At(pixel);
      if (radius < 1.0) paint(pixel, radius, row[x]);
    }
  });
}

cv::Vec3f BilinearColor(const cv::Mat& image, const Eigen::Vector2d& pixel) {
  const double u = std::clamp(pixel.x(), 0.0, image.cols - 1.001);
  const double v = std::clamp(pixel.y(), 0.0, image.rows - 1.001);
  const int x = static_cast<int>(u);
  const int y = static_cast<int>(v);
  const auto a = static_cast<float>(u - x);
  const auto b = static_cast<float>(v - y);
  const auto* upper = image.ptr<cv::Vec3f>(y) + x;
  const auto* lower = image.ptr<cv::Vec3f>(y + 1) + x;
  return (1 - b) * ((1 - a) * upper[0] + a * upper[1]) + b * ((1 - a) * lower[0] + a * lower[1]);
}

// Where a drop is at its age, and how large it has grown.
Outline PlaceDrop(Visitor& drop, const cv::Size& size, double* opacity) {
  Random& random = drop.random;
  Outline outline = DrawOutline(random, random.Uniform(0.03, 0.09) * size.width, 1.3);
  const Eigen::Vector2d start(random.Uniform(0.05, 0.95) * size.width, random.Uniform(0.05, 0.85) * size.height);
  const double slides_at = random.Uniform(0.45, 0.8);
  const double heading_rad = 0.5 * std::numbers::pi + random.Uniform(-0.3, 0.3);
  const double wobble_phase = random.Uniform(0, 2 * std::numbers::pi);
  *opacity = SmoothStep(0.0, 0.02, drop.age);
  outline.radius_px *= 0.7 + 0.3 * SmoothStep(0.0, 0.1, drop.age);
  // Slowly first, then faster, and over the edge when its time is up.
  const double sliding = std::max(0.0, (drop.age - slides_at) / (1.0 - slides_at));
  const double way_px = (size.height - start.y() + 1.5 * outline.ReachPx()) / std::sin(heading_rad);
  const double slid_px = way_px * sliding * sliding;
  outline.center = start + slid_px * Eigen::Vector2d(std::cos(heading_rad), std::sin(heading_rad));
  outline.center.x() +=
      0.15 * outline.radius_px * std::sin(6.0 * sliding + wobble_phase) * std::min(1.0, 4.0 * sliding);
  return outline;
}

void CoverWithDrops(const SimulationOptions& options, double time_s, Eye eye, cv::Mat& light) {
  constexpr double kStayS = 5.0;
  const Random random = Random(static_cast<std::uint64_t>(options.scene.seed))
                            .Child(eye == Eye::kLeft ? std::string_view("drops") : std::string_view("drops, right"));
  std::vector<Visitor> drops = VisitorsAt(time_s, options.sensor.drops, kStayS, random);
  if (drops.empty()) return;
  // Through the water the lens does not focus on the scene.
  const double blur_px = 0.009 * light.cols;
  cv::Mat blurred;
  cv::GaussianBlur(light, blurred, cv::Size(), blur_px, blur_px, cv::BORDER_REPLICATE);
  for (Visitor& drop : drops) {
    double opacity = 0;
    const Outline outline = PlaceDrop(drop, light.size(), &opacity);
    ForPixelsIn(outline, light, [&](const Eigen::Vector2d& pixel, double radius, cv::Vec3f& value) {
      // A thick middle magnifies; the steep rim looks far outwards, loses light above and gains some below.
      const Eigen::Vector2d from_center = pixel - outline.center;
      const double bending = 0.4 + 1.1 * radius * radius;
      const double side = from_center.y() / outline.radius_px;
      const double rim = SmoothStep(0.55, 1.0, radius);
      const double brightness = 1.0 + rim * (0.35 * side - 0.25);
      const auto weight = static_cast<float>(opacity * (1.0 - SmoothStep(0.88, 1.0, radius)));
      const cv::Vec3f through =
          BilinearColor(blurred, outline.center + bending * from_center) * static_cast<float>(brightness);
      value = (1.0F - weight) * value + weight * through;
    });
  }
}

void CoverWithDebris(const SimulationOptions& options, double focal_px, double gain, double time_s, Eye eye,
                     cv::Mat& light) {
  constexpr double kStayS = 2.5;
  // Blue, green, red as the sensor is to show them (1: white).
  const cv::Vec3f mucus(0.50F, 0.66F, 0.74F);
  const cv::Vec3f stool(0.012F, 0.035F, 0.07F);
  const Random seed = Random(static_cast<std::uint64_t>(options.scene.seed)).Child("debris");
  for (Visitor& debris : VisitorsAt(time_s, options.sensor.debris, kStayS, seed)) {
    Random& random = debris.random;
    const double width = light.cols;
    Outline outline = DrawOutline(random, width * 0.008 * std::pow(5.0, random.Uniform()), 2.2);
    const double distance_mm = random.Uniform(10.0, 35.0);
    const double heading_rad = random.Uniform(0, 2 * std::numbers::pi);
    const double way_px = random.Uniform(0.1, 0.7) * width;
    const bool bright = random.Uniform() < 0.6;
    const double density = random.Uniform(0.4, 0.85);
    const Eigen::Vector2d middle(random.Uniform(0.0, 1.0) * width, random.Uniform(0.0, 1.0) * light.rows);
    outline.center =
        middle + (debris.age - 0.5) * way_px * Eigen::Vector2d(std::cos(heading_rad), std::sin(heading_rad));
    outline.heading_rad += 2.0 * (debris.age - 0.5);
    if (eye == Eye::kRight) outline.center.x() -= focal_px * options.camera.baseline_mm / distance_mm;
    // It comes into the light and goes out of it.
    const double lit = SmoothStep(0.0, 0.12, debris.age) * (1.0 - SmoothStep(0.88, 1.0, debris.age));
    const cv::Vec3f color = (bright ? mucus : stool) * static_cast<float>(1.0 / gain);
    ForPixelsIn(outline, light, [&](const Eigen::Vector2d&, double radius, cv::Vec3f& value) {
      const auto weight = static_cast<float>(lit * density * (1.0 - SmoothStep(0.0, 1.0, radius)));
      value = (1.0F - weight) * value + weight * color;
    });
  }
}

}  // namespace

void CoverLens(const SimulationOptions& options, double focal_px, double gain, double time_s, Eye eye, cv::Mat* light) {
  if (options.sensor.debris > 0) CoverWithDebris(options, focal_px, gain, time_s, eye, *light);
  if (options.sensor.drops > 0) CoverWithDrops(options, time_s, eye, *light);
}

}  // namespace pliant::simulation
