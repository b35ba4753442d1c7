// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "datasets/formats.h"

#include <array>
#include <utility>

namespace pliant {

std::span<const DataSetFormat> DataSetFormats() {
  static constexpr std::array<DataSetFormat, 14> kFormats = {{
      {"colmap", "a folder of COLMAP, images/ and a model in sparse/", IsColmapFolder, OpenColmapFolder},
      {"native", "a sequence in Pliant's own layout", IsNativeSequence, OpenNativeSequence},
      {"c3vd", "C3VD or C3VDv2, a colonoscope in a phantom", IsC3vd, OpenC3vd},
      {"endomapper", "Endomapper, a real procedure", IsEndomapper, OpenEndomapper},
      {"endomapper_simulated", "Endomapper, a simulated sequence", IsEndomapperSimulated, OpenEndomapperSimulated},
      {"endoslam", "EndoSLAM's UnityCam", IsEndoSlam, OpenEndoSlam},
      {"euroc", "EuRoC MAV", IsEuroc, OpenEuroc},
      {"hamlyn_rectified", "Hamlyn's videos, rectified", IsHamlynRectified, OpenHamlynRectified},
      {"scared", "SCARED, a keyframe", IsScared, OpenScared},
      {"simcol", "SimCol3D", IsSimCol, OpenSimCol},
      {"stereomis", "StereoMIS", IsStereoMis, OpenStereoMis},
      {"tum_rgbd", "TUM RGB-D", IsTumRgbd, OpenTumRgbd},
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
