// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>

#include <nlohmann/json.hpp>

#include "colmap/model_file.h"
#include "colmap/rows.h"
#include "exchange/exports.h"
#include "pliant/base/files.h"
#include "pliant/base/staged_folder.h"
#include "pliant/base/text.h"
#include "pliant/colmap/convert.h"

namespace pliant {
namespace {

constexpr std::int64_t kPointsAFrame = 1'000'000;  // ids of a spacetime model: frame * this + track

std::uint64_t SpacetimeId(const SourceFrame& frame, PointId point) {
  return static_cast<std::uint64_t>(frame.frame_idx * kPointsAFrame + point.value);
}

// `points` are sorted by id.
Status CheckSpacetimeIds(const std::vector<CanonicalPoint>& points) {
  if (points.empty() || points.back().point.id.value < kPointsAFrame) return Status::Ok();
  return {ErrorCode::kInvalidArgument, "the run has a point " + std::to_string(points.back().point.id.value) +
                                           "; in this format, whose point ids are frame * " +
                                           std::to_string(kPointsAFrame) +
                                           " + point, they have to be smaller: use the format canonical or frames"};
}

// A model whose images and points3D are written as a stream.
class ModelStream {
 public:
  static Result<ModelStream> Create(FileGroup& group, const std::string& folder, colmap::Format format,
                                    const Camera& camera, std::uint64_t num_images, std::uint64_t num_points) {
    if (Status status = colmap::WriteCamera(group, folder, format, colmap::FromPliant(camera, 1)); !status.ok())
      return status;
    auto images = colmap::ModelFile::Create(group, folder, "images", format);
    if (!images.ok()) return images.status();
    auto points = colmap::ModelFile::Create(group, folder, "points3D", format);
    if (!points.ok()) return points.status();
    images->Begin(colmap::ImagesHeader(num_images), num_images);
    points->Begin(colmap::PointsHeader(num_points), num_points);
    return ModelStream{std::move(*images), std::move(*points)};
  }

  Status Close() {
    for (colmap::ModelFile* file : {&images, &points})
      if (Status status = file->Close(); !status.ok()) return status;
    return Status::Ok();
  }

  colmap::ModelFile images;
  colmap::ModelFile points;
};

// A frame's image and points, each point as it was then and seen in this image alone; ids by `id_of`.
template <class IdOf>
Status AddFrame(const RunSource& source, const SourceFrame& frame, const std::vector<PointObservation>& observations,
                const IdOf& id_of, const std::optional<std::array<std::uint8_t, 3>>& color, ModelStream* model) {
  colmap::Image image{ColmapImageId(frame.frame_idx), colmap::FromPliant(frame.cam_from_world), 1, frame.name, {}};
  for (const PointObservation& o : observations) {
    const auto idx = static_cast<std::uint32_t>(image.points2D.size());
    image.points2D.push_back(colmap::FromPliant(o.pixel, id_of(o.id)));
    const colmap::Point3D point{id_of(o.id),
                                {o.position.x(), o.position.y(), o.position.z()},
                                color ? *color : FindPoint(source.points, o.id)->point.rgb,
                                ReprojectionErrorPx(source.camera, frame.cam_from_world, o).value_or(0.0),
                                {{image.id, idx}}};
    if (Status status = model->points.Add(point, point.track); !status.ok()) return status;
  }
  return model->images.Add(image);
}

// Calls `also` for every frame.
Status WriteSpacetime(const RunSource& source, colmap::Format format, const std::string& folder, FileGroup& group,
                      const FrameFunction& also) {
  if (Status status = CheckSpacetimeIds(source.points); !status.ok()) return status;
  auto model = ModelStream::Create(group, folder, format, source.camera, source.frames.size(),
                                   static_cast<std::uint64_t>(source.num_observations));
  if (!model.ok()) return model.status();
  const Status status = ForEachFrame(source, [&](const SourceFrame& frame, const auto& observations) {
    const auto id_of = [&](PointId id) { return SpacetimeId(frame, id); };
    Status added = AddFrame(source, frame, observations, id_of, TimeColor(source, frame), &*model);
    return added.ok() ? also(frame, observations) : added;
  });
  return status.ok() ? model->Close() : status;
}

std::int64_t Nanoseconds(double seconds) { return std::llround(seconds * 1e9); }

}  // namespace

Status ExportColmapCanonical(const RunSource& source, const ExportOptions& options, const ExportFolder& folder) {
  if (Status status = colmap::CheckFolder(folder.place, options.files); !status.ok()) return status;
  std::vector<CanonicalImage> images;
  for (const SourceFrame& frame : source.frames) images.push_back({frame.frame_idx, frame.name, frame.cam_from_world});
  return WriteCanonicalModel(folder.path, options.files, source.camera, images, source.points, source.run_path);
}

Status ExportColmapSpacetime(const RunSource& source, const ExportOptions& options, const ExportFolder& folder) {
  if (Status status = colmap::CheckFolder(folder.place, options.files); !status.ok()) return status;
  FileGroup group;
  const auto nothing_else = [](const SourceFrame&, const auto&) { return Status::Ok(); };
  if (Status status = WriteSpacetime(source, options.files, folder.path, group, nothing_else); !status.ok())
    return status;
  return group.Commit();
}

Status ExportColmapFrames(const RunSource& source, const ExportOptions& options, const ExportFolder& folder) {
  std::vector<std::string> names;
  for (const SourceFrame& frame : source.frames) names.push_back(NumberOf(frame));
  if (Status status = CheckAbsent(folder.place, names); !status.ok()) return status;
  return ForEachFrame(source, [&](const SourceFrame& frame, const auto& observations) {
    if (Status status = folder.AddFolder(NumberOf(frame)); !status.ok()) return status;
    FileGroup group;
    auto model =
        ModelStream::Create(group, folder.Path(NumberOf(frame)), options.files, source.camera, 1, observations.size());
    if (!model.ok()) return model.status();
    const auto id_of = [](PointId id) { return static_cast<std::uint64_t>(id.value); };
    if (Status status = AddFrame(source, frame, observations, id_of, std::nullopt, &*model); !status.ok())
      return status;
    if (Status status = model->Close(); !status.ok()) return status;
    return group.Commit();
  });
}

Status ExportColmap4d(const RunSource& source, const ExportOptions& options, const ExportFolder& folder) {
  if (Status status = colmap::CheckFolder(folder.place, options.files); !status.ok()) return status;
  FileGroup group;
  auto times = group.Create(folder.Path("times.bin"));
  if (!times.ok()) return times.status();
  auto points = group.Create(folder.Path("points_t.bin"));
  if (!points.ok()) return points.status();
  std::string image_rows;
  std::string point_rows;
  AppendBytes(&image_rows, source.frames.size(), 8);
  AppendBytes(&point_rows, static_cast<std::uint64_t>(source.num_observations), 8);
  const auto add_times = [&](const SourceFrame& frame, const std::vector<PointObservation>& observations) {
    const auto time = static_cast<std::uint64_t>(Nanoseconds(frame.timestamp_s));
    AppendBytes(&image_rows, ColmapImageId(frame.frame_idx), 4);
    AppendBytes(&image_rows, time, 8);
    for (const PointObservation& o : observations) {
      AppendBytes(&point_rows, SpacetimeId(frame, o.id), 8);
      AppendBytes(&point_rows, time, 8);
    }
    return points->AppendWhenLarge(&point_rows);
  };
  if (Status status = WriteSpacetime(source, options.files, folder.path, group, add_times); !status.ok()) return status;
  for (const auto& [file, rows] : {std::pair(&*times, &image_rows), std::pair(&*points, &point_rows)}) {
    if (Status written = file->Append(*rows); !written.ok()) return written;
    if (Status closed = file->Close(); !closed.ok()) return closed;
  }
  auto meta = group.Create(folder.Path("time_meta.json"));
  if (!meta.ok()) return meta.status();
  const nlohmann::ordered_json content = {{"version", "1.0"},
                                          {"time_convention", "mid_exposure"},
                                          {"clock_domain", "sequence"},
                                          {"unit", "ns"},
                                          {"point_ids", "frame * 1000000 + track"}};
  if (Status written = meta->Append(content.dump(2) + "\n"); !written.ok()) return written;
  if (Status closed = meta->Close(); !closed.ok()) return closed;
  return group.Commit();
}

}  // namespace pliant
