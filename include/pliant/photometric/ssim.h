// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Structural similarity (Wang et al., IEEE TIP 2004, docs/method.md (P5)) of two patches as wholes, from their moments:
//   SSIM = (2 mx my + C1) (2 sxy + C2) / ((mx^2 + my^2 + C1) (sx^2 + sy^2 + C2)),  C1 = (0.01 * 255)^2,
//   C2 = (0.03 * 255)^2, for gray levels 0..255.
#pragma once

namespace pliant {

inline constexpr double kSsimC1 = 6.5025;
inline constexpr double kSsimC2 = 58.5225;

struct PatchMoments {
  double mean_x = 0, mean_y = 0;  // gray levels
  double var_x = 0, var_y = 0, cov = 0;
};

inline double Ssim(const PatchMoments& m) {
  return (2 * m.mean_x * m.mean_y + kSsimC1) * (2 * m.cov + kSsimC2) /
         ((m.mean_x * m.mean_x + m.mean_y * m.mean_y + kSsimC1) * (m.var_x + m.var_y + kSsimC2));
}

// Moments of x and gain * y + bias.
inline PatchMoments Compensated(const PatchMoments& m, double gain, double bias) {
  return {m.mean_x, gain * m.mean_y + bias, m.var_x, gain * gain * m.var_y, gain * m.cov};
}

}  // namespace pliant
