// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_fuzz.h"

namespace pliant::colmap {
namespace {

struct Text {
  static auto Cameras(const std::string& path) { return ReadTextCameras(path); }
  static auto Images(const std::string& path) { return ReadTextImages(path, Observations::kRead); }
  static auto Points(const std::string& path) { return ReadTextPoints(path, Observations::kRead); }
  static auto Rigs(const std::string& path) { return ReadTextRigs(path); }
  static auto Frames(const std::string& path) { return ReadTextFrames(path); }

  static std::string Begin(std::size_t /*count*/) { return {}; }
  static void AppendCamera(const Camera& value, std::string* out) { AppendTextCamera(value, out); }
  static void AppendImage(const Image& image, std::string* out) { AppendTextImage(image, Digits::kExact, out); }
  static void AppendPoint(const Point3D& point, std::string* out) {
    AppendTextPoint(point, point.track, Digits::kExact, out);
  }
  static void AppendRig(const Rig& value, std::string* out) { AppendTextRig(value, out); }
  static void AppendFrame(const Frame& value, std::string* out) { AppendTextFrame(value, out); }
};

}  // namespace
}  // namespace pliant::colmap

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pliant::colmap::CheckColmapFile<pliant::colmap::Text>(data, size);
  return 0;
}
