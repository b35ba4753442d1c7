// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A simulated sequence on disk, in the native layout (docs/formats.md): camera.yaml, images/NNNNNN.png,
// depth/NNNNNN.png (16-bit, z along the optical axis = value * depth_scale mm, 0 = none or out of range),
// right/NNNNNN.png where there is a right camera, groundtruth.txt (TUM, world_from_camera, mm), times.txt, and
// simulation.yaml with every option. The images are the simulator's after the compression that Recording asks for.
#pragma once

#include <filesystem>
#include <functional>

#include "pliant/base/status.h"
#include "pliant/simulation/options.h"
#include "pliant/simulation/simulator.h"

namespace pliant {

enum class SimulationContinue { kYes, kStop };

// Called once with 0 frames done when the scene stands, and after each frame is on disk.
using SimulationProgress = std::function<SimulationContinue(int frames_done, int frames_total)>;

// Renders every frame into `output`, which is made where it is not there; files of the same name are replaced, and
// images left from a longer simulation are removed; images in a folder without simulation.yaml are never touched. Poses
// and times are flushed as frames are done.
// Fails as Simulator::Create does, with kInvalidArgument (such a folder), with kUnwritable (the sentence names the
// file) and with kInterrupted when `progress` asked to stop (what was rendered is on disk and readable).
Status WriteSequence(const SimulationOptions& options, const std::filesystem::path& output,
                     const SimulationProgress& progress = {});

// The same from a simulator that is there already.
Status WriteSequence(Simulator& simulator, const std::filesystem::path& output,
                     const SimulationProgress& progress = {});

}  // namespace pliant
