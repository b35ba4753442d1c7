// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The scale and the shift between two measurements of the same (docs/method.md, N2).
#pragma once

#include <optional>
#include <vector>

namespace pliant {

struct ScaleAndShift {
  double scale = 1;
  double shift = 0;
  double sigma = 0;  // of the relative error that is left
};

// target = scale * value + shift by relative errors, with Cauchy's loss at twice their own sigma and a weak preference
// of no shift. Both lists are as long, of positive numbers. Nothing for fewer than twelve, and where a target falls as
// its value grows.
std::optional<ScaleAndShift> FitScaleAndShift(const std::vector<double>& values, const std::vector<double>& targets);

}  // namespace pliant
