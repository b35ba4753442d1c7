// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Writes a surface folder (docs/formats.md), frame by frame.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "pliant/base/folder_lock.h"
#include "pliant/base/status.h"
#include "pliant/camera/camera.h"
#include "pliant/pipeline/surface_run.h"
#include "pliant/surface/dense_depth.h"

namespace pliant {

// What a frame has.
struct SurfaceMaps {
  DenseDepth dense;
  cv::Mat filled;   // CV_8UC1, 255 where the depth was filled; empty: holes are not filled
  cv::Mat normals;  // CV_32FC3, camera frame, zero: none; empty: not wanted
};

// The run that a surface is made of.
struct SurfaceSource {
  Camera camera;
  double largest_depth = 0;              // that can be written, map units
  std::optional<bool> metric = {};       // RunDescription::metric
  std::string trajectory_checksum = {};  // TrajectoryChecksum of the run
};

class SurfaceWriter {
 public:
  // Makes the folder, removes frames of an earlier surface there and writes camera.yaml. Fails with kUnwritable, and
  // kInvalidArgument where the folder holds something else.
  static Result<SurfaceWriter> Create(const std::string& path, const SurfaceSource& source,
                                      const SurfaceRunOptions& options);

  // Fail with kUnwritable.
  Status Write(const SurfaceFrame& frame, const SurfaceMaps& maps);
  // surface.json.
  Status Finish(const SurfaceRequest& request, const SurfaceRunOptions& options, const SurfaceSummary& summary);

 private:
  SurfaceWriter(std::filesystem::path path, FolderLock lock, SurfaceSource source, double depth_scale,
                const SurfaceRunOptions& options)
      : path_(std::move(path)),
        lock_(std::move(lock)),
        source_(std::move(source)),
        depth_scale_(depth_scale),
        exr_(options.exr),
        npy_(options.npy) {}

  std::filesystem::path path_;
  FolderLock lock_;
  SurfaceSource source_;
  double depth_scale_;
  bool exr_;
  bool npy_;
};

}  // namespace pliant
