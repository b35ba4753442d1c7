// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A run as its exports see it: what there is of frames and points, and the observations as a stream.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/datasets/surface_folder.h"
#include "pliant/exchange/export.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/io/canonical_model.h"
#include "pliant/io/run_reader.h"

namespace pliant {

struct SourceFrame {
  int frame_idx = 0;
  double timestamp_s = 0;
  std::string name;
  Rigid3 cam_from_world;
};

struct RunSource {
  std::string run_path;
  std::shared_ptr<const Run> run;  // all of it, also of its other submaps
  Camera camera;
  SequenceRequest images;                // that the run was made of; an empty image_path: not known
  std::optional<SurfaceFolder> surface;  // has a depth of every frame
  std::vector<SourceFrame> frames;       // that are exported, by frame_idx
  std::vector<CanonicalPoint> points;    // seen in one of them, by id
  std::int64_t num_observations = 0;     // in all of them
  std::vector<std::string> notes;
  JobProgress progress = {};  // told of frames that are written; may be empty
};

// Every `stride`-th tracked frame of a run, of these those that the surface, where one is asked for, has a depth of;
// one source a submap, in their order. Fails as ExportRun does.
Result<std::vector<RunSource>> ReadRunSources(const ExportRequest& request, int stride);

// Whether the run says that a map unit is a millimeter.
bool IsMetric(const RunSource& source);

// Calls `function(frame, observations)` for every frame of the source, in order, also for those that see nothing.
using FrameFunction = std::function<Status(const SourceFrame&, const std::vector<PointObservation>&)>;
Status ForEachFrame(const RunSource& source, const FrameFunction& function);

}  // namespace pliant
