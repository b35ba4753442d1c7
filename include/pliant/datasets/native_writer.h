// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Writes a sequence in Pliant's own layout (docs/formats.md), frame by frame: what was written is readable at any time.
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include <opencv2/core/mat.hpp>

#include "pliant/base/folder_lock.h"
#include "pliant/base/status.h"
#include "pliant/datasets/sequence.h"
#include "pliant/geometry/rigid3.h"
#include "pliant/io/camera_file.h"

namespace pliant {

struct NativeFrame {
  double timestamp_s = 0;
  cv::Mat image = {};     // 8-bit
  cv::Mat right = {};     // these may be empty, in all frames or in none
  cv::Mat mask = {};      // 8-bit
  cv::Mat depth_mm = {};  // CV_32FC1, z along the optical axis, 0 = none
  std::optional<Rigid3> world_from_cam = std::nullopt;
};

class NativeWriter {
 public:
  // Makes the folder and writes camera.yaml. Frames of an earlier sequence there are removed. Fails with kUnwritable,
  // also while another one writes there.
  static Result<NativeWriter> Create(std::filesystem::path folder, const CameraFile& camera);

  // The next frame, NNNNNN.png. Depths beyond what 16 bits hold of the camera file's depth_scale are written as none.
  // Fails with kUnwritable; half a file is removed.
  Status Write(const NativeFrame& frame);

  // How many of these depths Write makes none, because they are too large.
  int OutOfRange(const cv::Mat& depth_mm) const;

 private:
  NativeWriter(std::filesystem::path folder, FolderLock lock, double depth_scale)
      : folder_(std::move(folder)), lock_(std::move(lock)), depth_scale_(depth_scale) {}

  Status WriteImage(const char* kind, const cv::Mat& image);

  std::filesystem::path folder_;
  FolderLock lock_;
  double depth_scale_;
  int frames_ = 0;
  std::ofstream times_;
  std::ofstream poses_;
};

}  // namespace pliant
