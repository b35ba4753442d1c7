// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What a simulated sequence has that others have not (docs/formats.md).
#pragma once

namespace pliant::simulation {

inline constexpr const char* kOptionsFile = "simulation.yaml";

}  // namespace pliant::simulation
