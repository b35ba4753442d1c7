// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/run_map.h"

#include <algorithm>
#include <utility>

#include "pliant/base/text.h"
#include "pliant/colmap/convert.h"
#include "pliant/colmap/model.h"

namespace pliant {
namespace {

std::string ModelFolder(const std::string& run_path, const Run& run, int submap) {
  const bool is_only = !run.summary || run.summary->submaps <= 1;
  return run_path + "/sparse" + (is_only ? "" : "/" + std::to_string(submap));
}

int CountModels(const Run& run) { return run.summary ? std::max(1, run.summary->submaps) : 1; }

Status AddModel(const std::string& folder, RunMap* map) {
  const auto model = colmap::ReadModel(folder, colmap::Observations::kSkipped);
  if (!model.ok()) return model.status();
  if (model->cameras.size() != 1)
    return Status(ErrorCode::kMismatch,
                  Quoted(folder) + " is not a run's: it has " + std::to_string(model->cameras.size()) + " cameras");
  auto camera = colmap::ToPliant(model->cameras.front());
  if (!camera.ok()) return camera.status();
  map->camera = std::move(camera).value();
  for (const colmap::Image& image : model->images) map->names.emplace(static_cast<int>(image.id) - 1, image.name);
  for (const colmap::Point3D& point : model->points3D) {
    const PointId id{static_cast<std::int64_t>(point.id)};
    map->points.emplace(id, NewPoint{id, colmap::ToPliant(point), point.rgb});
  }
  return Status::Ok();
}

}  // namespace

bool HasRunMap(const std::string& run_path, const Run& run) {
  for (int submap = 0; submap < CountModels(run); ++submap)
    if (!colmap::FindModel(ModelFolder(run_path, run, submap)).ok()) return false;
  return true;
}

Result<RunMap> ReadRunMap(const std::string& run_path, const Run& run) {
  RunMap map;
  map.interlaced = run.summary && run.summary->description.interlaced;
  for (int submap = 0; submap < CountModels(run); ++submap)
    if (Status status = AddModel(ModelFolder(run_path, run, submap), &map); !status.ok()) return status;
  return map;
}

}  // namespace pliant
