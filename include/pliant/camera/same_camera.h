// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Whether two cameras are one, as files have them.
#pragma once

#include <algorithm>
#include <cmath>

#include "pliant/camera/camera.h"

namespace pliant {

// Whether two cameras have one image size, model and parameters, but for what writing them into files rounds off.
inline bool IsSameCamera(const Camera& a, const Camera& b) {
  constexpr double kSameParameter = 1e-6;  // px: files hold more digits
  return a.model_id() == b.model_id() && a.width() == b.width() && a.height() == b.height() &&
         std::ranges::equal(a.params(), b.params(),
                            [](double p, double q) { return std::abs(p - q) <= kSameParameter; });
}

}  // namespace pliant
