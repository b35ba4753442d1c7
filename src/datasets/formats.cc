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

Result<DataSet> OpenImageFolder(const SequenceRequest& request) {
  auto images = StreamFolder(request.image_path);
  if (!images.ok()) return images.status();  // "no images here" says more than "no calibration here"
  return Calibrated(request, *std::move(images));
}

Result<DataSet> OpenVideo(const SequenceRequest& request) {
  auto video = StreamVideo(request.image_path);
  if (!video.ok()) return video.status();
  return Calibrated(request, *std::move(video));
}

}  // namespace pliant
