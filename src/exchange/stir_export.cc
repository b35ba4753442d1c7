// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Where points of a recording's start are at its end, in the JSON of the STIR challenge (pliant/io/stir_file.h).

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <tuple>
#include <utility>

#include "exchange/exports.h"
#include "pliant/base/files.h"
#include "pliant/base/staged_folder.h"
#include "pliant/base/text.h"
#include "pliant/io/stir_file.h"

namespace pliant {
namespace {

constexpr std::size_t kNeighbors = 8;  // points that carry a pixel with them

using SeenPoints = std::map<PointId, PointObservation>;

// Those nearest to `pixel`, at most kNeighbors, each with its weight, 1 / (1 + d^2 / px^2); the weights add up to one.
std::vector<std::pair<PointId, double>> Neighbors(const Eigen::Vector2d& pixel, const SeenPoints& points) {
  std::vector<std::pair<double, PointId>> near;
  for (const auto& [id, seen] : points) near.emplace_back((seen.pixel - pixel).squaredNorm(), id);
  const std::size_t count = std::min(kNeighbors, near.size());
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
  double sum = 0;
  for (std::size_t k = 0; k < count; ++k) sum += 1 / (1 + near[k].first);
  std::vector<std::pair<PointId, double>> weights;
  for (std::size_t k = 0; k < count; ++k) weights.emplace_back(near[k].second, 1 / (1 + near[k].first) / sum);
  return weights;
}

// A submap's way from its first frame to its last.
struct Way {
  std::vector<Eigen::Vector2d> pixels;  // those of the start, where they are now
  SeenPoints first = {};
  SeenPoints last = {};
  Rigid3 first_cam_from_world = {};
  Rigid3 last_cam_from_world = {};
};

// Moves the pixels as the points around them move from `before` to `now`.
void Carry(const SeenPoints& before, const SeenPoints& now, std::vector<Eigen::Vector2d>* pixels) {
  SeenPoints common;
  for (const auto& [id, seen] : before)
    if (now.contains(id)) common.emplace(id, seen);
  for (Eigen::Vector2d& pixel : *pixels) {
    Eigen::Vector2d motion = Eigen::Vector2d::Zero();
    for (const auto& [id, weight] : Neighbors(pixel, common))
      motion += weight * (now.at(id).pixel - common.at(id).pixel);
    pixel += motion;
  }
}

Result<Way> Follow(const RunSource& source, std::vector<Eigen::Vector2d> start) {
  Way way{.pixels = std::move(start)};
  const Status status = ForEachFrame(source, [&](const SourceFrame& frame, const auto& observations) {
    if (observations.empty()) return Status::Ok();
    SeenPoints now;
    for (const PointObservation& seen : observations) now.emplace(seen.id, seen);
    if (way.first.empty()) {
      way.first = now;
      way.first_cam_from_world = frame.cam_from_world;
    } else {
      Carry(way.last, now, &way.pixels);
    }
    way.last = std::move(now);
    way.last_cam_from_world = frame.cam_from_world;
    return Status::Ok();
  });
  if (!status.ok()) return status;
  if (way.first.empty()) return Status(ErrorCode::kInsufficient, "the run has no points");
  return way;
}

// On the pixels' rays, at the depth of the points around them in the last frame, camera frame.
Result<std::vector<Eigen::Vector3d>> Lifted(const RunSource& source, const Way& way) {
  std::vector<Eigen::Vector3d> points;
  const auto rays = source.camera.Unproject(way.pixels);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!rays[i])
      return Status(ErrorCode::kInsufficient,
                    "a point ends where the camera has no ray; leave it out of --Export.start_points");
    double depth = 0;
    for (const auto& [id, weight] : Neighbors(way.pixels[i], way.last))
      depth += weight * (way.last_cam_from_world * way.last.at(id).position).z();
    points.emplace_back(*rays[i] * (depth / rays[i]->z()));
  }
  return points;
}

Status Write(const std::string& recording, std::vector<Eigen::Vector3d> points, int dimensions,
             const std::string& path) {
  return WriteStirPoints({.dimensions = dimensions, .of_recording = {{recording, std::move(points)}}}, path);
}

std::vector<Eigen::Vector3d> Pixels(std::span<const Eigen::Vector2d> pixels) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector2d& pixel : pixels) points.emplace_back(pixel.x(), pixel.y(), 0);
  return points;
}

// Labels are of the recording's first frame, and are wanted in its last.
Status CheckIsWhole(const RunSource& source) {
  const std::vector<RunFrame>& of_run = source.run->frames;
  const int first = source.frames.front().frame_idx;
  const int last = source.frames.back().frame_idx;
  if (of_run.empty() || (first == of_run.front().frame_idx && last == of_run.back().frame_idx)) return Status::Ok();
  return {ErrorCode::kInsufficient, "labelled points go from the first frame of a run to its last, " +
                                        std::to_string(of_run.front().frame_idx) + " to " +
                                        std::to_string(of_run.back().frame_idx) +
                                        ", in one map and with --Export.stride 1; here a map has the frames " +
                                        std::to_string(first) + " to " + std::to_string(last)};
}

// The labelled points of the start where they are at the end.
Status WriteCarried(const RunSource& source, const ExportOptions& options, const ExportFolder& folder) {
  if (Status status = CheckIsWhole(source); !status.ok()) return status;
  const auto start = ReadStirPoints(options.start_points);
  if (!start.ok()) return start.status();
  if (start->dimensions != 2)
    return {ErrorCode::kInvalidArgument,
            options.start_points + " has points of three numbers; --Export.start_points are pixels"};
  std::string recording = options.recording;
  if (recording.empty() && start->of_recording.size() == 1) recording = start->of_recording.begin()->first;
  const auto found = start->of_recording.find(recording);
  if (found == start->of_recording.end())
    return {ErrorCode::kInvalidArgument, options.start_points + " has no points of the recording " + Quoted(recording) +
                                             "; --Export.recording is the name of one of its " +
                                             std::to_string(start->of_recording.size())};
  std::vector<Eigen::Vector2d> pixels;
  for (const Eigen::Vector3d& point : found->second) pixels.emplace_back(point.head<2>());
  const auto way = Follow(source, std::move(pixels));
  if (!way.ok()) return way.status();
  if (Status status = Write(recording, Pixels(way->pixels), 2, folder.Path("positions.json")); !status.ok())
    return status;
  if (!IsMetric(source)) return Status::Ok();
  auto points = Lifted(source, *way);
  return points.ok() ? Write(recording, *std::move(points), 3, folder.Path("positions3d.json")) : points.status();
}

// The run's own points that its first and its last frame show.
Status WriteOwn(const RunSource& source, const ExportOptions& options, const ExportFolder& folder) {
  const auto way = Follow(source, {});
  if (!way.ok()) return way.status();
  std::string recording = options.recording;
  if (recording.empty())
    recording = source.images.image_path.empty() ? source.run_path : source.images.image_path.string();
  std::array<std::vector<Eigen::Vector2d>, 2> pixels;
  std::array<std::vector<Eigen::Vector3d>, 2> points;
  for (const auto& [id, seen] : way->first) {
    const auto last = way->last.find(id);
    if (last == way->last.end()) continue;
    pixels[0].push_back(seen.pixel);
    pixels[1].push_back(last->second.pixel);
    points[0].push_back(way->first_cam_from_world * seen.position);
    points[1].push_back(way->last_cam_from_world * last->second.position);
  }
  if (pixels[0].empty())
    return {ErrorCode::kInsufficient, "no point of the run is seen in its first and its last frame"};
  const bool metric = IsMetric(source);  // the file in three dimensions is in millimeters
  for (const auto& [k, name, name3d] :
       {std::tuple(0U, "start.json", "start3d.json"), std::tuple(1U, "positions.json", "positions3d.json")}) {
    if (Status status = Write(recording, Pixels(pixels[k]), 2, folder.Path(name)); !status.ok()) return status;
    if (!metric) continue;
    if (Status status = Write(recording, points[k], 3, folder.Path(name3d)); !status.ok()) return status;
  }
  return Status::Ok();
}

}  // namespace

Status ExportStir(const RunSource& source, const ExportOptions& options, const ExportFolder& folder) {
  if (Status status = CheckAbsent(folder.place, {"start.json", "start3d.json", "positions.json", "positions3d.json"});
      !status.ok())
    return status;
  return options.start_points.empty() ? WriteOwn(source, options, folder) : WriteCarried(source, options, folder);
}

}  // namespace pliant
