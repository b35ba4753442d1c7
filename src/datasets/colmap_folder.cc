// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A folder as COLMAP leaves it: images/ and a model in sparse/0/ or sparse/, whose camera and poses are the sequence's;
// its unit is taken for millimeters.
#include <map>
#include <utility>

#include "datasets/formats.h"
#include "datasets/set_files.h"
#include "pliant/colmap/convert.h"
#include "pliant/colmap/model.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

fs::path ModelOf(const fs::path& path) {
  for (const fs::path& folder : {path / "sparse" / "0", path / "sparse"})
    if (IsFile(folder / "images.bin") || IsFile(folder / "images.txt")) return folder;
  return {};
}

}  // namespace

bool IsColmapFolder(const fs::path& path) {
  return IsFolder(path / "images") && !IsFile(path / "camera.yaml") && !ModelOf(path).empty();
}

Result<DataSet> OpenColmapFolder(const SequenceRequest& request) {
  if (!request.camera_path.empty()) return OpenNativeSequence(request);  // the model is then something else beside it
  const fs::path folder = ModelOf(request.image_path);
  auto images = StreamFolder(request.image_path / "images");
  if (!images.ok()) return images.status();
  const auto model = colmap::ReadModel(folder.string(), colmap::Observations::kSkipped);
  if (!model.ok()) return model.status();
  if (model->cameras.size() != 1)
    return Status(ErrorCode::kMismatch,
                  "the model " + folder.string() + " has " + std::to_string(model->cameras.size()) +
                      " cameras; a sequence has one: reconstruct with --ImageReader.single_camera 1");
  const auto camera = colmap::ToPliant(model->cameras.front());
  if (!camera.ok()) return camera.status();
  std::map<std::string, Rigid3> poses;
  for (const colmap::Image& image : model->images) {
    const auto cam_from_world = colmap::ToPliant(image.cam_from_world);
    if (!cam_from_world.ok()) return cam_from_world.status();
    poses.emplace(fs::path(image.name).filename().string(), cam_from_world->Inverse());
  }
  auto data_set = Calibrated(request, *std::move(images), SourceCalibration{*camera, folder});
  if (!data_set.ok()) return data_set.status();
  if (request.mask_path.empty() && IsFolder(request.image_path / "masks"))
    data_set->mask_path = request.image_path / "masks";
  for (int idx = 0; idx < data_set->images->count(); ++idx) {
    const auto pose = poses.find(data_set->images->Name(idx));
    data_set->world_from_cam.push_back(pose == poses.end() ? std::nullopt : std::optional(pose->second));
  }
  return data_set;
}

}  // namespace pliant
