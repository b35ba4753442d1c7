// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/formats.h"

#include <array>
#include <utility>

namespace pliant {

std::span<const DataSetFormat> DataSetFormats() {
  static constexpr std::array<DataSetFormat, 3> kFormats = {{
      {"native", "a sequence in Pliant's own layout", IsNativeSequence, OpenNativeSequence},
      {"images", "a folder of images", IsFolder, OpenImageFolder},
      {"video", "a video", IsFile, OpenVideo},
  }};
  return kFormats;
}

bool IsFolder(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_directory(path, error);
}

bool IsFile(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

namespace {

Result<DataSet> WithCalibration(const SequenceRequest& request, Result<std::unique_ptr<ImageStream>> images) {
  if (!images.ok()) return images.status();  // "no images here" says more than "no calibration here"
  Result<SourceCalibration> calibration = ReadCalibration(request, **images);
  if (!calibration.ok()) return calibration.status();
  return DataSet{.calibration = *std::move(calibration), .images = *std::move(images), .mask_path = request.mask_path};
}

}  // namespace

Result<DataSet> OpenImageFolder(const SequenceRequest& request) {
  return WithCalibration(request, StreamFolder(request.image_path));
}

Result<DataSet> OpenVideo(const SequenceRequest& request) {
  return WithCalibration(request, StreamVideo(request.image_path));
}

}  // namespace pliant
