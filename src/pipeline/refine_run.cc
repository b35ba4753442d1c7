// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/pipeline/refine_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "io/staged_run.h"
#include "pipeline/run_frames.h"
#include "pliant/base/statistics.h"
#include "pliant/base/text.h"
#include "pliant/base/version.h"
#include "pliant/camera/assumed_camera.h"
#include "pliant/datasets/native_layout.h"
#include "pliant/datasets/run_sequence.h"
#include "pliant/io/camera_file.h"
#include "pliant/io/run_map.h"
#include "pliant/io/run_reader.h"
#include "pliant/io/run_writer.h"
#include "pliant/refinement/self_calibration.h"

namespace pliant {
namespace {

// A submap of the run as a recording, and where its numbers come from.
struct RefinedSubmap {
  Recording recording;
  std::vector<PointId> ids;                                 // of the recording's points
  std::vector<std::vector<PointObservation>> observations;  // of its views, as in the run
  std::map<int, int> view_of_frame;
};

constexpr double kStartLogDepthSigma = 0.3;  // keeps those in the scene of which pixels say nothing

bool IsByMotion(const FirstMapFrames& map) {
  return map.evidence.depth_sigma > 0.0 || map.evidence.median_parallax_deg > 0.0;
}

// (F7) Depths that the run has found by motion come from the pixels that are used again: they are a start, and no
// measurement. Those of a network or of another program may say more. A run that was killed does not say what its maps
// rest on.
double LogDepthSigmaOf(const RunSummary& summary) {
  constexpr double kFromElsewhere = 0.1;
  const RunDescription& run = summary.description;
  const bool was_killed = summary.first_maps.empty() && run.metric == false && run.depth_prior.empty();
  const bool by_motion = was_killed || std::ranges::any_of(summary.first_maps, IsByMotion);
  return by_motion ? kStartLogDepthSigma : kFromElsewhere;
}

// (F7) The view whose distances a pair or a depth image has measured; -1: there is none.
int MeasuredViewOf(const RunSummary& summary, const std::map<int, int>& view_of_frame) {
  if (summary.description.metric != true) return -1;
  for (const FirstMapFrames& map : summary.first_maps)
    if (const auto view = view_of_frame.find(map.reference_frame_idx); !IsByMotion(map) && view != view_of_frame.end())
      return view->second;
  return -1;
}

// Means over the observations of each point.
void SetRestPositions(Recording* recording) {
  std::ranges::fill(recording->rest_positions, Eigen::Vector3d::Zero());
  std::vector<int> counts(recording->rest_positions.size(), 0);
  for (const RecordedObservation& observation : recording->observations) {
    recording->rest_positions[static_cast<std::size_t>(observation.point_idx)] += observation.position;
    ++counts[static_cast<std::size_t>(observation.point_idx)];
  }
  for (std::size_t i = 0; i < counts.size(); ++i) recording->rest_positions[i] /= std::max(1, counts[i]);
}

Result<std::map<int, RefinedSubmap>> ReadSubmaps(const std::string& path, const Run& run) {
  std::map<int, RefinedSubmap> submaps;
  std::map<PointId, std::pair<int, int>> index_of;  // submap, number in it
  const auto frames_idx = FramesWithPose(path, run);
  if (!frames_idx.ok()) return frames_idx.status();
  const Status status = ForEachFrame(path, *frames_idx, [&](std::size_t k, const auto& observations) {
    const RunPose& pose = run.poses[k];
    RefinedSubmap& submap = submaps[pose.submap];
    const auto view = static_cast<int>(submap.recording.times.size());
    submap.view_of_frame[*pose.frame_idx] = view;
    submap.recording.times.push_back(static_cast<double>(*pose.frame_idx));
    submap.recording.cams_from_world.push_back(pose.world_from_cam.Inverse());
    submap.observations.push_back(observations);
    for (const PointObservation& o : observations) {
      const auto [entry, added] = index_of.try_emplace(o.id, pose.submap, static_cast<int>(submap.ids.size()));
      const auto& [of_submap, number] = entry->second;
      if (Status one = CheckOneSubmap(of_submap, pose.submap, o.id); !one.ok()) return one;
      if (added) {
        submap.ids.push_back(o.id);
        submap.recording.rest_positions.emplace_back(Eigen::Vector3d::Zero());
      }
      submap.recording.observations.push_back({view, number, o.pixel, o.position});
    }
    return Status::Ok();
  });
  if (!status.ok()) return status;
  const RunDescription& description = run.summary->description;
  for (auto& [number, submap] : submaps) {
    SetRestPositions(&submap.recording);
    submap.recording.log_depth_sigma = LogDepthSigmaOf(*run.summary);
    submap.recording.measured_view_idx = MeasuredViewOf(*run.summary, submap.view_of_frame);
    if (description.patch_size > 0) submap.recording.patch_px = description.patch_size / description.image_scale;
  }
  return submaps;
}

std::size_t CountObservations(const std::map<int, RefinedSubmap>& submaps) {
  std::size_t count = 0;
  for (const auto& [number, submap] : submaps) count += submap.recording.observations.size();
  return count;
}

// A submap that cannot be refined. `new_camera`: another one than that of the run, or null; points are then on its
// rays, as far away as they were.
RefinedRecording AsItIs(const RefinedSubmap& submap, const Camera* new_camera) {
  RefinedRecording recording;
  recording.recording = submap.recording;
  if (new_camera != nullptr) {
    for (RecordedObservation& seen : recording.recording.observations) {
      const Rigid3& pose = recording.recording.cams_from_world[static_cast<std::size_t>(seen.view_idx)];
      if (const auto ray = new_camera->Unproject(seen.pixel))
        seen.position = pose.Inverse() * Eigen::Vector3d((pose * seen.position).norm() * *ray);
    }
    SetRestPositions(&recording.recording);
  }
  recording.is_inlier.assign(submap.recording.observations.size(), true);
  for (const std::vector<PointObservation>& of_view : submap.observations)
    for (const PointObservation& observation : of_view) recording.sigmas.push_back(observation.sigma);
  return recording;
}

// That the refined submap has.
int CountPoints(const RefinedRecording& refined) {
  std::set<int> seen;
  for (std::size_t o = 0; o < refined.is_inlier.size(); ++o)
    if (refined.is_inlier[o]) seen.insert(refined.recording.observations[o].point_idx);
  return static_cast<int>(seen.size());
}

SubmapRefinement SummaryOf(int number, const RefinedSubmap& submap, const RefinedRecording& refined,
                           const std::string& failure) {
  return {number,
          refined.deforming,
          refined.residual_correlation,
          refined.noise_px,
          static_cast<int>(submap.recording.times.size()),
          CountPoints(refined),
          static_cast<int>(submap.recording.observations.size()),
          static_cast<int>(std::ranges::count(refined.is_inlier, false)),
          failure};
}

RefinedModel ModelOf(const SubmapRefinement& submap) {
  if (!submap.failure.empty()) return RefinedModel::kUnchanged;
  return submap.deforming ? RefinedModel::kDeforming : RefinedModel::kRigid;
}

bool HasNewCamera(const RefineSummary& summary) {
  return summary.focal_length && summary.focal_length->failure.empty();
}

RunRefinement RefinementOf(const RefineSummary& summary, const std::map<int, RefinedRecording>& refined) {
  RunRefinement refinement;
  refinement.has_estimated_camera = HasNewCamera(summary);
  if (summary.focal_length) refinement.focal_length_kept = summary.focal_length->failure;
  std::vector<double> shares;  // of the distances
  for (const SubmapRefinement& submap : summary.submaps) {
    refinement.models.push_back(ModelOf(submap));
    if (refinement.models.back() == RefinedModel::kUnchanged) continue;
    const RefinedRecording& of_submap = refined.at(submap.submap);
    for (std::size_t o = 0; o < of_submap.sigmas.size(); ++o) {
      const RecordedObservation& seen = of_submap.recording.observations[o];
      const Rigid3& pose = of_submap.recording.cams_from_world[static_cast<std::size_t>(seen.view_idx)];
      if (of_submap.sigmas[o] > 0.0) shares.push_back(of_submap.sigmas[o] / (pose * seen.position).norm());
    }
  }
  if (!shares.empty()) refinement.depth_sigma = Median(std::move(shares));
  return refinement;
}

// The run's reports with refined poses and points.
class Reporter {
 public:
  Reporter(const Run& run, const RunMap& known, const std::map<int, RefinedSubmap>& submaps,
           const std::map<int, RefinedRecording>& refined)
      : run_(run), known_(known), submaps_(submaps), refined_(refined) {
    for (const auto& [number, recording] : refined) {
      std::size_t o = 0;
      const RefinedSubmap& submap = submaps.at(number);
      for (std::size_t view = 0; view < submap.observations.size(); ++view) {
        std::vector<PointObservation> kept;
        for (PointObservation observation : submap.observations[view]) {
          observation.position = recording.recording.observations[o].position;
          observation.sigma = recording.sigmas[o];
          if (recording.is_inlier[o]) kept.push_back(observation);
          ++o;
        }
        observations_[number].push_back(std::move(kept));
      }
      for (std::size_t i = 0; i < submap.ids.size(); ++i)
        rest_positions_[submap.ids[i]] = recording.recording.rest_positions[i];
    }
  }

  FrameReport Report(const RunFrame& frame) {
    FrameReport report = ReportOf(frame, known_);
    if (!HasPose(frame.state)) return report;
    const auto view = static_cast<std::size_t>(submaps_.at(frame.submap).view_of_frame.at(frame.frame_idx));
    report.cam_from_world = refined_.at(frame.submap).recording.cams_from_world[view];
    if (const auto& covariances = refined_.at(frame.submap).pose_covariances; !covariances.empty())
      report.pose_covariance = covariances[view];
    report.observations = observations_.at(frame.submap)[view];
    for (const PointObservation& observation : report.observations) {
      const auto rest = rest_positions_.find(observation.id);
      if (rest == rest_positions_.end()) continue;
      NewPoint point{observation.id, rest->second};
      if (const auto known = known_.points.find(observation.id); known != known_.points.end())
        point.rgb = known->second.rgb;
      report.new_points.push_back(point);
      rest_positions_.erase(rest);
    }
    CompleteReport(run_, *known_.camera, &report);
    return report;
  }

 private:
  const Run& run_;
  const RunMap& known_;
  const std::map<int, RefinedSubmap>& submaps_;
  const std::map<int, RefinedRecording>& refined_;
  std::map<int, std::vector<std::vector<PointObservation>>> observations_;
  std::map<PointId, Eigen::Vector3d> rest_positions_;  // of points that have not been reported
};

// From the submap with the most observations.
Result<SelfCalibration> CalibrationOf(const Camera& camera, const std::map<int, RefinedSubmap>& submaps,
                                      const RefineOptions& options, const std::function<bool()>& goes_on) {
  const auto largest = std::ranges::max_element(
      submaps, {}, [](const auto& numbered) { return numbered.second.recording.observations.size(); });
  return SelfCalibrate(camera, largest->second.recording, options, goes_on);
}

RefinedFocalLength FocalLengthOf(const Camera& assumed, const Result<SelfCalibration>& calibration) {
  RefinedFocalLength result{.assumed_px = assumed.MeanFocalLengthPx(), .failure = calibration.status().message()};
  if (!calibration.ok()) return result;
  result.estimated_px = calibration->camera.MeanFocalLengthPx();
  result.sigma_px = calibration->log_focal_sigma * result.estimated_px;
  if (calibration->distortion_sigma) {
    result.distortion = calibration->camera.params().back();
    result.distortion_sigma = *calibration->distortion_sigma;
  }
  return result;
}

// Where one is found it is the camera's from here on. Fails where it is asked to stop.
Result<RefinedFocalLength> EstimateFocalLength(const RefineOptions& options, const std::function<bool()>& goes_on,
                                               RunMap* known, std::map<int, RefinedSubmap>* submaps) {
  const auto calibration = CalibrationOf(*known->camera, *submaps, options, goes_on);
  if (calibration.status().code() == ErrorCode::kInterrupted) return calibration.status();
  RefinedFocalLength focal_length = FocalLengthOf(*known->camera, calibration);
  if (!calibration.ok()) return focal_length;
  known->camera = calibration->camera;
  // Depths under another focal length are a start, and no measurement.
  for (auto& [number, submap] : *submaps) {
    submap.recording.log_depth_sigma = kStartLogDepthSigma;
    submap.recording.measured_view_idx = -1;
  }
  return focal_length;
}

bool IsFocalLengthWanted(const RefineOptions& options, const RunDescription& run) {
  return options.focal_length == FocalLength::kEstimated ||
         (options.focal_length == FocalLength::kAuto && IsAssumedCamera(run.camera));
}

// Of a refinement that was stopped too: it is whole, if not at its minimum.
Result<RunSummary> Write(const RefineRequest& request, const RefineOptions& options, const Run& run,
                         const RunMap& known, const RefineSummary& summary, const RunRefinement& refinement,
                         Reporter reporter, double seconds) {
  OptionTable table;
  RefineOptions listed = options;
  listed.List(table);
  RunWriterOptions writer_options;
  writer_options.total_s = run.summary->total_s + seconds;
  RunDescription description = run.summary->description;
  description.program_version = kVersion;
  description.command_line = request.command_line;
  description.refined_from = std::filesystem::absolute(request.run_path).lexically_normal().string();
  description.refinement = refinement;
  if (!request.camera_path.empty() && !HasRunMap(request.run_path, run)) description.camera = request.camera_path;
  if (refinement.has_estimated_camera) description.camera = request.output_path + "/" + native::kCameraFile;
  auto staged = StagedRun::Create(request.output_path);
  if (!staged.ok()) return staged.status();
  auto writer = RunWriter::Create(staged->path(), *known.camera, description, table.ToYaml(), {}, writer_options);
  if (!writer.ok()) return writer.status();
  for (const RunFrame& frame : run.frames)
    if (Status status = writer->Write(reporter.Report(frame)); !status.ok()) return status;
  if (refinement.has_estimated_camera)
    if (Status status = WriteCameraFile(staged->path() + "/" + native::kCameraFile, {*known.camera}); !status.ok())
      return status;
  const Status finished = summary.stopped
                              ? writer->Finish(RunStatus::kInterrupted,
                                               "the refinement was stopped; this is its last solution of all frames")
                              : writer->Finish(run.summary->status, run.summary->note);
  if (!finished.ok()) return finished;
  if (Status status = staged->Commit(); !status.ok()) return status;
  return writer->summary();
}

}  // namespace

Status CheckPaths(const RefineRequest& request) {
  return CheckOutsideOfRun(request.run_path, request.output_path, "refined");
}

Result<RefineSummary> RefineRun(const RefineRequest& request, const RefineOptions& options,
                                const RefineProgress& callback) {
  const auto begin = std::chrono::steady_clock::now();
  if (Status status = CheckPaths(request); !status.ok()) return status;
  const auto run = ReadRun(request.run_path);
  if (!run.ok()) return run.status();
  if (run->poses.empty() || !run->summary)
    return Status(ErrorCode::kInsufficient,
                  "no frame of the run " + Quoted(request.run_path) + " was tracked; there is nothing to refine");
  auto known = KnownMapOfRun(request.run_path,
                             SequenceOfRun(request.run_path, request.sequence_path, request.camera_path), *run);
  if (!known.ok()) return known.status();
  auto submaps = ReadSubmaps(request.run_path, *run);
  if (!submaps.ok()) return submaps.status();

  const auto goes_on = [&] { return request.stop == nullptr || !*request.stop; };
  RefineSummary summary;
  if (IsFocalLengthWanted(options, run->summary->description)) {
    auto focal_length = EstimateFocalLength(options, goes_on, &*known, &*submaps);
    if (!focal_length.ok()) return focal_length.status();
    summary.focal_length = *std::move(focal_length);
  }
  std::map<int, RefinedRecording> refined;
  Status failed;
  const double all = static_cast<double>(CountObservations(*submaps));
  double share_before = 0.0;
  for (const auto& [number, submap] : *submaps) {
    const double share = static_cast<double>(submap.recording.observations.size()) / all;
    const auto on_iteration = [&](RefinementProgress progress) {
      progress.share = share_before + share * progress.share;
      if (callback) callback(progress);
      return goes_on();
    };
    auto recording = RefineRecording(*known->camera, submap.recording, options, on_iteration);
    const std::string failure = recording.status().message();
    if (!recording.ok()) {
      failed = Status(recording.status().code(), "submap " + std::to_string(number) + " cannot be refined: " + failure);
      summary.stopped = summary.stopped || failed.code() == ErrorCode::kInterrupted;
      recording = AsItIs(submap, HasNewCamera(summary) ? &*known->camera : nullptr);
    }
    summary.stopped = summary.stopped || recording->stopped;
    summary.submaps.push_back(SummaryOf(number, submap, *recording, failure));
    refined.emplace(number, *std::move(recording));
    share_before += share;
  }
  if (std::ranges::none_of(summary.submaps, &std::string::empty, &SubmapRefinement::failure)) {
    if (!summary.stopped) return failed;
    return Status(ErrorCode::kInterrupted,
                  "the refinement was stopped before it had found anything better than the run; nothing was written");
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  auto written = Write(request, options, *run, *known, summary, RefinementOf(summary, refined),
                       Reporter(*run, *known, *submaps, refined), seconds);
  if (!written.ok()) return written.status();
  summary.run = *std::move(written);
  return summary;
}

}  // namespace pliant
