// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// nerfstudio's own format: transforms.json and the files that it names. Its image coordinates are COLMAP's.

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "exchange/exports.h"
#include "exchange/neural_scene.h"
#include "exchange/run_images.h"
#include "pliant/base/files.h"
#include "pliant/base/staged_folder.h"
#include "pliant/colmap/convert.h"
#include "pliant/datasets/native_layout.h"
#include "pliant/datasets/png_file.h"
#include "pliant/io/ply.h"

namespace pliant {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kTransformsFile = "transforms.json";
constexpr const char* kPointsFile = "sparse_pc.ply";
// A step of a depth image in the unit of the poses, unless nerfstudio is told otherwise (depth_unit_scale_factor).
constexpr double kDepthStep = 1e-3;

Json CameraJson(const Camera& camera) {
  const std::vector<double> p = colmap::FromPliant(camera, 1).params;
  const bool one_focal_length = camera.model_id() == CameraModelId::kSimplePinhole ||
                                camera.model_id() == CameraModelId::kSimpleRadial ||
                                camera.model_id() == CameraModelId::kRadial;
  const std::size_t center = one_focal_length ? 1 : 2;
  std::vector<std::string> distortion = {"k1", "k2", "p1", "p2"};
  std::string model = p.size() > center + 2 ? "OPENCV" : "PINHOLE";
  if (camera.model_id() == CameraModelId::kOpenCvFisheye) {
    model = "OPENCV_FISHEYE";
    distortion = {"k1", "k2", "k3", "k4"};
  }
  Json json = {{"camera_model", model}, {"w", camera.width()}, {"h", camera.height()}, {"fl_x", p[0]},
               {"fl_y", p[center - 1]}, {"cx", p[center]},     {"cy", p[center + 1]}};
  if (model != "PINHOLE")
    for (std::size_t i = 0; i < distortion.size(); ++i)
      json[distortion[i]] = center + 2 + i < p.size() ? p[center + 2 + i] : 0.0;
  return json;
}

Json PoseJson(const Rigid3& cam_from_world, double unit) {
  const Eigen::Matrix<double, 3, 4> pose = OpenGlWorldFromCam(cam_from_world, unit);
  Json rows = Json::array();
  for (int r = 0; r < 3; ++r) rows.push_back({pose(r, 0), pose(r, 1), pose(r, 2), pose(r, 3)});
  rows.push_back({0.0, 0.0, 0.0, 1.0});
  return rows;
}

// From 0 at the source's first frame to 1 at its last.
double TimeOf(const RunSource& source, const SourceFrame& frame) {
  const double first = source.frames.front().timestamp_s;
  const double length = source.frames.back().timestamp_s - first;
  return length > 0.0 ? std::clamp((frame.timestamp_s - first) / length, 0.0, 1.0) : 0.0;
}

// Writes an image of the frame and names it in `json`.
Status AddImage(const ExportFolder& out, const char* folder, const SourceFrame& frame, const cv::Mat& image,
                const char* key, Json* json) {
  const std::string name = std::string(folder) + "/" + NumberOf(frame) + ".png";
  (*json)[key] = name;
  if (Status status = out.AddFolder(folder); !status.ok()) return status;
  return WritePng(out.Path(name), image);
}

Result<Json> WriteFrame(const ExportFolder& out, const RunSource& source, const SourceFrame& frame,
                        const RunImage& image, double unit) {
  Json json;
  Status status = AddImage(out, native::kImageFolder, frame, image.image, "file_path", &json);
  if (status.ok() && !image.depth.empty())
    status = AddImage(out, native::kDepthFolder, frame, QuantizeDepth(image.depth, kDepthStep * unit),
                      "depth_file_path", &json);
  if (status.ok() && !image.mask.empty())
    status = AddImage(out, native::kMaskFolder, frame, image.mask, "mask_path", &json);
  if (!status.ok()) return status;
  json["time"] = TimeOf(source, frame);
  json["transform_matrix"] = PoseJson(frame.cam_from_world, unit);
  return json;
}

std::vector<NewPoint> PointsIn(double unit, const std::vector<CanonicalPoint>& points) {
  std::vector<NewPoint> result;
  for (const CanonicalPoint& point : points) {
    result.push_back(point.point);
    result.back().position /= unit;
  }
  return result;
}

}  // namespace

Status ExportNerfstudio(const RunSource& source, const ExportOptions& /*options*/, const ExportFolder& folder) {
  if (Status status = CheckAbsent(folder.place, {kTransformsFile, kPointsFile, native::kImageFolder,
                                                 native::kDepthFolder, native::kMaskFolder});
      !status.ok())
    return status;
  auto images = RunImages::Open(source);
  if (!images.ok()) return images.status();
  const auto depth = TypicalDepth(source);
  if (!depth.ok()) return depth.status();
  const double unit = PowerOfTenUpTo(*depth);
  Json json = CameraJson(source.camera);
  json["ply_file_path"] = kPointsFile;
  json["unit"] = unit;  // nerfstudio passes over it
  json["frames"] = Json::array();
  int done = 0;
  for (const SourceFrame& frame : source.frames) {
    if (Status status = Tell(source.progress, "export", ++done, static_cast<int>(source.frames.size())); !status.ok())
      return status;
    const auto image = images->Read(frame);
    if (!image.ok()) return image.status();
    auto entry = WriteFrame(folder, source, frame, *image, unit);
    if (!entry.ok()) return entry.status();
    json["frames"].push_back(*std::move(entry));
  }
  if (Status status = WritePly(folder.Path(kPointsFile), PointsIn(unit, source.points)); !status.ok()) return status;
  return WriteFileAtomically(folder.Path(kTransformsFile), json.dump(2) + "\n");
}

}  // namespace pliant
