// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "viewer/read_run.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "pliant/base/text.h"
#include "pliant/evaluation/run_input.h"
#include "pliant/io/run_map.h"
#include "viewer/run_options.h"

namespace pliant {
namespace {

// Calls `function` with the observations of each tracked frame of `run`, by its position in `frames`.
template <class Function>
Status ForEachTrackedFrame(const std::string& run_path, const std::vector<ViewedFrame>& frames,
                           const Function& function) {
  std::vector<int> frames_idx;
  std::vector<std::size_t> positions;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!frames[i].world_from_cam) continue;
    frames_idx.push_back(frames[i].row.frame_idx);
    positions.push_back(i);
  }
  return ForEachFrame(run_path, frames_idx, [&](std::size_t k, const std::vector<PointObservation>& observations) {
    function(positions[k], observations);
    return Status::Ok();
  });
}

// The observations of every n-th point.
std::int64_t CountOfEvery(std::int64_t n, const std::map<PointId, std::int64_t>& counts) {
  std::int64_t position = 0;
  std::int64_t kept = 0;
  for (const auto& [id, count] : counts)
    if (position++ % n == 0) kept += count;
  return kept;
}

Status AddObservations(const std::string& run_path, std::int64_t max_observations, ReadViewedRun* read) {
  ViewedRun& run = read->run;
  std::map<PointId, std::int64_t> counts;
  std::int64_t total = 0;
  Status status = ForEachTrackedFrame(run_path, run.frames, [&](std::size_t, const auto& observations) {
    for (const PointObservation& o : observations) ++counts[o.id];
    total += static_cast<std::int64_t>(observations.size());
  });
  if (!status.ok()) return status;
  std::int64_t every = 1;
  while (every < static_cast<std::int64_t>(counts.size()) && CountOfEvery(every, counts) > max_observations) ++every;
  if (every > 1) {
    std::int64_t position = 0;
    for (auto entry = counts.begin(); entry != counts.end();)
      entry = position++ % every == 0 ? std::next(entry) : counts.erase(entry);
    read->notes.push_back("of the " + std::to_string(total) + " observations of " + run.name +
                          " those of one point in " + std::to_string(every) + " are shown (--Report.max_observations)");
  }
  return ForEachTrackedFrame(run_path, run.frames, [&](std::size_t i, const auto& observations) {
    for (const PointObservation& o : observations)
      if (counts.contains(o.id)) run.frames[i].observations.push_back(ToViewed(o));
  });
}

void TakeRows(const Run& source, ViewedRun* run) {
  run->stage_names = source.stage_names;
  for (const RunFrame& row : source.frames) run->frames.emplace_back().row = row;
  for (const RunPose& pose : source.poses) {
    const auto frame = std::lower_bound(run->frames.begin(), run->frames.end(), *pose.frame_idx,
                                        [](const ViewedFrame& f, int wanted) { return f.row.frame_idx < wanted; });
    frame->world_from_cam = pose.world_from_cam;
  }
}

// Another system's: only frames with a pose or points are known to have been read.
Status TakeResult(const std::string& run_path, const Sequence& sequence, ReadViewedRun* read) {
  auto input = ReadEvaluationInput(run_path, sequence, {});
  if (!input.ok()) return input.status();
  read->run.has_rows = false;
  for (const EvaluationFrame& source : input->frames) {
    ViewedFrame& frame = read->run.frames.emplace_back();
    frame.row.frame_idx = source.frame_idx;
    frame.row.timestamp_s = source.timestamp_s;
    frame.row.state = source.cam_from_world ? TrackingState::kTracking : TrackingState::kLost;
    frame.row.tracked = static_cast<int>(source.observations.size());
    if (source.cam_from_world) frame.world_from_cam = source.cam_from_world->Inverse();
  }
  read->notes.insert(read->notes.end(), input->notes.begin(), input->notes.end());
  return Status::Ok();
}

// Undeformed positions and colors; where the run has none, the first position in gray.
void AddPoints(const RunMap& map, ViewedRun* run) {
  for (const ViewedFrame& frame : run->frames) {
    for (const ViewedObservation& o : frame.observations) {
      if (run->points.contains(o.id)) continue;
      const auto known = map.points.find(o.id);
      run->points.emplace(o.id, known != map.points.end() ? known->second : NewPoint{o.id, o.position.cast<double>()});
    }
  }
}

// Whether the unit of a run's maps is the millimeter. Where it does not say so itself, its options tell; those of a
// refined run are those of the run that was refined.
Result<bool> IsMetric(const ReadViewedRun& read) {
  if (read.summary && read.summary->description.metric) return *read.summary->description.metric;
  constexpr int kMaxRefinements = 100;  // one after the other; a run that names itself ends
  std::vector<NamedText> options = read.run.options;
  std::string from = read.summary ? read.summary->description.refined_from : std::string();
  for (int i = 0; i < kMaxRefinements && !from.empty(); ++i) {
    auto refined = ReadRunOptions(from);
    if (!refined.ok()) return refined.status();
    options = *std::move(refined);
    const auto summary = ReadRunSummary(from + "/run.json");
    from = summary.ok() ? summary->description.refined_from : std::string();
  }
  return AreMetric(options);
}

}  // namespace

std::string RunName(const std::string& run_path) {
  const std::filesystem::path path = std::filesystem::path(run_path).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

ViewedObservation ToViewed(const PointObservation& observation) {
  ViewedObservation viewed;
  viewed.id = observation.id;
  viewed.pixel = observation.pixel.cast<float>();
  viewed.position = observation.position.cast<float>();
  viewed.ssim = static_cast<float>(observation.ssim);
  if (observation.sigma > 0.0) viewed.sigma = static_cast<float>(observation.sigma);
  return viewed;
}

void AddWhatPoseTells(const Camera* camera, ViewedFrame* frame) {
  if (!frame->world_from_cam) return;
  const Rigid3 cam_from_world = frame->world_from_cam->Inverse();
  for (ViewedObservation& o : frame->observations) {
    const Eigen::Vector3d point_in_cam = cam_from_world * o.position.cast<double>();
    o.depth = static_cast<float>(point_in_cam.z());
    const auto pixel = camera != nullptr ? camera->Project(point_in_cam) : std::nullopt;
    if (pixel) o.reprojection_px = (pixel->cast<float>() - o.pixel).norm();
  }
}

Result<ReadViewedRun> ReadRunForView(const std::string& run_path, const Sequence* sequence,
                                     std::int64_t max_observations) {
  auto source = ReadRun(run_path);
  if (!source.ok()) return source.status();
  ReadViewedRun read;
  read.run.name = RunName(run_path);
  read.summary = source->summary;
  if (source->summary) {
    read.run.status = EnumName(source->summary->status);
    read.run.note = source->summary->note;
  }
  if (source->cut_lines > 0)
    read.notes.push_back("the run " + read.run.name +
                         " was killed, or is still being written; its complete rows are shown");
  if (!source->frames.empty()) {
    TakeRows(*source, &read.run);
  } else if (sequence != nullptr) {
    if (Status status = TakeResult(run_path, *sequence, &read); !status.ok()) return status;
  } else if (!source->poses.empty()) {
    return Status(ErrorCode::kNotFound, Quoted(run_path) +
                                            " has no frames.csv, so it is another system's result; name its sequence "
                                            "with --sequence");
  }
  if (Status status = AddObservations(run_path, max_observations, &read); !status.ok()) return status;
  RunMap map;
  if (HasRunMap(run_path, *source)) {
    auto known = ReadRunMap(run_path, *source);
    if (!known.ok()) return known.status();
    map = *std::move(known);
  } else {
    read.notes.push_back("the run " + read.run.name +
                         " has no sparse/, so that its points' first positions stand for the undeformed ones");
  }
  AddPoints(map, &read.run);
  read.run.camera = map.camera;
  if (!read.run.camera && sequence != nullptr) read.run.camera = sequence->camera();
  for (ViewedFrame& frame : read.run.frames) AddWhatPoseTells(read.run.camera ? &*read.run.camera : nullptr, &frame);
  auto options = ReadRunOptions(run_path);
  if (!options.ok()) return options.status();
  read.run.options = *std::move(options);
  const auto metric = IsMetric(read);
  if (!metric.ok()) return metric.status();
  read.run.in_millimeters = *metric;
  return read;
}

}  // namespace pliant
