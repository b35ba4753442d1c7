// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// What a run folder's sparse/ says of the run: its camera, its images' names, its points undeformed and in color.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "pliant/base/ids.h"
#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/io/run_reader.h"
#include "pliant/scene/frame_report.h"

namespace pliant {

struct RunMap {
  std::optional<Camera> camera;
  std::map<int, std::string> names;  // of the images, by frame
  std::map<PointId, NewPoint> points;
  bool interlaced = false;  // the images are
};

// Whether the models of all submaps of `run`, which was read from `run_path`, are there: a run that was killed has
// none, or some.
bool HasRunMap(const std::string& run_path, const Run& run);

// Of all submaps of `run`, which was read from `run_path`. Fails as colmap::ReadModel does, and with kMismatch where a
// model has not one camera.
Result<RunMap> ReadRunMap(const std::string& run_path, const Run& run);

}  // namespace pliant
