// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <array>
#include <bit>
#include <cstring>
#include <filesystem>
#include <limits>

#include "io/colmap_pixels.h"
#include "io/text.h"
#include "pliant/io/colmap.h"

namespace pliant {
namespace {

constexpr std::uint64_t kMostCameras = 1'000'000;  // more is a damaged file

// Camera parameters as COLMAP's files have them, made ours.
Result<Camera> FromColmap(CameraModelId model, std::uint64_t width, std::uint64_t height, std::vector<double> params) {
  constexpr std::uint64_t kMostPixels = std::numeric_limits<int>::max();
  if (width > kMostPixels || height > kMostPixels)
    return Status(ErrorCode::kInvalidArgument, "the image size is beyond reason; the file is damaged");
  ShiftPrincipalPoint(model, -kColmapPixelShift, params);
  return Camera::Create(model, static_cast<int>(width), static_cast<int>(height), params);
}

Result<ColmapCamera> ParseTextCamera(std::string_view line) {
  const std::vector<std::string_view> fields = Split(line, ' ');
  std::int64_t id = 0;
  std::int64_t width = 0;
  std::int64_t height = 0;
  if (fields.size() < 5 || !ParseInt64(fields[0], &id) || !ParseInt64(fields[2], &width) ||
      !ParseInt64(fields[3], &height) || width <= 0 || height <= 0)
    return Status(ErrorCode::kUnreadable, "expected `CAMERA_ID MODEL WIDTH HEIGHT PARAMS...`");
  std::vector<double> params;
  for (std::size_t i = 4; i < fields.size(); ++i) {
    params.emplace_back();
    if (!ParseFinite(fields[i], &params.back()))
      return Status(ErrorCode::kInvalidArgument, Quoted(fields[i]) + " is not a finite number");
  }
  const auto model = ColmapModel(fields[1]);
  if (!model.ok()) return model.status();
  auto camera = FromColmap(*model, static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height), params);
  if (!camera.ok()) return camera.status();
  return ColmapCamera{static_cast<int>(id), std::move(camera).value()};
}

Result<std::vector<ColmapCamera>> ReadText(const std::string& path) {
  auto reader = LineReader::Open(path);
  if (!reader.ok()) return reader.status();
  std::vector<ColmapCamera> cameras;
  for (std::string_view line; reader->Next(&line);) {
    if (line.starts_with('#') || Split(line, ' ').empty()) continue;
    auto camera = ParseTextCamera(line);
    if (!camera.ok())
      return Status(camera.status().code(), At(path, reader->number()) + ": " + camera.status().message());
    cameras.push_back(std::move(camera).value());
  }
  return cameras;
}

// Takes little-endian numbers off the front; once there are too few bytes every further one is 0.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}
  std::uint64_t Take(int num_bytes) {
    if (bytes_.size() < static_cast<std::size_t>(num_bytes)) {
      truncated_ = true;
      return 0;
    }
    std::uint64_t value = 0;
    for (int i = 0; i < num_bytes; ++i)
      value |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes_[static_cast<std::size_t>(i)])) << (8 * i);
    bytes_.remove_prefix(static_cast<std::size_t>(num_bytes));
    return value;
  }
  double TakeDouble() { return std::bit_cast<double>(Take(8)); }
  bool truncated() const { return truncated_; }

 private:
  std::string_view bytes_;
  bool truncated_ = false;
};

Result<std::vector<ColmapCamera>> ReadBinary(const std::string& path) {
  const auto bytes = ReadFile(path);
  if (!bytes.ok()) return bytes.status();
  const Status damaged(ErrorCode::kUnreadable, Quoted(path) + " ends too early or is not COLMAP's cameras.bin");
  ByteReader reader(*bytes);
  const std::uint64_t count = reader.Take(8);
  if (reader.truncated() || count > kMostCameras) return damaged;
  std::vector<ColmapCamera> cameras;
  for (std::uint64_t i = 0; i < count; ++i) {
    const int id = static_cast<int>(reader.Take(4));
    const int model = static_cast<int>(static_cast<std::int32_t>(reader.Take(4)));
    const std::uint64_t width = reader.Take(8);
    const std::uint64_t height = reader.Take(8);
    if (reader.truncated()) return damaged;
    const std::string where = Quoted(path) + ": camera " + std::to_string(id) + ": ";
    constexpr std::array kNumParams = {SimplePinhole::kNumParams, Pinhole::kNumParams, SimpleRadial::kNumParams,
                                       Radial::kNumParams,        OpenCv::kNumParams,  OpenCvFisheye::kNumParams};
    if (model < 0 || model >= static_cast<int>(kNumParams.size()))
      return Status(ErrorCode::kInvalidArgument,
                    where + "COLMAP's camera model " + std::to_string(model) +
                        " is not one of Pliant's (0 SIMPLE_PINHOLE to 5 OPENCV_FISHEYE); convert the camera");
    std::vector<double> params(static_cast<std::size_t>(kNumParams[static_cast<std::size_t>(model)]));
    for (double& param : params) param = reader.TakeDouble();
    if (reader.truncated()) return damaged;
    auto camera = FromColmap(static_cast<CameraModelId>(model), width, height, params);
    if (!camera.ok()) return Status(camera.status().code(), where + camera.status().message());
    cameras.push_back({id, std::move(camera).value()});
  }
  return cameras;
}

}  // namespace

Result<CameraModelId> ColmapModel(std::string_view name) {
  std::vector<std::string> names;
  for (const auto& [id, known] : EnumNames<CameraModelId>::kNames) {
    if (known == name) return id;
    names.emplace_back(known);
  }
  return Status(ErrorCode::kInvalidArgument, "there is no camera model " + Quoted(name) + "; did you mean " +
                                                 Quoted(NearestName(name, names)) + "?");
}

void ShiftPrincipalPoint(CameraModelId model, double shift_px, std::vector<double>& params) {
  const bool one_focal = model == CameraModelId::kSimplePinhole || model == CameraModelId::kSimpleRadial ||
                         model == CameraModelId::kRadial;
  const std::size_t first = one_focal ? 1 : 2;
  // Too few parameters are refused when the camera is made.
  for (std::size_t i = first; i < first + 2 && i < params.size(); ++i) params[i] += shift_px;
}

Result<std::vector<ColmapCamera>> ReadColmapCameras(const std::string& path) {
  return std::filesystem::path(path).extension() == ".bin" ? ReadBinary(path) : ReadText(path);
}

}  // namespace pliant
