// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/run_start.h"

#include <cmath>
#include <utility>

#include <opencv2/core.hpp>

#include "pipeline/cloud_depth.h"
#include "pipeline/working_frame.h"
#include "pliant/base/options.h"
#include "pliant/base/statistics.h"
#include "pliant/datasets/check_sequence.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/image/depth_lookup.h"
#include "pliant/io/point_cloud.h"
#include "pliant/photometric/stereo_matching.h"
#include "pliant/scene/map.h"

namespace pliant {
namespace {

Result<cv::Mat> ReadCloud(const DepthInitOptions& options, const Camera& camera) {
  auto points = ReadPointCloud(options.cloud_path);
  if (!points.ok()) return points.status();
  for (Eigen::Vector3d& point : *points) point *= options.cloud_unit_mm;
  cv::Mat depth_mm = DepthOfCloud(*points, camera);
  if (cv::countNonZero(depth_mm) == 0)
    return Status(ErrorCode::kMismatch,
                  "the point cloud '" + options.cloud_path +
                      "' has nothing in front of the camera and in its image; give it in the first frame's camera, x "
                      "right, y down, z ahead");
  if (const double median_mm = Median(KnownDepths(depth_mm)); median_mm < kMinHeldDistance_mm)
    return Status(ErrorCode::kMismatch, "the point cloud '" + options.cloud_path + "' is " + FormatDouble(median_mm) +
                                            " mm away, in the median, and the files of a run hold " +
                                            FormatDouble(kMinHeldDistance_mm) +
                                            " mm and more: give another Init.depth_cloud_unit_mm");
  return depth_mm;
}

// Unlikely of a scene: 5 mm is nearer than endoscopes see sharply.
constexpr double kNearestMedian_mm = 5.0;

std::vector<std::string> CloudWarnings(const std::string& path, const cv::Mat& depth_mm) {
  const double median_mm = Median(KnownDepths(depth_mm));
  if (median_mm >= kNearestMedian_mm) return {};
  return {"the point cloud '" + path + "' has a median depth of " +
          FormatDouble(std::round(100.0 * median_mm) / 100.0) +
          " mm; if its unit is the meter, set Init.depth_cloud_unit_mm to 1000"};
}

// Whether a frame of the request has a depth image; one that cannot be read is one.
bool HasDepth(const SequenceRequest& request, const Sequence& sequence) {
  for (int k = 0; k < sequence.size(); ++k) {
    const auto depth_mm = sequence.Depth(request.start + k * request.stride);
    if (!depth_mm.ok() || depth_mm->has_value()) return true;
  }
  return false;
}

// Of the runs that are long enough; of fewer where `watch` is stopped.
ImageStatistics MeasureImages(const std::vector<ImageRun>& runs, const WorkingImage& working,
                              const TrackOptions& options, const ImageWatch& watch) {
  std::vector<RunMeasurement> measured;
  const TrackerOptions tracker = WorkingOptions(options.tracker, working);
  for (const ImageRun& run : runs) {
    if (watch.IsStopped()) break;
    if (std::ssize(run) < kStatisticsRunFrames) continue;
    std::vector<PreparedFrame> frames;
    for (int k = 0; k < kStatisticsRunFrames; ++k)
      frames.push_back(PrepareWorkingFrame(run[static_cast<std::size_t>(k)], working, tracker));
    measured.push_back(MeasureRun(frames, tracker, options.threads));
  }
  return Summarize(measured);
}

// What cannot be read here is told when it is read to be tracked.
std::vector<std::string> WhatTheFirstFramesSay(const SequenceRequest& request, bool of_poses) {
  auto sequence = OpenSequence(request);
  if (!sequence.ok()) return {};
  const auto check = CheckSequence(**sequence, {.base_frames = 1, .poses = of_poses, .images = false});
  return check.ok() ? check->wrong : std::vector<std::string>();
}

// Where a file of tracks is given.
Status ReadTracks(const RunRequest& request, const TrackOptions& options, RunStart* start) {
  if (!options.track_file.IsGiven()) return Status::Ok();
  auto tracks = ReadTracksOfSequence(options.track_file, request.input);
  if (!tracks.ok()) return tracks.status();
  start->tracks = std::move(tracks->tracks);
  start->warnings = std::move(tracks->notes);
  return Status::Ok();
}

void Append(std::vector<std::string> more, std::vector<std::string>* warnings) {
  warnings->insert(warnings->end(), more.begin(), more.end());
}

}  // namespace

Result<RunStart> ReadStart(const RunRequest& request, const TrackOptions& options, const Sequence& sequence,
                           const ImageWatch& watch) {
  const InitOptions& init = options.tracker.init;
  RunStart start;
  if (Status status = ReadTracks(request, options, &start); !status.ok()) return status;
  const std::vector<ImageRun> runs =
      options.FollowsInSource() ? std::vector<ImageRun>() : ReadFirstRuns(request.input, watch);
  start.working_image = ChooseWorkingImage(runs, options, watch);
  if (start.working_image.interlaced && options.image.interlaced == Interlacing::kMeasured)
    start.warnings.push_back(
        "the images are interlaced, and their odd rows are of another time: they are not used (Image.interlaced)");
  start.images = MeasureImages(runs, start.working_image, options, watch);
  if (watch.IsStopped()) return Status(ErrorCode::kInterrupted, "stopped on request before the first frame");
  auto camera = sequence.camera().Resized(start.working_image.scale);
  if (!camera.ok()) return camera.status();
  start.working_camera = *std::move(camera);
  start.first_frame_idx = request.input.start;
  if (init.method == InitMethod::kColmapModel) {
    auto model = ModelStart::Open(init.model.path, sequence.camera());
    if (!model.ok()) return model.status();
    start.model = *std::move(model);
  }
  const bool from_cloud = init.method == InitMethod::kDepth && !init.depth.cloud_path.empty();
  if (from_cloud) {
    auto depth_mm = ReadCloud(init.depth, sequence.camera());
    if (!depth_mm.ok()) return depth_mm.status();
    start.cloud_depth_mm = *std::move(depth_mm);
    Append(CloudWarnings(init.depth.cloud_path, start.cloud_depth_mm), &start.warnings);
  } else if (init.method == InitMethod::kDepth && !HasDepth(request.input, sequence)) {
    return Status(ErrorCode::kNotFound, "a start from depth needs depth images, and " +
                                            request.input.image_path.string() +
                                            " has none; name a point cloud of its first frame with Init.depth_cloud, "
                                            "or choose another Init.method");
  }
  if (init.method == InitMethod::kStereo)
    if (Status status = CheckPairs("a start from a pair of " + request.input.image_path.string(), sequence.camera(),
                                   sequence.BaselineMm());
        !status.ok())
      return status;
  if (init.method == InitMethod::kStereo || (init.method == InitMethod::kDepth && !from_cloud))
    Append(WhatTheFirstFramesSay(request.input, /*of_poses=*/init.method == InitMethod::kDepth), &start.warnings);
  return start;
}

}  // namespace pliant
