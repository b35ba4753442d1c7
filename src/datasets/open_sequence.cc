// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/datasets/open_sequence.h"

#include <utility>

#include <opencv2/videoio.hpp>

#include "datasets/image_file.h"
#include "datasets/image_folder.h"
#include "datasets/image_list.h"
#include "datasets/native_sequence.h"
#include "datasets/source_calibration.h"
#include "datasets/video_sequence.h"
#include "pliant/io/camera_file.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

bool IsFolder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

bool IsFile(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

Result<fs::path> FindCalibration(const SequenceRequest& request) {
  if (!request.camera_path.empty()) return request.camera_path;
  const fs::path beside = IsFolder(request.image_path) ? request.image_path : request.image_path.parent_path();
  fs::path file = beside / "camera.yaml";
  if (!IsFile(file))
    return Status(ErrorCode::kNotFound, "there is no calibration for " + request.image_path.string() + ": no file " +
                                            file.string() + "; write one, or name a calibration file");
  return file;
}

// The size of the source's images, for calibrations that do not say theirs; nothing where it cannot be seen.
std::optional<ImageSize> PeekImageSize(const fs::path& image_path) {
  if (IsFolder(image_path)) {
    const fs::path folder = NativeSequence::IsAt(image_path) ? image_path / "images" : image_path;
    const Result<std::vector<fs::path>> files = ListImages(folder);
    if (!files.ok()) return std::nullopt;
    const Result<cv::Mat> image = ReadImage(files->front());
    if (!image.ok()) return std::nullopt;
    return ImageSize{image->cols, image->rows};
  }
  try {
    const cv::VideoCapture capture(image_path.string(), cv::CAP_FFMPEG);
    if (!capture.isOpened()) return std::nullopt;
    return ImageSize{static_cast<int>(capture.get(cv::CAP_PROP_FRAME_WIDTH)),
                     static_cast<int>(capture.get(cv::CAP_PROP_FRAME_HEIGHT))};
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
}

Result<SourceCalibration> ReadCalibration(const SequenceRequest& request) {
  const Result<fs::path> path = FindCalibration(request);
  if (!path.ok()) return path.status();
  CameraFileOptions options;
  options.image_size = PeekImageSize(request.image_path);
  const Result<CameraFile> file = ReadCameraFile(path->string(), options);
  if (!file.ok()) return file.status();
  SourceCalibration calibration{file->camera, *path};
  if (file->fps) calibration.fps = *file->fps;
  if (file->depth_scale) calibration.depth_scale = *file->depth_scale;
  return calibration;
}

template <class Reader>
Result<std::unique_ptr<Sequence>> AsSequence(Result<std::unique_ptr<Reader>> reader) {
  if (!reader.ok()) return reader.status();
  return std::unique_ptr<Sequence>(*std::move(reader));
}

}  // namespace

Result<std::unique_ptr<Sequence>> OpenSequence(const SequenceRequest& request) {
  const fs::path& path = request.image_path;
  std::error_code error;
  if (path.empty() || !fs::exists(path, error))
    return Status(ErrorCode::kNotFound, "there is nothing at the image path '" + path.string() +
                                            "'; give a folder of images, a video or a sequence");
  const Result<FrameRange> range = FrameRange::From(request);
  if (!range.ok()) return range.status();
  const bool is_native = NativeSequence::IsAt(path);
  if (IsFolder(path)) {  // "no images here" says more than "no calibration here"
    const Result<std::vector<fs::path>> files = ListImages(is_native ? path / "images" : path);
    if (!files.ok()) return files.status();
  } else if (!IsFile(path)) {
    return Status(ErrorCode::kUnreadable, path.string() +
                                              " is neither a folder nor a file; give a folder of images, "
                                              "a video or a sequence");
  }
  Result<SourceCalibration> calibration = ReadCalibration(request);
  if (!calibration.ok()) return calibration.status();
  if (is_native) return AsSequence(NativeSequence::Open(path, *calibration, request.mask_path, *range));
  if (IsFolder(path)) return AsSequence(ImageFolder::Open(path, *std::move(calibration), request.mask_path, *range));
  return AsSequence(VideoSequence::Open(path, *std::move(calibration), request.mask_path, *range));
}

}  // namespace pliant
