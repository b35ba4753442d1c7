// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_fuzz.h"
#include "pliant/base/text.h"

namespace pliant::colmap {
namespace {

struct Binary {
  static constexpr auto Cameras = ReadBinaryCameras;
  static auto Images(const std::string& path) { return ReadBinaryImages(path, Observations::kRead); }
  static auto Points(const std::string& path) { return ReadBinaryPoints(path, Observations::kRead); }
  static constexpr auto Rigs = ReadBinaryRigs;
  static constexpr auto Frames = ReadBinaryFrames;

  static std::string Begin(std::size_t count) {
    std::string file;
    AppendBytes(&file, count, 8);
    return file;
  }
  static constexpr auto AppendCamera = AppendBinaryCamera;
  static constexpr auto AppendImage = AppendBinaryImage;
  static void AppendPoint(const Point3D& point, std::string* out) { AppendBinaryPoint(point, point.track, out); }
  static constexpr auto AppendRig = AppendBinaryRig;
  static constexpr auto AppendFrame = AppendBinaryFrame;
};

}  // namespace
}  // namespace pliant::colmap

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pliant::colmap::CheckColmapFile<pliant::colmap::Binary>(data, size);
  return 0;
}
