// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/pipeline/join_runs.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <system_error>
#include <utility>

#include "pipeline/run_frames.h"
#include "pipeline/run_joint.h"
#include "pliant/base/text.h"
#include "pliant/base/version.h"
#include "pliant/camera/same_camera.h"
#include "pliant/datasets/run_sequence.h"
#include "pliant/io/run_map.h"
#include "pliant/io/run_reader.h"
#include "pliant/io/run_writer.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// A submap of a part: the part's index, the submap's number there.
using SubmapKey = std::pair<std::size_t, int>;

struct Part {
  std::string path;
  Run run;
  RunMap known;
  std::map<int, const RunPose*> poses;     // by frame
  std::map<int, const RunFrame*> frames;   // likewise
  std::map<PointId, PointId> same_points;  // ids in the part before of points that this one has, too

  const RunDescription& description() const { return run.summary->description; }
  int first_frame() const { return frames.begin()->first; }
  int last_frame() const { return frames.rbegin()->first; }
};

// Where a submap went: its own world, or an earlier one's.
struct Placed {
  SubmapKey root;
  Sim3 root_from_submap;
};

Status CheckRunPaths(const JoinRequest& request) {
  if (request.run_paths.size() < 2) return {ErrorCode::kInvalidArgument, "two or more runs are joined; give more"};
  for (std::size_t i = 0; i < request.run_paths.size(); ++i) {
    std::error_code error;
    if (fs::equivalent(request.run_paths[i], request.output_path, error))
      return {ErrorCode::kInvalidArgument, "the joined run would overwrite the run " + Quoted(request.run_paths[i]) +
                                               "; give another --output_path"};
    for (std::size_t j = 0; j < i; ++j)
      if (fs::equivalent(request.run_paths[i], request.run_paths[j], error))
        return {ErrorCode::kInvalidArgument, "the run " + Quoted(request.run_paths[i]) + " was given twice"};
  }
  return Status::Ok();
}

Result<Part> ReadPart(const std::string& path, const JoinRequest& request) {
  Part part;
  part.path = path;
  auto run = ReadRun(path);
  if (!run.ok()) return run.status();
  part.run = *std::move(run);
  if (const auto frames_idx = FramesWithPose(path, part.run); !frames_idx.ok()) return frames_idx.status();
  if (!part.run.summary || part.run.frames.empty())
    return Status(ErrorCode::kInsufficient, "the run " + Quoted(path) + " has no frames; there is nothing to join");
  auto known = KnownMapOfRun(path, SequenceOfRun(path, request.sequence_path, request.camera_path), part.run);
  if (!known.ok()) return known.status();
  part.known = *std::move(known);
  for (const RunFrame& frame : part.run.frames) part.frames.emplace(frame.frame_idx, &frame);
  for (const RunPose& pose : part.run.poses) part.poses.emplace(*pose.frame_idx, &pose);
  return part;
}

// That the parts are of one recording.
Status CheckSame(const Part& first, const Part& other) {
  const auto differs = [&](const std::string& what) {
    return Status(ErrorCode::kMismatch, "the runs " + Quoted(first.path) + " and " + Quoted(other.path) + " are of " +
                                            what + "; join parts of one recording");
  };
  if (first.description().input != other.description().input) return differs("different images");
  if (first.description().range.stride != other.description().range.stride) return differs("different frames");
  if (first.description().metric != other.description().metric) return differs("different units");
  if (!IsSameCamera(*first.known.camera, *other.known.camera)) return differs("different calibrations");
  return Status::Ok();
}

Result<std::vector<Part>> ReadParts(const JoinRequest& request, const JobProgress& progress) {
  std::vector<Part> parts;
  for (const std::string& path : request.run_paths) {
    auto part = ReadPart(path, request);
    if (!part.ok()) return part.status();
    parts.push_back(*std::move(part));
    const int read = static_cast<int>(parts.size());
    if (Status status = Tell(progress, "read", read, static_cast<int>(request.run_paths.size())); !status.ok())
      return status;
    if (Status status = CheckSame(parts.front(), parts.back()); !status.ok()) return status;
  }
  std::ranges::sort(parts, {}, [](const Part& part) { return std::pair(part.first_frame(), part.last_frame()); });
  if (std::ranges::all_of(parts, [](const Part& part) { return part.poses.empty(); }))
    return Status(ErrorCode::kInsufficient, "no frame of the runs was tracked; there is nothing to join");
  return parts;
}

std::vector<int> SharedFrames(const Part& before, const Part& after) {
  std::vector<int> frames_idx;
  for (const auto& [frame_idx, pose] : after.poses)
    if (before.poses.contains(frame_idx)) frames_idx.push_back(frame_idx);
  return frames_idx;
}

Result<std::vector<JointView>> ReadViews(const Part& part, const std::vector<int>& frames_idx) {
  std::vector<JointView> views;
  const Status status = ForEachFrame(part.path, frames_idx, [&](std::size_t k, const auto& observations) {
    views.push_back({part.poses.at(frames_idx[k])->world_from_cam.Inverse(), observations});
    std::ranges::sort(views.back().observations, {}, &PointObservation::id);
    return Status::Ok();
  });
  if (!status.ok()) return status;
  return views;
}

// Joins the submaps of consecutive parts.
class Joiner {
 public:
  Joiner(std::vector<Part>* parts, const JoinOptions& options) : parts_(*parts), options_(options) {
    for (std::size_t i = 0; i < parts_.size(); ++i)
      for (const auto& [frame_idx, pose] : parts_[i].poses) placed_.try_emplace({i, pose->submap}, OwnWorld(i, *pose));
  }

  // The part `after` to the one before it. A submap goes where most of its frames are shared.
  Status Join(std::size_t after) {
    Part& later = parts_[after];
    const Part& earlier = parts_[after - 1];
    const std::vector<int> frames_idx = SharedFrames(earlier, later);
    auto before_views = ReadViews(earlier, frames_idx);
    if (!before_views.ok()) return before_views.status();
    auto after_views = ReadViews(later, frames_idx);
    if (!after_views.ok()) return after_views.status();
    std::map<int, std::map<int, std::vector<SharedFrame>>> shared;  // by the submap of the later and of the earlier one
    for (std::size_t k = 0; k < frames_idx.size(); ++k)
      shared[later.poses.at(frames_idx[k])->submap][earlier.poses.at(frames_idx[k])->submap].push_back(
          {std::move((*before_views)[k]), std::move((*after_views)[k])});
    if (shared.empty()) joints_.push_back(Failed(after, 0, "no frame has a pose in both"));
    for (const auto& [submap, by_earlier] : shared) {
      const auto most = std::ranges::max_element(by_earlier, {}, [](const auto& of) { return of.second.size(); });
      JoinSubmaps({after, submap}, {after - 1, most->first}, most->second);
    }
    return Status::Ok();
  }

  const Placed& PlaceOf(const SubmapKey& key) const { return placed_.at(key); }
  std::vector<RunJoint> TakeJoints() { return std::move(joints_); }

 private:
  static Placed OwnWorld(std::size_t part, const RunPose& pose) { return {{part, pose.submap}, {}}; }

  RunJoint Failed(std::size_t after, std::size_t frames, const std::string& why) const {
    return {.run = parts_[after].path,
            .before = parts_[after - 1].path,
            .frames = static_cast<int>(frames),
            .failure = why};
  }

  void JoinSubmaps(const SubmapKey& after, const SubmapKey& before, const std::vector<SharedFrame>& frames) {
    Part& later = parts_[after.first];
    const JointScale scale = later.description().metric.value_or(false) ? JointScale::kOne : JointScale::kEstimated;
    const auto joint = JoinWorlds(frames, later.known.camera->width(), scale, options_);
    if (!joint.ok()) {
      joints_.push_back(Failed(after.first, frames.size(), joint.status().message()));
      return;
    }
    const Placed& of_before = placed_.at(before);
    placed_.at(after) = {of_before.root, of_before.root_from_submap * joint->before_from_after};
    later.same_points.insert(joint->same_points.begin(), joint->same_points.end());
    joints_.push_back({later.path, parts_[before.first].path, static_cast<int>(frames.size()), joint->points,
                       joint->before_from_after.scale, joint->depth_difference, joint->depth_spread,
                       static_cast<int>(joint->same_points.size()), ""});
  }

  std::vector<Part>& parts_;
  const JoinOptions& options_;
  std::map<SubmapKey, Placed> placed_;
  std::vector<RunJoint> joints_;
};

// The part that each frame is taken from.
std::map<int, std::size_t> PartOfFrames(const std::vector<Part>& parts) {
  std::map<int, std::size_t> part_of;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const int middle = i == 0 ? parts[i].first_frame() : (parts[i].first_frame() + parts[i - 1].last_frame() + 1) / 2;
    for (const auto& [frame_idx, frame] : parts[i].frames) {
      const auto [entry, is_new] = part_of.try_emplace(frame_idx, i);
      if (is_new) continue;
      const bool has_pose = HasPose(frame->state);
      const bool other_has = HasPose(parts[entry->second].frames.at(frame_idx)->state);
      if (has_pose == other_has ? frame_idx >= middle : has_pose) entry->second = i;
    }
  }
  return part_of;
}

// The parts' frames as reports of the joined run.
class JoinedReports {
 public:
  JoinedReports(const std::vector<Part>& parts, const Joiner& joiner) : parts_(parts), joiner_(joiner) {}

  FrameReport Report(std::size_t part_idx, int frame_idx, std::vector<PointObservation> observations) {
    const Part& part = parts_[part_idx];
    const RunFrame& frame = *part.frames.at(frame_idx);
    FrameReport report;
    report.frame_idx = frame_idx;
    report.timestamp_s = frame.timestamp_s;
    report.state = frame.state;
    report.tracked = frame.tracked;
    report.lost = frame.lost;
    if (const auto name = part.known.names.find(frame_idx); name != part.known.names.end()) report.name = name->second;
    report.submap = submap_;
    if (!HasPose(frame.state)) return report;
    const RunPose& pose = *part.poses.at(frame_idx);
    const Placed& placed = joiner_.PlaceOf({part_idx, pose.submap});
    report.submap = submap_ = numbers_.try_emplace(placed.root, static_cast<int>(numbers_.size())).first->second;
    report.cam_from_world = PoseInWorld(placed.root_from_submap, pose.world_from_cam.Inverse());
    Take(part_idx, placed.root_from_submap, std::move(observations), &report);
    report.optimized = static_cast<int>(report.observations.size());
    report.added = static_cast<int>(report.new_points.size());
    report.median_reprojection_error_px =
        MedianReprojectionErrorPx(*part.known.camera, *report.cam_from_world, report.observations);
    for (const FirstMapFrames& map : part.run.summary->first_maps)
      if (map.declared_frame_idx == frame_idx) report.first_map = map;
    return report;
  }

 private:
  // In the joined run, whose ids grow in the order of the points' first frames.
  std::pair<PointId, bool> JoinedId(std::size_t part_idx, PointId id) {
    const std::map<PointId, PointId>* same = &parts_[part_idx].same_points;
    for (auto before = same->find(id); before != same->end(); before = same->find(id)) {
      id = before->second;
      same = &parts_[--part_idx].same_points;
    }
    const auto [entry, is_new] = ids_.try_emplace({part_idx, id}, PointId{std::ssize(ids_)});
    return {entry->second, is_new};
  }

  void Take(std::size_t part_idx, const Sim3& root_from_submap, std::vector<PointObservation> observations,
            FrameReport* report) {
    const std::map<PointId, NewPoint>& points = parts_[part_idx].known.points;
    for (PointObservation& seen : observations) {
      const auto known = points.find(seen.id);
      NewPoint point = known != points.end() ? known->second : NewPoint{seen.id, seen.position};
      const auto [id, is_new] = JoinedId(part_idx, seen.id);
      point.id = seen.id = id;
      point.position = root_from_submap * point.position;
      seen.position = root_from_submap * seen.position;
      seen.sigma *= root_from_submap.scale;
      if (is_new) report->new_points.push_back(point);
    }
    std::ranges::sort(observations, {}, &PointObservation::id);
    std::ranges::sort(report->new_points, {}, &NewPoint::id);
    report->observations = std::move(observations);
  }

  const std::vector<Part>& parts_;
  const Joiner& joiner_;
  std::map<SubmapKey, int> numbers_;                        // in the joined run, by root
  int submap_ = 0;                                          // of the last frame
  std::map<std::pair<std::size_t, PointId>, PointId> ids_;  // by part and the id there
};

// A part's observations, frame by frame in growing order.
class PartObservations {
 public:
  static Result<PartObservations> Open(const Part& part) {
    auto reader = ObservationReader::Open(part.path);
    if (!reader.ok()) return reader.status();
    return PartObservations(*std::move(reader));
  }

  // Those of a frame, none where the file has none.
  Result<std::vector<PointObservation>> Of(int frame_idx) {
    while (!ended_ && (!next_ || next_->frame_idx < frame_idx)) {
      auto read = reader_.Next();
      if (!read.ok()) return read.status();
      next_ = *std::move(read);
      ended_ = !next_.has_value();
    }
    if (!next_ || next_->frame_idx != frame_idx) return std::vector<PointObservation>();
    return std::move(next_->observations);
  }

 private:
  explicit PartObservations(ObservationReader reader) : reader_(std::move(reader)) {}

  ObservationReader reader_;
  std::optional<FrameObservations> next_;
  bool ended_ = false;
};

RunDescription JoinedDescription(const JoinRequest& request, const std::vector<Part>& parts) {
  RunDescription description = parts.front().description();
  description.program_version = kVersion;
  description.command_line = request.command_line;
  description.refined_from.clear();
  description.joined_from.clear();
  for (const Part& part : parts) description.joined_from.push_back(fs::absolute(part.path).lexically_normal().string());
  description.range.end = parts.back().description().range.end;
  return description;
}

Result<RunSummary> WriteJoined(const JoinRequest& request, const JoinOptions& options, const std::vector<Part>& parts,
                               const Joiner& joiner) {
  OptionTable table;
  JoinOptions listed = options;
  listed.List(table);
  RunWriterOptions writer_options;
  writer_options.total_s = 0.0;
  for (const Part& part : parts) *writer_options.total_s += part.run.summary->total_s;
  auto writer = RunWriter::Create(request.output_path, *parts.front().known.camera, JoinedDescription(request, parts),
                                  table.ToYaml(), {}, writer_options);
  if (!writer.ok()) return writer.status();
  std::vector<PartObservations> observations;
  for (const Part& part : parts) {
    auto opened = PartObservations::Open(part);
    if (!opened.ok()) return opened.status();
    observations.push_back(*std::move(opened));
  }
  JoinedReports reports(parts, joiner);
  for (const auto& [frame_idx, part] : PartOfFrames(parts)) {
    auto seen = observations[part].Of(frame_idx);
    if (!seen.ok()) return seen.status();
    if (Status status = writer->Write(reports.Report(part, frame_idx, *std::move(seen))); !status.ok()) return status;
  }
  const RunSummary& last = *parts.back().run.summary;
  if (Status status = writer->Finish(last.status, last.note); !status.ok()) return status;
  return writer->summary();
}

}  // namespace

void JoinOptions::List(OptionTable& table) {
  table.BeginGroup("Join", "how runs of parts of a recording are joined");
  table.Add("max_distance", &max_distance, "of the image's width", "between two points whose depths are compared", 1e-4,
            1);
  table.Add("min_points", &min_points, "points", "compared in the common frames of two parts", 1, 1000000);
  table.Add("max_depth_difference", &max_depth_difference, "-",
            "median difference of these depths, as a share of them; above it nothing is joined", 0, 10);
  table.Add("max_same_distance", &max_same_distance, "of the image's width",
            "between two points that are one, in most frames in which both are seen", 1e-5, 1);
}

Result<JoinSummary> JoinRuns(const JoinRequest& request, const JoinOptions& options, const JobProgress& progress) {
  if (Status status = CheckRunPaths(request); !status.ok()) return status;
  auto parts = ReadParts(request, progress);
  if (!parts.ok()) return parts.status();
  Joiner joiner(&*parts, options);
  const auto joints = static_cast<int>(parts->size()) - 1;
  for (int i = 1; i <= joints; ++i) {
    if (Status status = joiner.Join(static_cast<std::size_t>(i)); !status.ok()) return status;
    if (Status status = Tell(progress, "join", i, joints); !status.ok()) return status;
  }
  auto written = WriteJoined(request, options, *parts, joiner);
  if (!written.ok()) return written.status();
  return JoinSummary{joiner.TakeJoints(), *std::move(written)};
}

}  // namespace pliant
