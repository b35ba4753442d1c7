// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulation/image_texture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

namespace pliant::simulation {
namespace {

Eigen::Vector3f Bilinear(const cv::Mat& level, const Eigen::Vector2f& chart) {
  const auto wrap = [](int i, int n) { return ((i % n) + n) % n; };
  // Within one repetition first, so that large coordinates keep their precision. Rows run down, v runs up.
  const float u = (chart.x() - std::floor(chart.x())) * static_cast<float>(level.cols) - 0.5F;
  const float v = (1.0F - (chart.y() - std::floor(chart.y()))) * static_cast<float>(level.rows) - 0.5F;
  const int x = static_cast<int>(std::floor(u));
  const int y = static_cast<int>(std::floor(v));
  const float a = u - static_cast<float>(x);
  const float b = v - static_cast<float>(y);
  const auto at = [&](int row, int column) {
    const auto& value = level.at<cv::Vec3w>(wrap(row, level.rows), wrap(column, level.cols));
    return Eigen::Vector3f(value[0], value[1], value[2]);
  };
  return ((1 - b) * ((1 - a) * at(y, x) + a * at(y, x + 1)) + b * ((1 - a) * at(y + 1, x) + a * at(y + 1, x + 1))) /
         65535.0F;
}

}  // namespace

ImageTexture::ImageTexture(const Surface& surface) {
  std::array<std::uint16_t, 256> linear{};
  for (int i = 0; i < 256; ++i) linear[i] = static_cast<std::uint16_t>(std::lround(65535.0 * std::pow(i / 255.0, 2.2)));
  cv::Mat level(surface.image.size(), CV_16UC3);
  for (int y = 0; y < level.rows; ++y)
    for (int x = 0; x < level.cols; ++x)
      for (int c = 0; c < 3; ++c) level.at<cv::Vec3w>(y, x)[c] = linear[surface.image.at<cv::Vec3b>(y, x)[c]];
  double area_mm2 = 0;
  double area_texels = 0;
  for (const auto& t : surface.triangles) {
    const Eigen::Vector3f ab = surface.vertices[t[1]] - surface.vertices[t[0]];
    const Eigen::Vector3f ac = surface.vertices[t[2]] - surface.vertices[t[0]];
    const Eigen::Vector2f chart_ab = surface.chart[t[1]] - surface.chart[t[0]];
    const Eigen::Vector2f chart_ac = surface.chart[t[2]] - surface.chart[t[0]];
    area_mm2 += 0.5 * ab.cross(ac).norm();
    area_texels += 0.5 * std::abs(chart_ab.x() * chart_ac.y() - chart_ab.y() * chart_ac.x()) * level.cols * level.rows;
  }
  if (area_texels > 0) texel_mm_ = static_cast<float>(std::sqrt(area_mm2 / area_texels));
  levels_.push_back(level);
  while (std::min(levels_.back().cols, levels_.back().rows) > 4) {
    cv::Mat half;
    cv::resize(levels_.back(), half, cv::Size(levels_.back().cols / 2, levels_.back().rows / 2), 0, 0, cv::INTER_AREA);
    levels_.push_back(half);
  }
}

Eigen::Vector3f ImageTexture::At(const Eigen::Vector2f& chart, float footprint_mm) const {
  const float level =
      std::clamp(std::log2(std::max(footprint_mm / texel_mm_, 1.0F)), 0.0F, static_cast<float>(levels_.size()) - 1.0F);
  const auto i = std::min(static_cast<std::size_t>(level), levels_.size() - 1);
  const float t = level - static_cast<float>(i);
  Eigen::Vector3f fine = Bilinear(levels_[i], chart);
  if (t < 1e-3F || i + 1 == levels_.size()) return fine;
  return fine + t * (Bilinear(levels_[i + 1], chart) - fine);
}

}  // namespace pliant::simulation
