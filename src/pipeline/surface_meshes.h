// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The meshes of a surface folder, from the depths that are there.
#pragma once

#include <string>
#include <vector>

#include "pipeline/run_views.h"
#include "pliant/base/status.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/datasets/surface_folder.h"
#include "pliant/pipeline/surface_run.h"

namespace pliant {

struct MeshSource {
  const std::vector<PosedFrame>& frames;
  const RunMap& known;
  const SurfaceFolder& folder;
  const SequenceRequest& images;
};

// A mesh of all that the frames of a submap show, and where it is in each of these. Fails as RunViews,
// ReadSurfaceDepth do, and with kUnwritable.
Status MakeMeshes(const MeshSource& source, const SurfaceRunOptions& options, int threads);

}  // namespace pliant
