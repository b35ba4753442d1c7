// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The meshes of a surface folder, from the depths that are there.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "pipeline/run_views.h"
#include "pliant/base/status.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/datasets/surface_folder.h"
#include "pliant/io/run_reader.h"
#include "pliant/pipeline/surface_run.h"

namespace pliant {

struct MeshSource {
  const std::vector<PosedFrame>& frames;
  const RunMap& known;
  const SurfaceFolder& folder;
  const SequenceRequest& images;
  const std::vector<RunFrame>& read;  // every frame that the run read; of another program's run none
  const std::set<int>& chosen;        // frames that the surface was asked for; empty: all
};

// Told how many of how many steps are done; false: no more are wanted.
using MeshProgress = std::function<bool(int done, int total)>;

struct MadeMeshes {
  bool stopped = false;  // no more was wanted before the end: files of frames are whole, but not all there
  int submaps = 0;       // that have a depth
  int meshes = 0;        // of these; fewer where the depths of a submap give no piece that is large enough
};

// A mesh of all that the frames of a submap show, and where it is in each of these. Fails as RunViews and
// ReadSurfaceDepth do, and with kUnwritable.
Result<MadeMeshes> MakeMeshes(const MeshSource& source, const SurfaceRunOptions& options, int threads,
                              const MeshProgress& go_on);

}  // namespace pliant
