// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The simulator of a sequence on disk: whoever has the folder that WriteSequence left can ask for the truth of any
// pixel of any frame. Nothing is rendered, and the texture is not built until something is.
#pragma once

#include <filesystem>

#include "pliant/base/status.h"
#include "pliant/simulation/options.h"
#include "pliant/simulation/simulator.h"

namespace pliant {

// The options beside a sequence (simulation.yaml). Fails with kNotFound where there is no such file: the sequence was
// not simulated; with kUnreadable or kInvalidArgument where it is not a file of simulation options (the sentence has
// file and line).
Result<SimulationOptions> ReadSimulationOptions(const std::filesystem::path& sequence_folder);

// Builds the simulator that made the sequence and compares it with what lies there: camera.yaml, every pose of
// groundtruth.txt and the depth of the first frame. Fails as ReadSimulationOptions and Simulator::Create do, as the
// readers of those files do, and with kMismatch where they show another scene than the options describe (a file was
// edited, or another version of Pliant wrote the sequence). A sequence may have fewer frames than its options say, when
// its making was interrupted; what was asked of later frames is answered all the same.
Result<Simulator> OpenSimulation(const std::filesystem::path& sequence_folder);

}  // namespace pliant
