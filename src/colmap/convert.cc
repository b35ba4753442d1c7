// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/colmap/convert.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "pliant/base/text.h"

namespace pliant::colmap {
namespace {

constexpr double kPixelShift = 0.5;  // COLMAP's coordinate minus ours, px

// Adds to the principal point in a model's parameters. Too few of them are refused when the camera is made.
void ShiftPrincipalPoint(int model_id, double shift_px, std::vector<double>* params) {
  const CameraModelInfo* model = FindCameraModel(model_id);
  if (model == nullptr) return;
  const auto first = static_cast<std::size_t>(model->num_focal_lengths);
  for (std::size_t i = first; i < first + 2 && i < params->size(); ++i) (*params)[i] += shift_px;
}

}  // namespace

Result<pliant::Camera> ToPliant(const Camera& camera) {
  if (camera.model_id < 0 || camera.model_id > static_cast<int>(CameraModelId::kOpenCvFisheye)) {
    const CameraModelInfo* model = FindCameraModel(camera.model_id);
    return Status(
        ErrorCode::kInvalidArgument,
        "COLMAP's camera model " + (model == nullptr ? std::to_string(camera.model_id) : std::string(model->name)) +
            " is not one of Pliant's (SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, OPENCV_FISHEYE); "
            "convert the camera, or undistort the images (colmap image_undistorter)");
  }
  constexpr auto kMaxPixels = static_cast<std::uint64_t>(std::numeric_limits<int>::max());
  if (camera.width > kMaxPixels || camera.height > kMaxPixels)
    return Status(ErrorCode::kInvalidArgument, "the image size is impossibly large; the file is damaged");
  std::vector<double> params = camera.params;
  ShiftPrincipalPoint(camera.model_id, -kPixelShift, &params);
  return pliant::Camera::Create(static_cast<CameraModelId>(camera.model_id), static_cast<int>(camera.width),
                                static_cast<int>(camera.height), params);
}

Camera FromPliant(const pliant::Camera& camera, std::uint32_t id) {
  Camera converted;
  converted.id = id;
  converted.model_id = static_cast<int>(camera.model_id());
  converted.width = static_cast<std::uint64_t>(camera.width());
  converted.height = static_cast<std::uint64_t>(camera.height());
  converted.params.assign(camera.params().begin(), camera.params().end());
  ShiftPrincipalPoint(converted.model_id, kPixelShift, &converted.params);
  return converted;
}

Result<Rigid3> ToPliant(const Pose& pose) {
  const auto& [w, x, y, z] = pose.qvec;
  const Eigen::Quaterniond rotation(w, x, y, z);
  const Eigen::Vector3d translation(pose.tvec[0], pose.tvec[1], pose.tvec[2]);
  if (!rotation.coeffs().allFinite() || !translation.allFinite() || !(rotation.norm() > 0.0))
    return Status(ErrorCode::kInvalidArgument,
                  "the pose is not valid: a value is not a finite number, or the quaternion is zero");
  return Rigid3(rotation.normalized(), translation);
}

Pose FromPliant(const Rigid3& pose) {
  const Eigen::Quaterniond& q = pose.rotation;
  const Eigen::Vector3d& t = pose.translation;
  return {{q.w(), q.x(), q.y(), q.z()}, {t.x(), t.y(), t.z()}};
}

Eigen::Vector3d ToPliant(const Point3D& point) { return {point.xyz[0], point.xyz[1], point.xyz[2]}; }

Eigen::Vector2d ToPliant(const Point2D& point) { return {point.x - kPixelShift, point.y - kPixelShift}; }

Point2D FromPliant(const Eigen::Vector2d& pixel, std::uint64_t point3D_id) {
  return {pixel.x() + kPixelShift, pixel.y() + kPixelShift, point3D_id};
}

Result<pliant::Camera> ReadCamera(const std::string& path, std::optional<int> camera_id) {
  const auto cameras = ReadCameras(path);
  if (!cameras.ok()) return cameras.status();
  if (cameras->empty()) return Status(ErrorCode::kUnreadable, Quoted(path) + " holds no camera");
  constexpr std::size_t kMostNamed = 8;
  const std::span<const Camera> named = std::span(*cameras).first(std::min(kMostNamed, cameras->size()));
  std::string ids = CommaSeparated(named, [](const Camera& camera) { return std::to_string(camera.id); });
  if (cameras->size() > kMostNamed) ids += ", ...";
  for (const Camera& camera : *cameras) {
    if (camera_id ? static_cast<std::int64_t>(camera.id) != *camera_id : cameras->size() > 1) continue;
    auto converted = ToPliant(camera);
    if (converted.ok()) return converted;
    return Status(converted.status().code(),
                  Quoted(path) + ": camera " + std::to_string(camera.id) + ": " + converted.status().message());
  }
  return Status(ErrorCode::kInvalidArgument,
                camera_id ? Quoted(path) + " has no camera " + std::to_string(*camera_id) + ", but " + ids
                          : Quoted(path) + " holds " + std::to_string(cameras->size()) + " cameras (" + ids +
                                "); leave the one of these images in the file");
}

}  // namespace pliant::colmap
