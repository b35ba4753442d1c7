// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/canonical_model.h"

#include <algorithm>
#include <limits>

#include "colmap/model_file.h"
#include "colmap/rows.h"
#include "pliant/base/text.h"
#include "pliant/colmap/convert.h"
#include "pliant/io/run_reader.h"

namespace pliant {
namespace {

// Track elements held at once: 8 bytes each.
constexpr std::int64_t kMostTrackElements = 4'000'000;

void AppendImage(colmap::ModelFile* file, const CanonicalImage& image, std::span<const PointObservation> observations) {
  colmap::Image converted{ColmapImageId(image.frame_idx), colmap::FromPliant(image.cam_from_world), 1, image.name, {}};
  for (const PointObservation& o : observations)
    converted.points2D.push_back(colmap::FromPliant(o.pixel, static_cast<std::uint64_t>(o.id.value)));
  colmap::AppendTextImage(converted, colmap::Digits::kRounded, &file->text);
  colmap::AppendBinaryImage(converted, &file->binary);
}

// Goes through a run's observations frame by frame.
template <class Function>
Status ForEachFrame(const std::string& run_path, const Function& function) {
  auto reader = ObservationReader::Open(run_path);
  if (!reader.ok()) return reader.status();
  while (true) {
    auto frame = reader->Next();
    if (!frame.ok()) return frame.status();
    if (!frame->has_value()) return Status::Ok();
    if (Status status = function(**frame); !status.ok()) return status;
  }
}

Status WriteImages(FileGroup& group, const std::string& folder, colmap::Format format,
                   std::span<const CanonicalImage> images, const std::string& run_path) {
  auto file = colmap::ModelFile::Create(group, folder, "images", format);
  if (!file.ok()) return file.status();
  file->text = colmap::ImagesHeader(images.size()) + "\n";
  AppendBytes(&file->binary, images.size(), 8);
  std::size_t next = 0;
  // Images without observations are images too.
  const auto append_until = [&](int frame_idx) {
    for (; next < images.size() && images[next].frame_idx < frame_idx; ++next) AppendImage(&*file, images[next], {});
  };
  Status status = ForEachFrame(run_path, [&](const FrameObservations& frame) {
    append_until(frame.frame_idx);
    if (next < images.size() && images[next].frame_idx == frame.frame_idx)
      AppendImage(&*file, images[next++], frame.observations);
    return file->Flush();
  });
  if (!status.ok()) return status;
  append_until(std::numeric_limits<int>::max());
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
  const Status status = ForEachFrame(run_path, [&](const FrameObservations& frame) {
    const auto image = std::lower_bound(images.begin(), images.end(), frame.frame_idx,
                                        [](const CanonicalImage& a, int wanted) { return a.frame_idx < wanted; });
    if (image == images.end() || image->frame_idx != frame.frame_idx) return Status::Ok();
    auto point = points.begin();
    for (std::size_t i = 0; i < frame.observations.size(); ++i) {
      const PointId id = frame.observations[i].id;
      point = std::lower_bound(point, points.end(), id,
                               [](const CanonicalPoint& p, PointId wanted) { return p.point.id < wanted; });
      if (point == points.end()) break;
      if (point->point.id != id) continue;
      const auto idx = static_cast<std::size_t>(point - points.begin());
      if (next[idx] == limit[idx]) return mismatch;
      elements[static_cast<std::size_t>(next[idx]++)] = {ColmapImageId(frame.frame_idx), static_cast<std::uint32_t>(i)};
    }
    return Status::Ok();
  });
  if (!status.ok()) return status;
  if (next != limit) return mismatch;
  return elements;
}

void AppendPoint(colmap::ModelFile* file, const CanonicalPoint& point, std::span<const TrackElement> track) {
  const Eigen::Vector3d& position = point.point.position;
  const colmap::Point3D converted{static_cast<std::uint64_t>(point.point.id.value),
                                  {position.x(), position.y(), position.z()},
                                  point.point.rgb,
                                  point.error_px,
                                  {}};
  colmap::AppendTextPoint(converted, track, colmap::Digits::kRounded, &file->text);
  colmap::AppendBinaryPoint(converted, track, &file->binary);
}

Status WritePoints(FileGroup& group, const std::string& folder, colmap::Format format,
                   std::span<const CanonicalPoint> all_points, std::span<const CanonicalImage> images,
                   const std::string& run_path) {
  auto file = colmap::ModelFile::Create(group, folder, "points3D", format);
  if (!file.ok()) return file.status();
  std::vector<CanonicalPoint> points;
  for (const CanonicalPoint& point : all_points)
    if (point.num_observations > 0) points.push_back(point);
  file->text =
      colmap::PointsHeader(points.size()) +
      "\n# Positions are undeformed: the scene moved, so this model is not consistent with bundle adjustment\n";
  AppendBytes(&file->binary, points.size(), 8);
  std::size_t begin = 0;
  while (begin < points.size()) {
    std::int64_t total = points[begin].num_observations;
    std::size_t end = begin + 1;
    while (end < points.size() && total + points[end].num_observations <= kMostTrackElements)
      total += points[end++].num_observations;
    const std::span<const CanonicalPoint> range(points.data() + begin, end - begin);
    const auto elements = Tracks(range, images, run_path);
    if (!elements.ok()) return elements.status();
    std::size_t first = 0;
    for (const CanonicalPoint& point : range) {
      const auto length = static_cast<std::size_t>(point.num_observations);
      AppendPoint(&*file, point, std::span(*elements).subspan(first, length));
      first += length;
      if (Status status = file->Flush(); !status.ok()) return status;
    }
    begin = end;
  }
  return file->Close();
}

}  // namespace

void CountObservation(const Camera& camera, const Rigid3& cam_from_world, const PointObservation& observation,
                      CanonicalPoint* point) {
  ++point->num_observations;
  if (const auto pixel = camera.Project(cam_from_world * observation.position))
    point->error_px +=
        ((*pixel - observation.pixel).norm() - point->error_px) / static_cast<double>(point->num_observations);
}

Status WriteCanonicalModel(const std::string& folder, colmap::Format format, const Camera& camera,
                           std::span<const CanonicalImage> images, std::span<const CanonicalPoint> points,
                           const std::string& run_path) {
  FileGroup group;
  if (Status status = colmap::WriteCamera(group, folder, format, colmap::FromPliant(camera, 1)); !status.ok())
    return status;
  if (Status status = WriteImages(group, folder, format, images, run_path); !status.ok()) return status;
  if (Status status = WritePoints(group, folder, format, points, images, run_path); !status.ok()) return status;
  return group.Commit();
}

}  // namespace pliant
