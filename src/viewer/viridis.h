// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Viridis, which the color-blind read too, for figures; the same as in the page of a report (web/src/colors.ts).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace pliant {

using Rgb = std::array<float, 3>;  // 0 to 255

inline constexpr Rgb kUnknownRgb = {140, 149, 159};

// `share` of the way from the lowest value to the highest; kUnknownRgb where it is not a number.
inline Rgb ViridisAt(double share) {
  constexpr std::array<Rgb, 16> kColors = {{{68, 1, 84},
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
  if (std::isnan(share)) return kUnknownRgb;
  const double at = std::clamp(share, 0.0, 1.0) * (kColors.size() - 1.0);
  const std::size_t index = std::min(static_cast<std::size_t>(at), kColors.size() - 2);
  const auto part = static_cast<float>(at - static_cast<double>(index));
  Rgb color{};
  for (std::size_t c = 0; c < 3; ++c) color[c] = std::lerp(kColors[index][c], kColors[index + 1][c], part);
  return color;
}

}  // namespace pliant
