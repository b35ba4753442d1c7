// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/run_writer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <set>

#include "io/former_run.h"
#include "io/run_format.h"
#include "io/run_rows.h"
#include "pliant/base/files.h"
#include "pliant/base/folder_lock.h"
#include "pliant/base/statistics.h"
#include "pliant/base/text.h"
#include "pliant/camera/assumed_camera.h"
#include "pliant/io/checkpoint.h"
#include "pliant/io/ply.h"
#include "pliant/io/trajectory.h"
#include "pliant/scene/serialize.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// Makes the folder, and takes it: two runs in one folder would each remove the other's files.
Result<FolderLock> TakeFolder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) return UnwritableFolder(path, error);
  return FolderLock::Take(path);
}

// Counts are in the order of the first of each.
template <class Key>
void AddTo(const Key& key, std::int64_t count, std::vector<std::pair<Key, std::int64_t>>* counts) {
  const auto found = std::ranges::find_if(*counts, [&](const auto& entry) { return entry.first == key; });
  if (found == counts->end())
    counts->emplace_back(key, count);
  else
    found->second += count;
}

void CountPrior(const FramePrior& prior, PriorCounts* counts) {
  if (prior.is_used) ++counts->reestimated_maps;
  if (!prior.agreement) return;
  ++counts->compared;
  if (prior.agreement == PriorAgreement::kAgrees) ++counts->agree;
  if (prior.agreement == PriorAgreement::kFalls) ++counts->fall;
  if (prior.by_brightness) ++counts->by_brightness;
}

bool IsFinite(const PointObservation& o) {
  return o.pixel.allFinite() && o.position.allFinite() && std::isfinite(o.ssim) && std::isfinite(o.sigma);
}

std::optional<Latency> LatencyOf(const std::vector<double>& ms) {
  if (ms.empty()) return std::nullopt;
  return Latency{Quantile(ms, 0.5), Quantile(ms, 0.99), *std::ranges::max_element(ms)};
}

void AppendPoseCovariance(int frame_idx, const PoseCovariance& covariance, std::string* out) {
  AppendInt(out, frame_idx);
  for (Eigen::Index row = 0; row < 6; ++row)
    for (Eigen::Index column = row; column < 6; ++column) {
      out->push_back(',');
      AppendExact(out, covariance(row, column));
    }
  out->push_back('\n');
}

}  // namespace

struct RunWriter::State {
  std::string path;
  FolderLock lock;
  FormerRun former;
  Camera camera;
  RunColumns columns;
  RunWriterOptions options;
  OutputFile trajectory;
  OutputFile frames;
  OutputFile observations;
  RunSummary summary = {};
  std::vector<double> median_errors_px = {};  // a frame with a pose
  std::vector<double> coverages = {};         // a frame that has one
  std::vector<double> followed_coverages = {};
  std::vector<double> latencies_ms = {};  // a frame whose latency was measured
  // What the sparse model needs beside observations.csv: one entry a tracked frame and one a point.
  std::vector<CanonicalImage> images = {};
  std::vector<CanonicalPoint> points = {};
  std::vector<RunFrameWorld> worlds = {};  // one entry a frame
  std::vector<double> stage_total_ms = {};
  int last_frame_idx = -1;
  std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();
  double elapsed_before_s = 0;  // before the run was resumed
  std::string rows = {};
  std::string pose_covariances = {};  // rows
  Status failure = {};                // the first row that could not be written

  Status Check(const FrameReport& report);
  Status AddPoints(const FrameReport& report);
  void Merge(const SubmapMerge& merge);
  void NumberSubmaps();
  void Count(const FrameReport& report);
  void AppendFrameRow(const FrameReport& report);
  Status WriteRows(const FrameReport& report);
  Status WriteSubmap(int submap) const;
  Status FinishSparse() const;
  // What is counted on the way, without the files.
  void SerializeCounts(StateArchive& archive);
  double ElapsedS() const {
    return elapsed_before_s + std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
};

RunWriter::RunWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
RunWriter::RunWriter(RunWriter&&) noexcept = default;
RunWriter& RunWriter::operator=(RunWriter&&) noexcept = default;
RunWriter::~RunWriter() = default;

const RunSummary& RunWriter::summary() const { return state_->summary; }

void RunWriter::SetWarnings(std::vector<std::string> warnings) {
  state_->summary.description.warnings = std::move(warnings);
}

void RunWriter::SetStream(const StreamCounts& stream) { state_->summary.stream = stream; }

namespace {

// run.json as a killed run leaves it, and config.yaml.
Result<RunSummary> WriteBeginning(const std::string& output_path, RunDescription description,
                                  const std::string& config_yaml) {
  RunSummary summary;
  summary.description = std::move(description);
  RunDescription& paths = summary.description;
  for (std::string* path : {&paths.input, &paths.camera, &paths.mask, &paths.tracks, &paths.depth_prior})
    if (!path->empty() && !IsAssumedCamera(*path)) *path = std::filesystem::absolute(*path).lexically_normal().string();
  summary.note = "the run was stopped before its end";
  if (Status status = WriteRunSummary(output_path + "/run.json", summary); !status.ok()) return status;
  if (Status status = WriteFileAtomically(output_path + "/config.yaml", config_yaml); !status.ok()) return status;
  return summary;
}

std::string HeaderOfFrames(const RunColumns& columns) {
  std::string header(kFrameColumnsBeforeCosts);
  for (const std::string& cost : columns.costs) header.append(",").append(kCostPrefix).append(cost);
  header.append(",").append(kFrameColumnsAfterCosts);
  for (const std::string& stage : columns.stages) header.append(",").append(kStagePrefix).append(stage);
  return header.append(",").append(kLatencyColumn).append("\n");
}

}  // namespace

Result<RunWriter> RunWriter::Create(const std::string& output_path, const Camera& camera, RunDescription description,
                                    const std::string& config_yaml, RunColumns columns,
                                    const RunWriterOptions& options) {
  auto lock = TakeFolder(output_path);
  if (!lock.ok()) return lock.status();
  // Asked under the lock: another process may have come to its end since it was asked before.
  if (!options.replaces_run && HoldsRun(output_path))
    return Status(ErrorCode::kMismatch, "another process has made a run in " + Quoted(output_path) +
                                            " meanwhile; give another --output_path, or --overwrite to replace it");
  auto former = FormerRun::SetAside(output_path);
  if (!former.ok()) return former.status();
  auto summary = WriteBeginning(output_path, std::move(description), config_yaml);
  if (!summary.ok()) return summary.status();
  auto trajectory = OutputFile::Create(output_path + "/trajectory.txt");
  if (!trajectory.ok()) return trajectory.status();
  auto frames = OutputFile::Create(output_path + "/frames.csv");
  if (!frames.ok()) return frames.status();
  auto observations = OutputFile::Create(output_path + "/observations.csv");
  if (!observations.ok()) return observations.status();
  if (Status status = frames->Append(HeaderOfFrames(columns)); !status.ok()) return status;
  if (Status status = observations->Append(std::string(kObservationColumns) + "\n"); !status.ok()) return status;

  auto state = std::make_unique<State>(State{output_path, *std::move(lock), *std::move(former), camera,
                                             std::move(columns), options, std::move(trajectory).value(),
                                             std::move(frames).value(), std::move(observations).value()});
  state->summary = *std::move(summary);
  state->stage_total_ms.assign(state->columns.stages.size(), 0.0);
  return RunWriter(std::move(state));
}

Result<RunWriter> RunWriter::Resume(const std::string& output_path, const Camera& camera, RunDescription description,
                                    const std::string& config_yaml, RunColumns columns, const RunWriterOptions& options,
                                    StateArchive& archive) {
  auto lock = TakeFolder(output_path);
  if (!lock.ok()) return lock.status();
  if (!HasCheckpoint(output_path))
    return Status(ErrorCode::kMismatch, "another process has ended the run in " + output_path +
                                            " meanwhile: there is nothing left to resume");
  std::array<std::int64_t, 3> sizes = {};
  archive(sizes);
  if (!archive.ok()) return Status(ErrorCode::kUnreadable, "the checkpoint of " + output_path + " is damaged");
  if (Status status = TakeKeptRows(output_path); !status.ok()) return status;
  auto trajectory = OutputFile::Continue(output_path + "/trajectory.txt", sizes[0]);
  if (!trajectory.ok()) return trajectory.status();
  auto frames = OutputFile::Continue(output_path + "/frames.csv", sizes[1]);
  if (!frames.ok()) return frames.status();
  auto observations = OutputFile::Continue(output_path + "/observations.csv", sizes[2]);
  if (!observations.ok()) return observations.status();
  if (Status status = DeleteResults(output_path); !status.ok()) return status;
  auto summary = WriteBeginning(output_path, std::move(description), config_yaml);
  if (!summary.ok()) return summary.status();

  auto state = std::make_unique<State>(State{output_path, *std::move(lock), FormerRun::OfResumed(output_path), camera,
                                             std::move(columns), options, std::move(trajectory).value(),
                                             std::move(frames).value(), std::move(observations).value()});
  state->summary = *std::move(summary);
  state->SerializeCounts(archive);
  if (state->summary.frames_tracked > 0) state->former.Forget();
  if (state->stage_total_ms.size() != state->columns.stages.size()) archive.Fail();
  if (!archive.ok()) return Status(ErrorCode::kUnreadable, "the checkpoint of " + output_path + " is damaged");
  return RunWriter(std::move(state));
}

Status RunWriter::Serialize(StateArchive& archive) {
  State& s = *state_;
  if (!s.failure.ok()) return s.failure;
  for (OutputFile* file : {&s.trajectory, &s.frames, &s.observations})
    if (Status status = file->Sync(); !status.ok()) return status;
  std::array<std::int64_t, 3> sizes = {s.trajectory.size(), s.frames.size(), s.observations.size()};
  archive(sizes);
  s.SerializeCounts(archive);
  return Status::Ok();
}

void RunWriter::State::SerializeCounts(StateArchive& archive) {
  double elapsed_s = ElapsedS();
  archive(elapsed_s, summary.first_maps, summary.frames_read, summary.frames_tracked, summary.states, summary.submaps,
          summary.points, summary.observations, summary.losses);
  archive.Members<5>(summary.prior);
  archive(median_errors_px, coverages, followed_coverages, latencies_ms, images, points, worlds, stage_total_ms,
          last_frame_idx, pose_covariances);
  if (archive.reads()) elapsed_before_s = elapsed_s;
}

Status RunWriter::State::Check(const FrameReport& report) {
  const std::string where = "frame " + std::to_string(report.frame_idx) + ": ";
  const auto invalid = [&](const std::string& what) { return Status(ErrorCode::kInvalidArgument, where + what); };
  if (report.frame_idx <= last_frame_idx) return invalid("frames must come in growing order");
  bool finite = std::isfinite(report.timestamp_s) && std::isfinite(report.median_reprojection_error_px) &&
                std::isfinite(report.latency_ms);
  for (const CostTerm& cost : report.costs) {
    finite = finite && std::isfinite(cost.value);
    if (std::ranges::find(columns.costs, cost.name) == columns.costs.end())
      return invalid("there is no column for the cost term " + Quoted(cost.name));
  }
  if (report.cam_from_world)
    finite = finite && report.cam_from_world->rotation.coeffs().allFinite() &&
             report.cam_from_world->translation.allFinite();
  if (report.pose_covariance) finite = finite && report.pose_covariance->allFinite();
  if (report.merge) {
    const Sim3& move = report.merge->into_from_submap;
    finite = finite && std::isfinite(move.scale) && move.rotation.coeffs().allFinite() && move.translation.allFinite();
    if (!(move.scale > 0) || report.merge->submap == report.merge->into) return invalid("a merge that is not possible");
  }
  for (const NewPoint& point : report.new_points) finite = finite && point.position.allFinite();
  for (const RefinedPoint& point : report.refined_points) finite = finite && point.position.allFinite();
  for (const PointObservation& o : report.observations) finite = finite && IsFinite(o);
  for (const auto& [stage, ms] : report.stage_ms) {
    finite = finite && std::isfinite(ms);
    if (std::ranges::find(columns.stages, stage) == columns.stages.end())
      return invalid("there is no column for the stage " + Quoted(stage));
  }
  if (!finite) return invalid("the report holds numbers that are not finite");
  if (!report.observations.empty() && !report.cam_from_world)
    return invalid("points are observed in a frame without a pose");
  return Status::Ok();
}

Status RunWriter::State::AddPoints(const FrameReport& report) {
  for (const NewPoint& point : report.new_points) {
    const auto known = std::lower_bound(points.begin(), points.end(), point.id,
                                        [](const CanonicalPoint& p, PointId id) { return p.point.id < id; });
    if (known != points.end() && known->point.id == point.id)
      return {ErrorCode::kInvalidArgument, "frame " + std::to_string(report.frame_idx) + ": point " +
                                               std::to_string(point.id.value) + " is new for the second time"};
    points.insert(known, {point, 0.0, 0, report.submap});
  }
  const auto never_new = [&](PointId id, const std::string& what) {
    return Status(ErrorCode::kInvalidArgument, "frame " + std::to_string(report.frame_idx) + ": point " +
                                                   std::to_string(id.value) + " is " + what + " but was never new");
  };
  for (const RefinedPoint& refined : report.refined_points) {
    CanonicalPoint* point = FindPoint(points, refined.id);
    if (point == nullptr) return never_new(refined.id, "refined");
    point->point.position = refined.position;
  }
  for (const PointObservation& o : report.observations) {
    CanonicalPoint* point = FindPoint(points, o.id);
    if (point == nullptr) return never_new(o.id, "observed");
    if (point->submap != report.submap)
      return {ErrorCode::kInvalidArgument, "frame " + std::to_string(report.frame_idx) + " of submap " +
                                               std::to_string(report.submap) + ": point " + std::to_string(o.id.value) +
                                               " is of submap " + std::to_string(point->submap)};
    CountObservation(camera, *report.cam_from_world, o, point);
  }
  return Status::Ok();
}

void RunWriter::State::Count(const FrameReport& report) {
  last_frame_idx = report.frame_idx;
  ++summary.frames_read;
  if (report.cam_from_world) ++summary.frames_tracked;
  if (report.first_map && (summary.first_maps.empty() ||
                           summary.first_maps.back().declared_frame_idx != report.first_map->declared_frame_idx))
    summary.first_maps.push_back(*report.first_map);
  AddTo(report.state, 1, &summary.states);
  if (report.cam_from_world) median_errors_px.push_back(report.median_reprojection_error_px);
  if (report.coverage) coverages.push_back(*report.coverage);
  if (report.followed_coverage) followed_coverages.push_back(*report.followed_coverage);
  if (report.latency_ms > 0 && options.timings == RunTimings::kWritten) latencies_ms.push_back(report.latency_ms);
  if (report.cam_from_world) summary.submaps = std::max(summary.submaps, report.submap + 1);
  summary.observations += static_cast<std::int64_t>(report.observations.size());
  summary.points = static_cast<std::int64_t>(points.size());
  for (const auto& [reason, count] : report.losses) AddTo(reason, count, &summary.losses);
  CountPrior(report.prior, &summary.prior);
}

void RunWriter::State::AppendFrameRow(const FrameReport& report) {
  const auto integer = [&](std::int64_t value) {
    rows.push_back(',');
    AppendInt(&rows, value);
  };
  const auto number = [&](double value, int decimals) {
    rows.push_back(',');
    AppendFixed(&rows, value, decimals);
  };
  AppendInt(&rows, report.frame_idx);
  number(report.timestamp_s, 6);
  rows.append(",").append(EnumName(report.state));
  for (const int count : {report.tracked, report.optimized, report.lost, report.added}) integer(count);
  for (const std::string& cost : columns.costs) number(CostOf(report.costs, cost), 6);
  number(report.median_reprojection_error_px, 4);
  integer(report.submap);
  for (std::size_t i = 0; i < columns.stages.size(); ++i) {
    double ms = 0;
    for (const auto& [stage, value] : report.stage_ms)
      if (stage == columns.stages[i] && options.timings == RunTimings::kWritten) ms += value;
    stage_total_ms[i] += ms;
    number(ms, 3);
  }
  number(options.timings == RunTimings::kWritten ? report.latency_ms : 0.0, 3);
  rows.push_back('\n');
}

Status RunWriter::State::WriteRows(const FrameReport& report) {
  rows.clear();
  for (const PointObservation& o : report.observations) AppendObservation(&rows, report.frame_idx, o);
  if (Status status = observations.Append(rows); !status.ok()) return status;
  if (report.cam_from_world) {
    rows.clear();
    AppendTumLine(&rows, report.timestamp_s, report.cam_from_world->Inverse());
    if (Status status = trajectory.Append(rows); !status.ok()) return status;
    images.push_back({report.frame_idx, report.name, *report.cam_from_world, report.submap});
    if (report.pose_covariance) AppendPoseCovariance(report.frame_idx, *report.pose_covariance, &pose_covariances);
  }
  worlds.push_back({report.frame_idx, report.submap, report.submap, std::nullopt});
  rows.clear();
  AppendFrameRow(report);
  return frames.Append(rows);
}

Status RunWriter::Write(const FrameReport& report) {
  State& s = *state_;
  if (!s.failure.ok()) return s.failure;
  if (Status status = s.Check(report); !status.ok()) return status;
  if (Status status = s.AddPoints(report); !status.ok()) return status;
  s.Count(report);
  s.failure = s.WriteRows(report);
  if (s.failure.ok() && report.cam_from_world) s.former.Forget();
  if (report.merge) s.Merge(*report.merge);
  return s.failure;
}

// The rows that are on disk stay as they are until Finish.
void RunWriter::State::Merge(const SubmapMerge& merge) {
  for (CanonicalImage& image : images)
    if (image.submap == merge.submap) {
      image.cam_from_world = PoseInWorld(merge.into_from_submap, image.cam_from_world);
      image.submap = merge.into;
    }
  for (CanonicalPoint& point : points)
    if (point.submap == merge.submap) {
      point.point.position = merge.into_from_submap * point.point.position;
      point.mean_sigma *= merge.into_from_submap.scale;
      point.submap = merge.into;
    }
  for (RunFrameWorld& world : worlds)
    if (world.submap == merge.submap) {
      world.moved_by = world.moved_by ? merge.into_from_submap * *world.moved_by : merge.into_from_submap;
      world.submap = merge.into;
    }
}

// From 0 on, without those that went into others or that never came to be. A frame that waited for one of the latter
// gets the number it would have had.
void RunWriter::State::NumberSubmaps() {
  std::set<int> used;
  for (const CanonicalImage& image : images) used.insert(image.submap);
  const auto number = [&](int submap) {
    return static_cast<int>(std::distance(used.begin(), used.lower_bound(submap)));
  };
  for (CanonicalImage& image : images) image.submap = number(image.submap);
  for (CanonicalPoint& point : points) point.submap = number(point.submap);
  for (RunFrameWorld& world : worlds) world.submap = number(world.submap);
  summary.submaps = static_cast<int>(used.size());
}

// Of one submap: its points, and its model.
Status RunWriter::State::WriteSubmap(int submap) const {
  const auto of_submap = [&](const auto& element) { return element.submap == submap; };
  std::vector<CanonicalPoint> own_points;
  std::vector<CanonicalImage> own_images;
  std::ranges::copy_if(points, std::back_inserter(own_points), of_submap);
  std::ranges::copy_if(images, std::back_inserter(own_images), of_submap);
  std::vector<NewPoint> map;
  std::vector<double> sigmas;
  for (const CanonicalPoint& point : own_points) {
    map.push_back(point.point);
    sigmas.push_back(point.mean_sigma);
  }
  if (Status status = WritePly(path + "/" + SubmapPly(submap), map, sigmas); !status.ok()) return status;
  const std::string folder = path + "/" + SubmapModel(submap, summary.submaps);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return UnwritableFolder(folder, error);
  return WriteCanonicalModel(folder, options.sparse_format, camera, own_images, own_points, path);
}

// A run of one submap has its model in sparse/, as COLMAP's programs expect one; of several each has its own, as
// COLMAP's mapper leaves them.
Status RunWriter::State::FinishSparse() const {
  Status status;
  for (int submap = 0; submap < std::max(1, summary.submaps) && status.ok(); ++submap) status = WriteSubmap(submap);
  std::error_code error;
  if (!status.ok()) fs::remove_all(path + "/sparse", error);  // half a model reads as a whole one or not at all
  return status;
}

Status RunWriter::Finish(RunStatus run_status, const std::string& note) {
  State& s = *state_;
  Status status = s.failure;
  for (OutputFile* file : {&s.observations, &s.trajectory, &s.frames})
    if (Status closed = file->Close(); status.ok()) status = closed;
  if (s.options.timings == RunTimings::kWritten) {
    s.summary.total_s = s.options.total_s.value_or(s.ElapsedS());
    if (s.summary.total_s > 0)
      s.summary.frames_per_second = static_cast<double>(s.summary.frames_read) / s.summary.total_s;
  }
  for (std::size_t i = 0; i < s.columns.stages.size(); ++i)
    s.summary.mean_ms.emplace_back(
        s.columns.stages[i],
        s.stage_total_ms[i] / static_cast<double>(std::max<std::int64_t>(s.summary.frames_read, 1)));
  s.summary.latency = LatencyOf(s.latencies_ms);
  if (status.ok() && HasCheckpoint(s.path)) status = KeepRows(s.path);
  if (status.ok()) {
    const int submaps_as_reported = s.summary.submaps;
    s.NumberSubmaps();
    status = MoveRunRows(s.path, s.worlds, s.images);
    if (!status.ok()) s.summary.submaps = submaps_as_reported;
  }
  if (status.ok() && !s.pose_covariances.empty())
    status = WriteFileAtomically(s.path + "/" + std::string(kPoseCovarianceFile),
                                 std::string(kPoseCovarianceColumns) + "\n" + s.pose_covariances);
  if (status.ok()) status = s.FinishSparse();
  if (!s.median_errors_px.empty()) s.summary.median_reprojection_error_px = Median(std::move(s.median_errors_px));
  if (!s.coverages.empty()) s.summary.median_coverage = Median(std::move(s.coverages));
  if (!s.followed_coverages.empty()) s.summary.median_followed_coverage = Median(std::move(s.followed_coverages));
  s.summary.status = status.ok() ? run_status : RunStatus::kFailed;
  s.summary.note = status.ok() ? note : status.message();
  // What ran to its end is a result even without a map; what did not takes nobody's place.
  const bool has_ended = s.summary.status == RunStatus::kCompleted || s.summary.status == RunStatus::kLost;
  if (s.former.IsAside() && !has_ended) {
    s.former.Restore();
    s.summary.note += "; the run that was in the folder before is still there";
    return status;
  }
  s.former.Forget();
  const Status written = WriteRunSummary(s.path + "/run.json", s.summary);
  if (written.ok() && has_ended) ForgetCheckpoint(s.path);
  return status.ok() ? written : status;
}

}  // namespace pliant
