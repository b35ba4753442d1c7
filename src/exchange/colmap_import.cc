// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <utility>

#include "exchange/imported.h"
#include "pliant/base/text.h"
#include "pliant/colmap/check.h"
#include "pliant/colmap/convert.h"
#include "pliant/colmap/model.h"

namespace pliant {
namespace {

// The frames of a sequence by the names of their images.
class FrameNames {
 public:
  explicit FrameNames(const Sequence& sequence) {
    for (int frame_idx = 0; frame_idx < sequence.size(); ++frame_idx) {
      const auto name = sequence.Name(frame_idx);
      if (!name) continue;
      by_name_.emplace(*name, frame_idx);
      by_stem_.emplace(std::filesystem::path(*name).stem().string(), frame_idx);
      if (first_.empty()) first_ = *name;
    }
  }

  // By the file's name, whatever folder COLMAP found it in; else by its stem.
  std::optional<int> Find(const std::string& image_name) const {
    const std::filesystem::path path(image_name);
    if (const auto found = by_name_.find(path.filename().string()); found != by_name_.end()) return found->second;
    if (const auto found = by_stem_.find(path.stem().string()); found != by_stem_.end()) return found->second;
    return std::nullopt;
  }
  const std::string& first() const { return first_; }

 private:
  std::map<std::string, int> by_name_;
  std::map<std::string, int> by_stem_;
  std::string first_;
};

Status CheckOne(std::size_t cameras, const std::string& folder) {
  if (cameras == 1) return Status::Ok();
  return {ErrorCode::kInvalidArgument,
          "the model " + Quoted(folder) + " has " + std::to_string(cameras) +
              " cameras, and a run has one; let COLMAP know that all images are of one camera "
              "(feature_extractor --ImageReader.single_camera 1)"};
}

Result<Camera> TheCamera(const colmap::Model& model, const std::string& folder) {
  if (Status status = CheckOne(model.cameras.size(), folder); !status.ok()) return status;
  auto camera = colmap::ToPliant(model.cameras.front());
  if (camera.ok()) return camera;
  return Status(camera.status().code(), "the model " + Quoted(folder) + ": " + camera.status().message());
}

// Keypoints with a point, sorted by it; where an image sees a point twice, as COLMAP's may, the first stands.
std::vector<PointObservation> ObservationsOf(const colmap::Image& image, const colmap::PointsById& points,
                                             int* repeated) {
  std::vector<PointObservation> observations;
  for (const colmap::Point2D& keypoint : image.points2D) {
    if (keypoint.point3D_id == colmap::kNoPoint3D) continue;
    observations.push_back({PointId{static_cast<std::int64_t>(keypoint.point3D_id)}, colmap::ToPliant(keypoint),
                            colmap::ToPliant(*points.at(keypoint.point3D_id)), 0});
  }
  const auto same = [](const PointObservation& a, const PointObservation& b) { return a.id == b.id; };
  std::stable_sort(observations.begin(), observations.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  const auto end = std::unique(observations.begin(), observations.end(), same);
  *repeated += static_cast<int>(observations.end() - end);
  observations.erase(end, observations.end());
  return observations;
}

Status AddImages(const colmap::Model& model, const Sequence& sequence, const std::string& folder, Imported* imported) {
  const colmap::PointsById points = colmap::ById(model.points3D);
  for (const colmap::Point3D& point : model.points3D) {
    if (point.id > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
      return {ErrorCode::kUnreadable, "the model " + Quoted(folder) + " has a point with the id " +
                                          std::to_string(point.id) + ", which is impossibly large; it is damaged"};
    imported->colors.emplace(PointId{static_cast<std::int64_t>(point.id)}, point.rgb);
  }
  const FrameNames names(sequence);
  std::map<int, const std::string*> image_of;
  int unknown = 0;
  int repeated = 0;
  for (const colmap::Image& image : model.images) {
    const auto frame_idx = names.Find(image.name);
    if (!frame_idx) {
      ++unknown;
      continue;
    }
    const auto [other, is_new] = image_of.emplace(*frame_idx, &image.name);
    if (!is_new)
      return {ErrorCode::kMismatch, "the images " + Quoted(*other->second) + " and " + Quoted(image.name) +
                                        " of the model " + Quoted(folder) + " are both frame " +
                                        std::to_string(*frame_idx) + " of the sequence"};
    const auto pose = colmap::ToPliant(image.cam_from_world);
    if (!pose.ok()) return {pose.status().code(), "image " + Quoted(image.name) + ": " + pose.status().message()};
    imported->frames.emplace(*frame_idx, ImportedFrame{*pose, ObservationsOf(image, points, &repeated)});
  }
  if (imported->frames.empty() && !model.images.empty())
    return {ErrorCode::kMismatch, "no image of the model " + Quoted(folder) + " is in the sequence: the first is " +
                                      Quoted(model.images.front().name) + " here and " + Quoted(names.first()) +
                                      " there"};
  if (unknown > 0) imported->notes.push_back(std::to_string(unknown) + " images of the model are not in the sequence");
  if (repeated > 0)
    imported->notes.push_back(std::to_string(repeated) +
                              " keypoints see a point that another one of their image sees already; they are left out");
  return Status::Ok();
}

}  // namespace

Status CheckOneCamera(const std::string& folder) {
  for (const char* name : {"cameras.bin", "cameras.txt"}) {
    const std::filesystem::path path = std::filesystem::path(folder) / name;
    std::error_code error;
    if (!std::filesystem::exists(path, error)) continue;
    const auto cameras = colmap::ReadCameras(path.string());
    return cameras.ok() ? CheckOne(cameras->size(), folder) : Status::Ok();
  }
  return Status::Ok();
}

Result<Imported> ReadColmapModel(const std::string& folder, const Sequence& sequence, const JobProgress& progress) {
  const auto model = colmap::ReadValidModel(folder, progress);
  if (!model.ok()) return model.status();
  const auto camera = TheCamera(*model, folder);
  if (!camera.ok()) return camera.status();
  Imported imported;
  imported.camera = *camera;
  if (Status status = AddImages(*model, sequence, folder, &imported); !status.ok()) return status;
  return imported;
}

}  // namespace pliant
