// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// How well a run explains what it tracked: its points, by its poses and its camera, against the pixels at which it
// tracked them. It needs no truth and says nothing of it.
#pragma once

#include <cstdint>
#include <optional>

#include "pliant/camera/camera.h"
#include "pliant/evaluation/run_input.h"

namespace pliant {

struct ReprojectionError {
  std::int64_t points = 0;  // observations that project
  double median_px = 0;
  double rmse_px = 0;
};

// Nothing where no observation projects.
std::optional<ReprojectionError> ComputeReprojectionError(const EvaluationInput& run, const Camera& camera);

}  // namespace pliant
