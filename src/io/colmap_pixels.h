// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Where COLMAP's pixel origin and ours meet: the first pixel's centre is (0.5, 0.5) there and (0, 0) here.
#pragma once

#include <string_view>
#include <vector>

#include "pliant/camera/camera.h"

namespace pliant {

inline constexpr double kColmapPixelShift = 0.5;  // COLMAP's coordinate minus ours, px

// Adds `shift_px` to the principal point in a model's parameters.
void ShiftPrincipalPoint(CameraModelId model, double shift_px, std::vector<double>& params);

// The model of a name, or an error that names the nearest one.
Result<CameraModelId> ColmapModel(std::string_view name);

}  // namespace pliant
