// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/run_start.h"

#include <utility>

#include <opencv2/core.hpp>

#include "pipeline/cloud_depth.h"
#include "pliant/datasets/check_sequence.h"
#include "pliant/datasets/open_sequence.h"
#include "pliant/io/point_cloud.h"
#include "pliant/tracking/stereo_start.h"

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
  return depth_mm;
}

// What cannot be read here is told when it is read to be tracked.
std::vector<std::string> WhatTheFirstFramesSay(const SequenceRequest& request, bool of_poses) {
  auto sequence = OpenSequence(request);
  if (!sequence.ok()) return {};
  const auto check = CheckSequence(**sequence, {.base_frames = 1, .poses = of_poses});
  return check.ok() ? check->wrong : std::vector<std::string>();
}

}  // namespace

Result<RunStart> ReadStart(const RunRequest& request, const InitOptions& init, const Sequence& sequence) {
  RunStart start;
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
  }
  if (init.method == InitMethod::kStereo)
    if (Status status = CheckPairs("a start from a pair of " + request.input.image_path.string(), sequence.camera(),
                                   sequence.BaselineMm());
        !status.ok())
      return status;
  if (init.method == InitMethod::kStereo || (init.method == InitMethod::kDepth && !from_cloud))
    start.warnings = WhatTheFirstFramesSay(request.input, /*of_poses=*/init.method == InitMethod::kDepth);
  return start;
}

}  // namespace pliant
