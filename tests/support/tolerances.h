// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Units, and tolerances that have the same reason in many tests. What has a reason of its own stands in its test.
#pragma once

#include <numbers>

namespace pliant {

inline constexpr double kDeg = std::numbers::pi / 180;  // rad

inline constexpr double kRoundOff = 1e-12;             // a few operations in double precision on values of about one
inline constexpr double kLengthRoundOff_mm = 1e-9;     // many of them on lengths of about 100 mm
inline constexpr double kAngleRoundOff_rad = 1e-7;     // an angle near none is known to the root of round-off, 1.5e-8
inline constexpr double kAngleRoundOff_deg = 1e-6;     // the same in degrees: 8.5e-7
inline constexpr double kFloatRoundOff_mm = 1e-5;      // lengths of about 100 mm kept as floats are right to 4e-6 mm
inline constexpr double kFileLength_mm = 2e-6;         // files hold six decimals: half a step a coordinate, twice
inline constexpr double kFilePixel_px = 1e-4;          // files hold four decimals of a pixel: half a step a coordinate
inline constexpr double kExactReprojection_px = 1e-3;  // what pixels and positions from a file leave of no error

}  // namespace pliant
