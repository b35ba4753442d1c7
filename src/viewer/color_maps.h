// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Colors of values, which the color-blind read too, for figures; the same as in the page of a report
// (web/src/colors.ts). Magnitudes have viridis; what has a sign has Moreland's cool to warm (Diverging color maps for
// scientific visualization, ISVC 2009), whose gray middle is 0.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

namespace pliant {

using Rgb = std::array<float, 3>;  // 0 to 255

inline constexpr Rgb kUnknownRgb = {140, 149, 159};

enum class ColorMap { kViridis, kDiverging };

// `share` of the way from the lowest value to the highest, of which 0 is the middle in kDiverging; kUnknownRgb where it
// is not a number.
inline Rgb ColorAt(ColorMap map, double share) {
  constexpr std::array<Rgb, 16> kViridis = {{{68, 1, 84},
                                             {72, 26, 108},
                                             {71, 47, 125},
                                             {65, 68, 135},
                                             {57, 86, 140},
                                             {49, 104, 142},
                                             {42, 120, 142},
                                             {35, 136, 142},
                                             {31, 152, 139},
                                             {34, 168, 132},
                                             {53, 183, 121},
                                             {84, 197, 104},
                                             {122, 209, 81},
                                             {165, 219, 54},
                                             {210, 226, 27},
                                             {253, 231, 37}}};
  constexpr std::array<Rgb, 17> kCoolToWarm = {{{59, 76, 192},
                                                {77, 104, 215},
                                                {98, 130, 234},
                                                {119, 154, 247},
                                                {141, 176, 254},
                                                {163, 194, 255},
                                                {184, 208, 249},
                                                {204, 217, 238},
                                                {221, 221, 221},
                                                {236, 211, 197},
                                                {245, 196, 173},
                                                {247, 177, 148},
                                                {244, 154, 123},
                                                {236, 127, 99},
                                                {222, 96, 77},
                                                {203, 62, 56},
                                                {180, 4, 38}}};
  if (std::isnan(share)) return kUnknownRgb;
  const std::span<const Rgb> colors = map == ColorMap::kDiverging ? std::span<const Rgb>(kCoolToWarm) : kViridis;
  const double at = std::clamp(share, 0.0, 1.0) * (static_cast<double>(colors.size()) - 1.0);
  const std::size_t index = std::min(static_cast<std::size_t>(at), colors.size() - 2);
  const auto part = static_cast<float>(at - static_cast<double>(index));
  Rgb color{};
  for (std::size_t c = 0; c < 3; ++c) color[c] = std::lerp(colors[index][c], colors[index + 1][c], part);
  return color;
}

}  // namespace pliant
