// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_fuzz.h"

namespace pliant::colmap {
namespace {

struct Text {
  static constexpr auto Cameras = ReadTextCameras;
  static auto Images(const std::string& path) { return ReadTextImages(path, Observations::kRead); }
  static auto Points(const std::string& path) { return ReadTextPoints(path, Observations::kRead); }
  static constexpr auto Rigs = ReadTextRigs;
  static constexpr auto Frames = ReadTextFrames;

  static std::string Begin(std::size_t /*count*/) { return {}; }
  static constexpr auto AppendCamera = AppendTextCamera;
  static void AppendImage(const Image& image, std::string* out) { AppendTextImage(image, Digits::kExact, out); }
  static void AppendPoint(const Point3D& point, std::string* out) {
    AppendTextPoint(point, point.track, Digits::kExact, out);
  }
  static constexpr auto AppendRig = AppendTextRig;
  static constexpr auto AppendFrame = AppendTextFrame;
};

}  // namespace
}  // namespace pliant::colmap

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pliant::colmap::CheckColmapFile<pliant::colmap::Text>(data, size);
  return 0;
}
