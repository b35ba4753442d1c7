// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/exchange/import.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <utility>

#include "exchange/imported.h"
#include "pliant/base/files.h"
#include "pliant/base/options.h"
#include "pliant/base/statistics.h"
#include "pliant/base/text.h"
#include "pliant/base/version.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/io/camera_file.h"
#include "pliant/io/run_writer.h"
#include "pliant/io/trajectory.h"
#include "pliant/scene/map.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// The images, with the calibration that is named, or their own, or the model's where they have none.
SequenceRequest ImagesOf(const ImportRequest& request) {
  SequenceRequest images;
  images.image_path = request.sequence_path;
  images.camera_path = request.camera_path;
  const fs::path model = request.input_path;
  if (request.format == ImportFormat::kColmap && images.camera_path.empty())
    for (const char* name : {"cameras.txt", "cameras.bin"})
      if (Exists(model / name)) images.spare_camera_path = model / name;
  return images;
}

Result<Imported> ReadInput(const ImportRequest& request, const Sequence& sequence, const ImportOptions& options,
                           const JobProgress& progress) {
  switch (request.format) {
    case ImportFormat::kColmap:
      return ReadColmapModel(request.input_path, sequence, progress);
    case ImportFormat::kResult:
      return ReadResult(request.input_path, sequence, options);
    case ImportFormat::kTum:
    case ImportFormat::kKitti:
    case ImportFormat::kEuroc:
      break;
  }
  return ReadTrajectory(request.input_path, request.format, sequence, options);
}

void MultiplyUnit(double unit_mm, Imported* imported) {
  for (auto& [frame_idx, frame] : imported->frames) {
    frame.cam_from_world.translation *= unit_mm;
    for (PointObservation& observation : frame.observations) {
      observation.position *= unit_mm;
      observation.sigma *= unit_mm;
    }
  }
}

// What is too small for the files would be written as zeros: the points' distances, or, where there are none, the path
// of a camera that moves.
Status CheckUnit(const Imported& imported, double unit_mm) {
  std::vector<double> distances_mm;
  double path_mm = 0;
  const Eigen::Vector3d first = imported.frames.begin()->second.cam_from_world.OriginInSource();
  for (const auto& [frame_idx, frame] : imported.frames) {
    path_mm = std::max(path_mm, (frame.cam_from_world.OriginInSource() - first).norm());
    for (const PointObservation& observation : frame.observations)
      distances_mm.push_back((frame.cam_from_world * observation.position).norm());
  }
  const double length_mm = distances_mm.empty() ? path_mm : Median(std::move(distances_mm));
  if (length_mm == 0.0 || length_mm >= kMinHeldDistance_mm) return Status::Ok();
  return {ErrorCode::kMismatch, "with a unit of " + FormatDouble(unit_mm) +
                                    " mm the points, or the camera's path, are " + FormatDouble(length_mm) +
                                    " mm away; the files hold " + FormatDouble(kMinHeldDistance_mm) +
                                    " mm and more: give another --Import.unit_mm"};
}

// Frames in order of time become reports as a tracker would give them. The map is there as a whole: the first frame
// adds every point, so that each keeps the id that the other program gave it.
class Reporter {
 public:
  Reporter(const Imported& imported, const Camera& camera, const Sequence& sequence)
      : imported_(imported), camera_(camera), sequence_(sequence) {
    std::map<PointId, NewPoint> points;
    for (const auto& [frame_idx, frame] : imported.frames) {
      for (const PointObservation& observation : frame.observations) {
        last_frame_of_[observation.id] = frame_idx;
        points.try_emplace(observation.id, NewPoint{observation.id, observation.position});
      }
    }
    for (auto& [id, point] : points) {
      if (const auto color = imported.colors.find(id); color != imported.colors.end()) point.rgb = color->second;
      new_points_.push_back(point);
    }
  }

  FrameReport Report(int frame_idx) {
    FrameReport report;
    report.frame_idx = frame_idx;
    report.name = sequence_.Name(frame_idx).value_or("");
    report.timestamp_s = sequence_.TimestampS(frame_idx).value_or(0);
    report.lost = std::exchange(ended_, 0);
    const auto found = imported_.frames.find(frame_idx);
    if (found == imported_.frames.end()) {
      report.state = begun_ ? TrackingState::kLost : TrackingState::kInitializing;
      return report;
    }
    begun_ = true;
    const ImportedFrame& frame = found->second;
    report.state = TrackingState::kTracking;
    report.cam_from_world = frame.cam_from_world;
    report.observations = frame.observations;
    for (PointObservation& observation : report.observations) {
      if (std::isnan(observation.ssim)) observation.ssim = 0;
      if (last_frame_of_.at(observation.id) == frame_idx) ++ended_;
    }
    report.new_points = std::exchange(new_points_, {});
    report.tracked = report.optimized = static_cast<int>(report.observations.size());
    report.added = static_cast<int>(report.new_points.size());
    report.median_reprojection_error_px = MedianReprojectionErrorPx(camera_, frame.cam_from_world, frame.observations);
    return report;
  }

 private:
  const Imported& imported_;
  const Camera& camera_;
  const Sequence& sequence_;
  std::map<PointId, int> last_frame_of_;
  std::vector<NewPoint> new_points_;  // until the first frame with a pose
  int ended_ = 0;                     // points that the frame before saw for the last time
  bool begun_ = false;
};

Status WriteRun(const ImportRequest& request, const ImportOptions& options, const Imported& imported,
                const Camera& camera, const Sequence& sequence) {
  OptionTable table;
  ImportOptions listed = options;
  listed.List(table);
  RunWriterOptions writer_options;
  writer_options.total_s = options.seconds;
  auto writer = RunWriter::Create(
      request.output_path, camera,
      {kVersion, request.command_line, 0, request.sequence_path, ImagesOf(request).camera_path.string()},
      table.ToYaml(), {}, writer_options);
  if (!writer.ok()) return writer.status();
  Reporter reporter(imported, camera, sequence);
  for (int frame_idx = 0; frame_idx < sequence.size(); ++frame_idx)
    if (Status status = writer->Write(reporter.Report(frame_idx)); !status.ok()) return status;
  return writer->Finish(RunStatus::kCompleted, "imported from " + request.input_path + ", " +
                                                   std::to_string(imported.frames.size()) + " of " +
                                                   std::to_string(sequence.size()) + " frames");
}

Status WriteTruth(const ImportRequest& request, const Imported& imported, const Camera& camera,
                  const Sequence& sequence) {
  std::vector<TimedPose> poses;
  for (int frame_idx = 0; frame_idx < sequence.size(); ++frame_idx) {
    const auto frame = imported.frames.find(frame_idx);
    const auto time_s = sequence.TimestampS(frame_idx);
    if (frame == imported.frames.end() || !time_s)
      return {ErrorCode::kInsufficient, "frame " + std::to_string(frame_idx) + " (" +
                                            sequence.Name(frame_idx).value_or("no name") +
                                            ") has no pose, and a sequence's truth needs one for every frame; leave "
                                            "out the images without a pose"};
    poses.push_back({*time_s, frame->second.cam_from_world.Inverse()});
  }
  const fs::path folder = request.output_path;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    return {ErrorCode::kUnwritable, "cannot make the folder " + Quoted(folder.string()) + ": " + error.message()};
  if (Exists(folder / "groundtruth.txt"))
    return {ErrorCode::kInvalidArgument, "there is a groundtruth.txt in " + Quoted(folder.string()) +
                                             " already; move it away, or give another folder"};
  if (Exists(folder / "camera.yaml")) {
    // One of another program says no unit.
    CameraFileOptions options;
    options.image_size = ImageSize{camera.width(), camera.height()};
    const auto there = ReadCameraFile((folder / "camera.yaml").string(), options);
    const double unit_mm = there.ok() ? there->unit_mm : 1.0;
    for (TimedPose& pose : poses) pose.world_from_cam.translation /= unit_mm;
  } else {
    CameraFile file{camera};
    if (poses.size() > 1) {
      const double fps = static_cast<double>(poses.size() - 1) / (poses.back().timestamp_s - poses.front().timestamp_s);
      if (CheckFps(fps).ok()) file.fps = fps;  // another one makes a file that is not read
    }
    if (Status status = WriteCameraFile((folder / "camera.yaml").string(), file); !status.ok()) return status;
  }
  return WriteTumTrajectory((folder / "groundtruth.txt").string(), poses);
}

}  // namespace

void ImportOptions::List(OptionTable& table) {
  table.BeginGroup("Import", "what is imported from another program");
  table.Add("unit_mm", &unit_mm, "mm", "size of a unit of the input", 1e-9, 1e9);
  table.Add("max_time_difference_s", &max_time_difference_s, "s",
            "result, tum, euroc: a pose belongs to the nearest frame in time, if it is not further than this", 0.0,
            10.0);
  table.Add("seconds", &seconds, "s", "time that the other program took, for run.json", 0.0, 1e9);
}

Result<ImportSummary> Import(const ImportRequest& request, const ImportOptions& options, const JobProgress& progress) {
  if (request.format == ImportFormat::kColmap)
    if (Status status = CheckOneCamera(request.input_path); !status.ok()) return status;
  const auto sequence = OpenSequence(ImagesOf(request));
  if (!sequence.ok()) return sequence.status();
  auto imported = ReadInput(request, **sequence, options, progress);
  if (!imported.ok()) return imported.status();
  if (imported->frames.empty())
    return Status(ErrorCode::kInsufficient,
                  Quoted(request.input_path) + " gives no frame a pose; there is nothing to import");
  MultiplyUnit(options.unit_mm, &*imported);
  if (Status status = CheckUnit(*imported, options.unit_mm); !status.ok()) return status;
  if (Status status = Tell(progress, "read", 1, 1); !status.ok()) return status;
  const Camera& camera = imported->camera ? *imported->camera : (*sequence)->camera();
  const Status written = request.as == ImportAs::kRun ? WriteRun(request, options, *imported, camera, **sequence)
                                                      : WriteTruth(request, *imported, camera, **sequence);
  if (!written.ok()) return written;
  ImportSummary summary;
  summary.frames = static_cast<int>(imported->frames.size());
  summary.sequence_frames = (*sequence)->size();
  std::set<PointId> points;
  for (const auto& [frame_idx, frame] : imported->frames) {
    summary.observations += static_cast<std::int64_t>(frame.observations.size());
    for (const PointObservation& observation : frame.observations) points.insert(observation.id);
  }
  summary.points = static_cast<int>(points.size());
  summary.notes = std::move(imported->notes);
  return summary;
}

}  // namespace pliant
