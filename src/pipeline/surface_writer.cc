// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pipeline/surface_writer.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "io/npy.h"
#include "pipeline/exr_file.h"
#include "pipeline/mesh_writer.h"
#include "pliant/base/files.h"
#include "pliant/base/text.h"
#include "pliant/base/version.h"
#include "pliant/datasets/native_layout.h"
#include "pliant/datasets/png_file.h"
#include "pliant/datasets/surface_folder.h"
#include "pliant/io/camera_file.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kExrFolder = "exr";
constexpr const char* kNpyFolder = "npy";
constexpr const char* kNormalsFolder = "normals";

// CV_32FC3 in camera axes -> (n + 1) / 2 of 255, x, y, z in red, green, blue; black where there is none.
cv::Mat NormalsInColors(const cv::Mat& normals) {
  cv::Mat bgr(normals.size(), CV_8UC3, cv::Scalar::all(0));
  for (int y = 0; y < normals.rows; ++y)
    for (int x = 0; x < normals.cols; ++x) {
      const auto& normal = normals.at<cv::Vec3f>(y, x);
      if (normal == cv::Vec3f(0, 0, 0)) continue;
      for (int c = 0; c < 3; ++c)
        bgr.at<cv::Vec3b>(y, x)[2 - c] = static_cast<std::uint8_t>(std::lround(127.5F * (normal[c] + 1.0F)));
    }
  return bgr;
}

// CV_32FC1.
Status WriteDepthArray(const fs::path& path, const cv::Mat& depth) {
  const cv::Mat whole = depth.isContinuous() ? depth : depth.clone();
  const std::array<std::size_t, 2> shape = {static_cast<std::size_t>(depth.rows), static_cast<std::size_t>(depth.cols)};
  const std::string_view bytes(reinterpret_cast<const char*>(whole.data), whole.total() * whole.elemSize());
  return WriteFileAtomically(path.string(), NpyBytes("<f4", shape, bytes));
}

// An earlier surface's files. A folder that is not a surface's and not empty is left alone.
Status RemoveEarlierSurface(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error) || fs::is_empty(path, error)) return Status::Ok();
  if (!fs::exists(path / surface::kSummaryFile, error))
    return {ErrorCode::kInvalidArgument,
            Quoted(path.string()) + " holds something other than a surface; give another --output_path"};
  for (const char* folder : {native::kDepthFolder, surface::kConfidenceFolder, surface::kFilledFolder, kExrFolder,
                             kNpyFolder, kNormalsFolder})
    fs::remove_all(path / folder, error);
  return error ? Unwritable(path) : MeshWriter::RemoveEarlier(path);
}

}  // namespace

Result<SurfaceWriter> SurfaceWriter::Create(const std::string& path, const SurfaceSource& source,
                                            const SurfaceRunOptions& options) {
  const fs::path folder = path;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return Unwritable(folder);
  auto lock = FolderLock::Take(folder);
  if (!lock.ok()) return lock.status();
  if (Status status = RemoveEarlierSurface(folder); !status.ok()) return status;
  std::vector<const char*> kinds = {native::kDepthFolder, surface::kConfidenceFolder};
  if (options.fill > 0) kinds.push_back(surface::kFilledFolder);
  if (options.exr) kinds.push_back(kExrFolder);
  if (options.npy) kinds.push_back(kNpyFolder);
  if (options.normals_png) kinds.push_back(kNormalsFolder);
  for (const char* kind : kinds) {
    fs::create_directories(folder / kind, error);
    if (error) return Unwritable(folder / kind);
  }
  const double scale = source.largest_depth / native::kMaxDepthSteps;
  const LengthUnit unit = source.metric.value_or(false) ? LengthUnit::kMillimeters : LengthUnit::kMapUnits;
  if (Status status = WriteCameraFile((folder / native::kCameraFile).string(),
                                      {.camera = source.camera, .depth_scale = scale}, unit);
      !status.ok())
    return status;
  // What a surface that is killed leaves says that it is one.
  if (Status status = WriteFileAtomically((folder / surface::kSummaryFile).string(), "{\"status\": \"interrupted\"}\n");
      !status.ok())
    return status;
  return SurfaceWriter(folder, *std::move(lock), source, scale, options);
}

Status SurfaceWriter::Write(const SurfaceFrame& frame, const SurfaceMaps& maps) {
  const std::string name = frame.name;
  if (!maps.filled.empty())
    if (Status status = WritePng(path_ / surface::kFilledFolder / name, maps.filled); !status.ok()) return status;
  if (exr_)
    if (Status status = WriteDepthExr(path_ / kExrFolder / fs::path(name).replace_extension(".exr"), maps.dense.depth);
        !status.ok())
      return status;
  if (npy_)
    if (Status status =
            WriteDepthArray(path_ / kNpyFolder / fs::path(name).replace_extension(".npy"), maps.dense.depth);
        !status.ok())
      return status;
  if (!maps.normals.empty())
    if (Status status = WritePng(path_ / kNormalsFolder / name, NormalsInColors(maps.normals)); !status.ok())
      return status;
  if (Status status = WritePng(path_ / native::kDepthFolder / name, QuantizeDepth(maps.dense.depth, depth_scale_));
      !status.ok())
    return status;
  return WritePng(path_ / surface::kConfidenceFolder / name, QuantizeDepth(maps.dense.sigma, surface::kConfidenceUnit));
}

Status SurfaceWriter::Finish(const SurfaceRequest& request, const SurfaceRunOptions& options,
                             const SurfaceSummary& summary) {
  OptionTable table;
  SurfaceRunOptions listed = options;
  listed.List(table);
  if (Status status = WriteFileAtomically((path_ / "config.yaml").string(), table.ToYaml()); !status.ok())
    return status;
  Json json = {{"program_version", kVersion},
               {"command_line", request.command_line},
               {"status", summary.stopped ? "interrupted" : "completed"},
               {"run", fs::absolute(request.run_path).lexically_normal().string()},
               {"trajectory_crc32", source_.trajectory_checksum},
               {"metric", source_.metric ? Json(*source_.metric) : Json()},
               {"depth_scale", depth_scale_},
               {"windows",
                {{"image_width", summary.windows.width_px},
                 {"side", summary.windows.window_px},
                 {"smoothing_px", summary.windows.smoothing_px},
                 {"noise_levels", summary.windows.noise_levels}}},
               {"frames", Json::array()}};
  for (const SurfaceFrame& frame : summary.frames)
    json["frames"].push_back({{"frame", frame.frame_idx},
                              {"name", frame.name},
                              {"provisional", frame.provisional},
                              {"neighbors", frame.neighbors},
                              {"pair", frame.has_pair},
                              {"known_share", frame.known_share},
                              {"filled_share", frame.filled_share},
                              {"median_sigma", frame.median_sigma},
                              {"seconds", frame.seconds},
                              {"note", frame.note}});
  return WriteFileAtomically((path_ / surface::kSummaryFile).string(),
                             json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace pliant
