// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What a surface says of its frames and its mesh: why they are missing, and what to beware of. Sentences without a full
// stop.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pipeline/run_views.h"
#include "pipeline/surface_meshes.h"
#include "pliant/base/status.h"
#include "pliant/io/run_map.h"
#include "pliant/io/run_reader.h"
#include "pliant/pipeline/surface_run.h"
#include "pliant/surface/dense_depth.h"

namespace pliant {

// Of a frame that no other one can be compared with.
std::string NoteWithoutNeighbors(const SurfaceRunOptions& options);
// Of a frame none of whose pixels has a depth: why most of them have none, and what to do.
std::string NoteWithoutDepth(const RejectedPixels& rejected, const DenseDepthOptions& options);

// The chosen frames that have no pose, with a note of why. Another program's run does not say which frames it read.
std::vector<SurfaceFrame> FramesWithoutPose(const SurfaceRequest& request, const Run& run,
                                            const std::vector<PosedFrame>& posed);
// Of these frames, one for each reason.
std::vector<std::string> WarningsOf(const std::vector<SurfaceFrame>& missing, const Run& run);
// Why there is no frame to make a depth of.
Status NoFrameChosen(const SurfaceRequest& request, const Run& run, const std::vector<SurfaceFrame>& missing);
// Why no frame has a depth: what is said of the first one that was looked at.
std::string ReasonOf(const std::vector<SurfaceFrame>& frames);
// Of the frames whose map is provisional; empty where none is.
std::string ProvisionalWarning(const std::vector<SurfaceFrame>& frames);
// Of the chosen frames, by their positions, whose points rest where they were seen first; empty where none do.
std::string StillWarning(const std::vector<PosedFrame>& frames, const std::vector<std::size_t>& chosen,
                         const RunMap& run);
// Of files of a mesh that are wanted and not there; empty where none are.
std::string MeshWarning(const MadeMeshes& made, const SurfaceRunOptions& options);

}  // namespace pliant
