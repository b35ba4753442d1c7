// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_fuzz.h"
#include "pliant/base/text.h"

namespace pliant::colmap {
namespace {

struct Binary {
  static auto Cameras(const std::string& path) { return ReadBinaryCameras(path); }
  static auto Images(const std::string& path) { return ReadBinaryImages(path, Observations::kRead); }
  static auto Points(const std::string& path) { return ReadBinaryPoints(path, Observations::kRead); }
  static auto Rigs(const std::string& path) { return ReadBinaryRigs(path); }
  static auto Frames(const std::string& path) { return ReadBinaryFrames(path); }

  static std::string Begin(std::size_t count) {
    std::string file;
    AppendBytes(&file, count, 8);
    return file;
  }
  static void AppendCamera(const Camera& value, std::string* out) { AppendBinaryCamera(value, out); }
  static void AppendImage(const Image& value, std::string* out) { AppendBinaryImage(value, out); }
  static void AppendPoint(const Point3D& point, std::string* out) { AppendBinaryPoint(point, point.track, out); }
  static void AppendRig(const Rig& value, std::string* out) { AppendBinaryRig(value, out); }
  static void AppendFrame(const Frame& value, std::string* out) { AppendBinaryFrame(value, out); }
};

}  // namespace
}  // namespace pliant::colmap

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pliant::colmap::CheckColmapFile<pliant::colmap::Binary>(data, size);
  return 0;
}
