// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/formats.h"

#include <algorithm>
#include <array>
#include <utility>

#include "datasets/image_list.h"
#include "datasets/set_files.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxFolders = 1000;  // that are looked into for a data set, on each of two levels

std::vector<fs::path> SubfoldersOf(const fs::path& folder) {
  std::vector<fs::path> folders;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator(); entry.increment(error))
    if (IsFolder(entry->path())) folders.push_back(entry->path());
  std::sort(folders.begin(), folders.end());
  return folders;
}

// The data set at a path; null: none, or what is no set of its own, images or a video.
const DataSetFormat* SetAt(const fs::path& path) {
  const auto formats = DataSetFormats();
  for (const DataSetFormat& format : formats.first(formats.size() - 2))
    if (format.is_at(path)) return &format;
  return nullptr;
}

std::string ThatIs(const fs::path& path, const DataSetFormat& format) {
  return path.string() + " is a data set (" + std::string(format.name) + "); give that";
}

}  // namespace

std::span<const DataSetFormat> DataSetFormats() {
  static constexpr std::array<DataSetFormat, 15> kFormats = {{
      {"colmap", "a folder of COLMAP, images/ and a model in sparse/", IsColmapFolder, OpenColmapFolder},
      {"native", "a sequence in Pliant's own layout", IsNativeSequence, OpenNativeSequence},
      {"c3vd", "C3VD, C3VDv2 or C3VD-DEFCOL, a colonoscope in a phantom", IsC3vd, OpenC3vd},
      {"endomapper", "Endomapper, a real procedure", IsEndomapper, OpenEndomapper, EndomapperLacks},
      {"endomapper_simulated", "Endomapper, a simulated sequence", IsEndomapperSimulated, OpenEndomapperSimulated},
      {"endoslam", "EndoSLAM's UnityCam", IsEndoSlam, OpenEndoSlam},
      {"euroc", "EuRoC MAV", IsEuroc, OpenEuroc, EurocLacks},
      {"hamlyn_rectified", "Hamlyn's videos, rectified", IsHamlynRectified, OpenHamlynRectified, HamlynRectifiedLacks},
      {"scared", "SCARED, a keyframe", IsScared, OpenScared, ScaredLacks},
      {"simcol", "SimCol3D", IsSimCol, OpenSimCol},
      {"stereomis", "StereoMIS", IsStereoMis, OpenStereoMis, StereoMisLacks},
      {"stir", "STIR, a sequence of the left camera", IsStir, OpenStir, StirLacks},
      {"tum_rgbd", "TUM RGB-D", IsTumRgbd, OpenTumRgbd, TumRgbdLacks},
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
  // "No images here" says more than "no calibration here".
  auto data_set = images.ok() ? Calibrated(request, *std::move(images)) : Result<DataSet>(images.status());
  if (data_set.ok())
    WarnOfGaps(*data_set->images, &data_set->warnings);
  else if (data_set.status().code() == ErrorCode::kNotFound && request.camera_path.empty())
    if (const std::string instead = WhatIsThereInstead(request.image_path); !instead.empty())
      return Status(ErrorCode::kNotFound, data_set.status().message() + "; or: " + instead);
  return data_set;
}

Result<DataSet> OpenVideo(const SequenceRequest& request) {
  auto video = StreamVideo(request.image_path, request.video_index);
  if (!video.ok()) return video.status();
  return Calibrated(request, *std::move(video));
}

std::string WhatIsThereInstead(const fs::path& folder) {
  std::vector<fs::path> inside = SubfoldersOf(folder);
  for (int level = 0; level < 2; ++level) {
    std::vector<fs::path> deeper;
    for (std::size_t k = 0; k < std::min(inside.size(), kMaxFolders); ++k) {
      if (const DataSetFormat* format = SetAt(inside[k])) return ThatIs(inside[k], *format);
      for (fs::path& path : SubfoldersOf(inside[k])) deeper.push_back(std::move(path));
    }
    inside = std::move(deeper);
  }
  std::error_code error;
  fs::path above = fs::weakly_canonical(folder, error);
  for (int level = 0; level < 2 && above.has_parent_path(); ++level) {
    above = above.parent_path();
    if (const DataSetFormat* format = SetAt(above)) return ThatIs(above, *format);
  }
  for (const DataSetFormat& format : DataSetFormats())
    if (const std::string lacks = format.lacks != nullptr ? format.lacks(folder) : ""; !lacks.empty())
      return "it looks like " + std::string(format.name) + ", but lacks " + lacks;
  const std::vector<fs::path> videos = VideosIn(folder);
  if (videos.size() == 1) return "it holds no images, but the video " + videos.front().string() + "; give that";
  if (videos.size() > 1)
    return "it holds no images, but " + std::to_string(videos.size()) + " videos; give one of them, such as " +
           videos.front().string();
  return {};
}

}  // namespace pliant
