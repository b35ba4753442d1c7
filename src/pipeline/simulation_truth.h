// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The truth of a sequence that `simulate` wrote, for the tracker's oracle switches: the scene is built again from
// simulation.yaml.
#pragma once

#include <filesystem>
#include <memory>

#include "pliant/base/status.h"
#include "pliant/datasets/sequence.h"
#include "pliant/tracking/tracks/oracle.h"

namespace pliant {

// Fails with kNotFound where `folder` has no simulation.yaml, as OpenSimulation does, and with kMismatch where the
// sequence's camera or its number of frames is not the scene's.
Result<std::unique_ptr<TrackingTruth>> OpenSimulationTruth(const std::filesystem::path& folder,
                                                           const Sequence& sequence);

}  // namespace pliant
