// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/canonical_model.h"

#include <algorithm>
#include <limits>

#include "colmap/model_file.h"
#include "colmap/rows.h"
#include "pliant/base/files.h"
#include "pliant/base/text.h"
#include "pliant/colmap/convert.h"
#include "pliant/io/run_reader.h"
#include "pliant/io/run_summary.h"
#include "pliant/scene/serialize.h"

namespace pliant {
namespace {

// COLMAP's own programs end where they meet a shorter track.
constexpr std::int64_t kMinObservations = 2;
// Track elements held at once: 8 bytes each.
constexpr std::int64_t kMaxTrackElements = 4'000'000;

std::vector<int> FramesOf(std::span<const CanonicalImage> images) {
  std::vector<int> frames_idx;
  for (const CanonicalImage& image : images) frames_idx.push_back(image.frame_idx);
  return frames_idx;
}

Status WriteImages(FileGroup& group, const std::string& folder, colmap::Format format,
                   std::span<const CanonicalPoint> points, std::span<const CanonicalImage> images,
                   const std::string& run_path) {
  auto file = colmap::ModelFile::Create(group, folder, "images", format);
  if (!file.ok()) return file.status();
  file->Begin(colmap::ImagesHeader(images.size()), images.size());
  Status status = ForEachFrame(run_path, FramesOf(images), [&](std::size_t k, const auto& observations) {
    const CanonicalImage& image = images[k];
    colmap::Image converted{
        ColmapImageId(image.frame_idx), colmap::FromPliant(image.cam_from_world), 1, image.name, {}};
    for (const PointObservation& o : observations)
      converted.points2D.push_back(colmap::FromPliant(
          o.pixel, FindPoint(points, o.id) != nullptr ? static_cast<std::uint64_t>(o.id.value) : colmap::kNoPoint3D));
    return file->Add(converted);
  });
  if (!status.ok()) return status;
  return file->Close();
}

using colmap::TrackElement;

// The tracks of consecutive points, one after the other in one array.
Result<std::vector<TrackElement>> Tracks(std::span<const CanonicalPoint> points, std::span<const CanonicalImage> images,
                                         const std::string& run_path) {
  std::vector<std::int64_t> next;   // where each point's next element goes
  std::vector<std::int64_t> limit;  // where its elements end
  std::int64_t total = 0;
  for (const CanonicalPoint& point : points) {
    next.push_back(total);
    limit.push_back(total += point.num_observations);
  }
  Status mismatch(ErrorCode::kMismatch, "the observations in " + Quoted(run_path) + " are not those that were counted");
  std::vector<TrackElement> elements(static_cast<std::size_t>(total));
  const Status status = ForEachFrame(run_path, FramesOf(images), [&](std::size_t k, const auto& observations) {
    auto point = points.begin();
    for (std::size_t i = 0; i < observations.size(); ++i) {
      const PointId id = observations[i].id;
      point = std::lower_bound(point, points.end(), id,
                               [](const CanonicalPoint& p, PointId wanted) { return p.point.id < wanted; });
      if (point == points.end()) break;
      if (point->point.id != id) continue;
      const auto idx = static_cast<std::size_t>(point - points.begin());
      if (next[idx] == limit[idx]) return mismatch;
      elements[static_cast<std::size_t>(next[idx]++)] = {ColmapImageId(images[k].frame_idx),
                                                         static_cast<std::uint32_t>(i)};
    }
    return Status::Ok();
  });
  if (!status.ok()) return status;
  if (next != limit) return mismatch;
  return elements;
}

colmap::Point3D Converted(const CanonicalPoint& point) {
  const Eigen::Vector3d& position = point.point.position;
  return {static_cast<std::uint64_t>(point.point.id.value),
          {position.x(), position.y(), position.z()},
          point.point.rgb,
          point.error_px,
          {}};
}

// A run that was refined as a rigid scene has each point at one place.
std::string RemarkOnPositions(const std::string& run_path) {
  const auto summary = ReadRunSummary(run_path + "/run.json");
  const bool is_rigid = summary.ok() && summary->description.refinement &&
                        std::ranges::all_of(summary->description.refinement->models,
                                            [](RefinedModel model) { return model == RefinedModel::kRigid; });
  return is_rigid ? "# Positions are those of a rigid scene, and the same in all images"
                  : "# Positions are undeformed: the scene moved, so this model is not consistent with bundle "
                    "adjustment";
}

Status WritePoints(FileGroup& group, const std::string& folder, colmap::Format format,
                   std::span<const CanonicalPoint> points, std::span<const CanonicalImage> images,
                   const std::string& run_path) {
  auto file = colmap::ModelFile::Create(group, folder, "points3D", format);
  if (!file.ok()) return file.status();
  file->Begin(colmap::PointsHeader(points.size()) + "\n" + RemarkOnPositions(run_path), points.size());
  std::size_t begin = 0;
  while (begin < points.size()) {
    std::int64_t total = points[begin].num_observations;
    std::size_t end = begin + 1;
    while (end < points.size() && total + points[end].num_observations <= kMaxTrackElements)
      total += points[end++].num_observations;
    const std::span<const CanonicalPoint> range(points.data() + begin, end - begin);
    const auto elements = Tracks(range, images, run_path);
    if (!elements.ok()) return elements.status();
    std::size_t first = 0;
    for (const CanonicalPoint& point : range) {
      const auto length = static_cast<std::size_t>(point.num_observations);
      Status status = file->Add(Converted(point), std::span(*elements).subspan(first, length));
      if (!status.ok()) return status;
      first += length;
    }
    begin = end;
  }
  return file->Close();
}

}  // namespace

void CountObservation(const Camera& camera, const Rigid3& cam_from_world, const PointObservation& observation,
                      CanonicalPoint* point) {
  ++point->num_observations;
  point->mean_sigma += (observation.sigma - point->mean_sigma) / static_cast<double>(point->num_observations);
  if (const auto error_px = ReprojectionErrorPx(camera, cam_from_world, observation))
    point->error_px += (*error_px - point->error_px) / static_cast<double>(point->num_observations);
}

Status WriteCanonicalModel(const std::string& folder, colmap::Format format, const Camera& camera,
                           std::span<const CanonicalImage> images, std::span<const CanonicalPoint> points,
                           const std::string& run_path) {
  FileGroup group;
  if (Status status = colmap::WriteCamera(group, folder, format, colmap::FromPliant(camera, 1)); !status.ok())
    return status;
  std::vector<CanonicalPoint> shown;
  for (const CanonicalPoint& point : points)
    if (point.num_observations >= kMinObservations) shown.push_back(point);
  if (Status status = WriteImages(group, folder, format, shown, images, run_path); !status.ok()) return status;
  if (Status status = WritePoints(group, folder, format, shown, images, run_path); !status.ok()) return status;
  return group.Commit();
}

void Serialize(StateArchive& archive, CanonicalImage& image) { archive.Members<4>(image); }
void Serialize(StateArchive& archive, CanonicalPoint& point) { archive.Members<5>(point); }

}  // namespace pliant
