// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "exchange/run_images.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "datasets/image_file.h"
#include "pliant/base/text.h"
#include "pliant/camera/same_camera.h"
#include "pliant/datasets/run_sequence.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

}  // namespace

Result<RunImages> RunImages::Open(const RunSource& source) {
  auto sequence = OpenImagesOfRun(source.run_path, source.images);
  if (!sequence.ok()) return sequence.status();
  if (Status status = CheckCameraOfImages(source.images, *source.run, source.camera, (*sequence)->camera());
      !status.ok())
    return status;
  if (Status status = CheckMasksOfRun(source.images, *source.run); !status.ok()) return status;
  return RunImages(source, *std::move(sequence));
}

Result<RunImage> RunImages::Read(const SourceFrame& frame) {
  const auto found = NextFrameOfRun(source_->camera, frame.frame_idx, frame.name, sequence_.get());
  if (!found.ok()) return found.status();
  RunImage result{found->image, found->mask, {}};
  if (found->image.channels() == 1) cv::cvtColor(found->image, result.image, cv::COLOR_GRAY2BGR);
  if (!source_->surface) return result;
  const SurfaceFolder::Frame* entry = FindFrame(*source_->surface, frame.frame_idx);
  auto surface = ReadSurfaceDepth(*source_->surface, *entry);
  if (!surface.ok()) return surface.status();
  surface->KeepMeasured();
  result.depth = surface->depth;
  return result;
}

Result<SurfaceFolder> ReadSurfaceOfRun(const std::string& path, const std::string& run_path, const RunMap& known) {
  auto surface = ReadSurfaceFolder(path);
  if (!surface.ok()) return surface.status();
  const auto mismatch = [&](const std::string& what) {
    return Status(ErrorCode::kMismatch, "the surface " + Quoted(path) + " " + what + "; make one with pliant surface");
  };
  if (Status status = CheckSurfaceOfRun(*surface, run_path); !status.ok()) return status;
  const Camera& camera = *known.camera;
  if (surface->camera.width() != camera.width() || surface->camera.height() != camera.height())
    return mismatch("has images of " + SizeText(surface->camera.width(), surface->camera.height()) +
                    " pixels, and the run of " + SizeText(camera.width(), camera.height()));
  if (!IsSameCamera(surface->camera, camera)) return mismatch("has another camera than the run");
  const SurfaceFileNames names(known.names);
  for (const SurfaceFolder::Frame& frame : surface->frames) {
    const auto name = known.names.find(frame.frame_idx);
    if (name != known.names.end() && fs::path(names.Of(frame.frame_idx)).stem() != fs::path(frame.file_name).stem())
      return mismatch("calls frame " + std::to_string(frame.frame_idx) + " " + frame.file_name +
                      ", and the run calls it " + name->second);
  }
  return surface;
}

const SurfaceFolder::Frame* FindFrame(const SurfaceFolder& surface, int frame_idx) {
  const auto found = std::ranges::find(surface.frames, frame_idx, &SurfaceFolder::Frame::frame_idx);
  return found != surface.frames.end() ? &*found : nullptr;
}

}  // namespace pliant
