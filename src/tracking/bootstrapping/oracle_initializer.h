// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The first map with the true depths of a simulated scene (Oracle.first_map).
#pragma once

#include <memory>
#include <optional>

#include "pliant/tracking/bootstrapping/initializer.h"
#include "pliant/tracking/tracks/oracle.h"

namespace pliant {

// The map from the reference alone: its points at their true depths; a new reference where fewer than `min_points` of
// them show the surface. `replaced` is the initializer whose points it takes. `nominal_depth_mm`: what the map's median
// depth is scaled to; nothing: true millimeters. `truth` must outlive the result.
std::unique_ptr<Initializer> MakeOracleInitializer(TrackingTruth* truth, std::optional<double> nominal_depth_mm,
                                                   int min_points, std::unique_ptr<Initializer> replaced);

}  // namespace pliant
