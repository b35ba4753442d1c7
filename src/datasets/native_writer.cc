// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/native_writer.h"

#include <utility>

#include <opencv2/core.hpp>

#include "pliant/base/files.h"
#include "pliant/base/options.h"
#include "pliant/datasets/native_layout.h"
#include "pliant/datasets/png_file.h"
#include "pliant/io/trajectory.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// Frames that an earlier sequence left would be read as part of this one. A folder that holds anything else stays.
Status RemoveFrames(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder, error)) return Status::Ok();
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    if (entry.path().extension() == ".png" && !fs::remove(entry.path(), error)) return Unwritable(entry.path());
  if (error) return Unwritable(folder);
  fs::remove(folder, error);
  return Status::Ok();
}

}  // namespace

Result<NativeWriter> NativeWriter::Create(fs::path folder, const CameraFile& camera) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return Unwritable(folder);
  auto lock = FolderLock::Take(folder);
  if (!lock.ok()) return lock.status();
  for (const char* kind : {native::kImageFolder, native::kRightFolder, native::kDepthFolder, native::kMaskFolder})
    if (Status status = RemoveFrames(folder / kind); !status.ok()) return status;
  for (const char* file : {native::kPosesFile, native::kTimesFile}) fs::remove(folder / file, error);
  if (Status status = WriteCameraFile((folder / native::kCameraFile).string(), camera); !status.ok()) return status;
  return NativeWriter(std::move(folder), *std::move(lock), camera.depth_scale.value_or(1.0));
}

int NativeWriter::OutOfRange(const cv::Mat& depth_mm) const {
  return depth_mm.empty() ? 0 : cv::countNonZero(depth_mm > native::kMaxDepthSteps * depth_scale_);
}

Status NativeWriter::WriteImage(const char* kind, const cv::Mat& image) {
  if (image.empty()) return Status::Ok();
  const fs::path folder = folder_ / kind;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return Unwritable(folder);
  return WritePng(folder / native::FrameFileName(frames_), image);
}

Status NativeWriter::Write(const NativeFrame& frame) {
  const cv::Mat depth = frame.depth_mm.empty() ? cv::Mat() : QuantizeDepth(frame.depth_mm, depth_scale_);
  for (const auto& [kind, image] :
       {std::pair(native::kImageFolder, &frame.image), std::pair(native::kRightFolder, &frame.right),
        std::pair(native::kMaskFolder, &frame.mask), std::pair(native::kDepthFolder, &depth)})
    if (Status status = WriteImage(kind, *image); !status.ok()) return status;
  if (frame.world_from_cam) {
    if (!poses_.is_open()) poses_.open(folder_ / native::kPosesFile);
    std::string pose;
    AppendTumLine(&pose, frame.timestamp_s, *frame.world_from_cam);
    poses_ << pose << std::flush;
    if (!poses_) return Unwritable(folder_ / native::kPosesFile);
  }
  if (!times_.is_open()) times_.open(folder_ / native::kTimesFile);
  times_ << FormatDouble(frame.timestamp_s) << std::endl;
  if (!times_) return Unwritable(folder_ / native::kTimesFile);
  ++frames_;
  return Status::Ok();
}

}  // namespace pliant
