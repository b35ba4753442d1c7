// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>

#include "pliant/base/status.h"
#include "pliant/refinement/refine_recording.h"

namespace pliant {

inline constexpr std::ptrdiff_t kMinRefinedPoints = 8;

// Whether a recording can be solved for: kInsufficient below two views or eight points, kInvalidArgument for indices or
// numbers that are none.
Status CheckRecording(const Recording& recording, const RefineOptions& options);

}  // namespace pliant
