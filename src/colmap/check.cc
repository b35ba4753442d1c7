// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/colmap/check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <span>
#include <unordered_map>
#include <utility>

#include <Eigen/Geometry>

#include "pliant/base/text.h"
#include "pliant/camera/camera.h"

namespace pliant::colmap {
namespace {

// Quaternions in text have 17 digits, or as few as 9.
constexpr double kUnitTolerance = 1e-6;
constexpr double kMinQuaternion = 1e-9;

// Findings in the order in which the first of each turned up.
class Findings {
 public:
  void Add(Severity severity, std::string_view what, std::string example) {
    const auto [found, added] = places_.try_emplace(std::string(what), findings_.size());
    if (added) findings_.push_back({severity, std::string(what), 0, std::move(example)});
    ++findings_[found->second].count;
  }
  void Error(std::string_view what, std::string example) { Add(Severity::kError, what, std::move(example)); }
  void Warn(std::string_view what, std::string example) { Add(Severity::kWarning, what, std::move(example)); }
  std::vector<Finding> Take() { return std::move(findings_); }

 private:
  std::vector<Finding> findings_;
  std::unordered_map<std::string, std::size_t> places_;
};

bool Finite(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

std::string Named(std::string_view what, std::uint64_t id) { return std::string(what) + " " + std::to_string(id); }
std::string Named(const Image& image) { return Named("image", image.id) + " (" + image.name + ")"; }
std::string KeypointOf(const Image& image, std::size_t idx) { return Named("keypoint", idx) + " of " + Named(image); }

void CheckCamera(const Camera& camera, Findings* findings) {
  const std::string name = Named("camera", camera.id);
  if (!Finite(camera.params)) findings->Error("cameras have parameters that are not numbers", name);
  constexpr std::uint64_t kMaxPixels = 1'000'000;
  if (camera.width == 0 || camera.height == 0 || camera.width > kMaxPixels || camera.height > kMaxPixels)
    findings->Error("cameras have image sizes that are not possible", name);
  const CameraModelInfo* model = FindCameraModel(camera.model_id);
  const auto num_focal_lengths = static_cast<std::size_t>(model == nullptr ? 1 : model->num_focal_lengths);
  const auto focal_lengths = std::span(camera.params).first(std::min(num_focal_lengths, camera.params.size()));
  if (!std::ranges::all_of(focal_lengths, [](double focal_px) { return focal_px > 0.0; }))
    findings->Error("cameras have focal lengths that are not positive", name);
  if (camera.model_id > static_cast<int>(CameraModelId::kOpenCvFisheye))
    findings->Warn("cameras have a model that Pliant does not have",
                   name + ", " + std::string(FindCameraModel(camera.model_id)->name));
}

void CheckPose(const Pose& pose, const std::string& name, std::string_view kind, Findings* findings) {
  if (!Finite(pose.qvec) || !Finite(pose.tvec)) {
    findings->Error(std::string(kind) + " have poses that are not numbers", name);
    return;
  }
  const double norm = Eigen::Map<const Eigen::Vector4d>(pose.qvec.data()).norm();
  if (norm < kMinQuaternion)
    findings->Error(std::string(kind) + " have quaternions that are zero", name);
  else if (std::abs(norm - 1.0) > kUnitTolerance)
    findings->Warn(std::string(kind) + " have quaternions that are not of unit length", name);
}

// By image: which of its keypoints are in the track of the point that they name.
using Tracked = std::unordered_map<std::uint32_t, std::vector<bool>>;

Tracked TrackedKeypoints(const Model& model) {
  Tracked tracked;
  const auto images = ById(model.images);
  for (const Image& image : model.images) tracked[image.id].resize(image.points2D.size());
  for (const Point3D& point : model.points3D) {
    for (const TrackElement& element : point.track) {
      const auto image = images.find(element.image_id);
      if (image == images.end() || element.point2D_idx >= image->second->points2D.size()) continue;
      if (image->second->points2D[element.point2D_idx].point3D_id == point.id)
        tracked[element.image_id][element.point2D_idx] = true;
    }
  }
  return tracked;
}

void CheckImage(const Image& image, const CamerasById& cameras, const PointsById& points,
                const std::vector<bool>& tracked, Findings* findings) {
  const std::string name = Named(image);
  CheckPose(image.cam_from_world, name, "images", findings);
  const auto camera = cameras.find(image.camera_id);
  if (camera == cameras.end()) findings->Error("images have a camera that is not there", name);
  if (image.points2D.empty()) findings->Warn("images have no keypoints", name);
  for (std::size_t idx = 0; idx < image.points2D.size(); ++idx) {
    const Point2D& point = image.points2D[idx];
    if (!std::isfinite(point.x) || !std::isfinite(point.y))
      findings->Error("keypoints are not numbers", KeypointOf(image, idx));
    else if (camera != cameras.end() &&
             (point.x < 0.0 || point.y < 0.0 || point.x > static_cast<double>(camera->second->width) ||
              point.y > static_cast<double>(camera->second->height)))
      findings->Warn("keypoints are outside of their image", KeypointOf(image, idx));
    if (point.point3D_id == kNoPoint3D) continue;
    if (!points.contains(point.point3D_id))
      findings->Error("keypoints have a point that is not there",
                      KeypointOf(image, idx) + ", " + Named("point", point.point3D_id));
    else if (!tracked[idx])
      findings->Error("keypoints have a point whose track does not have them",
                      KeypointOf(image, idx) + ", " + Named("point", point.point3D_id));
  }
}

void CheckNames(const std::vector<Image>& images, Findings* findings) {
  std::set<std::string_view> names;
  for (const Image& image : images) {
    if (image.name.empty())
      findings->Error("images have no name", Named("image", image.id));
    else if (!names.insert(image.name).second)
      findings->Error("images have a name that another has", Named(image));
    if (image.name.find(' ') != std::string::npos)
      findings->Warn("images have names with blanks, which COLMAP cuts off in text", Named(image));
  }
}

bool IsBehind(const Point3D& point, const Pose& cam_from_world) {
  const auto& [w, x, y, z] = cam_from_world.qvec;
  const Eigen::Quaterniond rotation = Eigen::Quaterniond(w, x, y, z).normalized();
  return (rotation * Eigen::Map<const Eigen::Vector3d>(point.xyz.data())).z() + cam_from_world.tvec[2] <= 0.0;
}

void CheckPoint(const Point3D& point, const ImagesById& images, const CamerasById& cameras, Findings* findings) {
  const std::string name = Named("point", point.id);
  if (!Finite(point.xyz)) findings->Error("points have positions that are not numbers", name);
  if (!std::isfinite(point.error)) findings->Error("points have errors that are not numbers", name);
  if (point.track.size() < 2) findings->Warn("points are seen in fewer than two images", name);
  std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
  for (const TrackElement& element : point.track) {
    const auto where = [&] {
      return name + ", " + Named("keypoint", element.point2D_idx) + " of " + Named("image", element.image_id);
    };
    if (!seen.insert({element.image_id, element.point2D_idx}).second)
      findings->Error("tracks have a keypoint twice", where());
    const auto image = images.find(element.image_id);
    if (image == images.end()) {
      findings->Error("tracks have an image that is not there", where());
      continue;
    }
    const std::vector<Point2D>& keypoints = image->second->points2D;
    if (element.point2D_idx >= keypoints.size())
      findings->Error("tracks have a keypoint that is not there", where());
    else if (keypoints[element.point2D_idx].point3D_id != point.id)
      findings->Error("tracks have a keypoint that belongs to another point, or to none", where());
    const auto camera = cameras.find(image->second->camera_id);
    // A fisheye sees what is beside and behind it.
    const bool perspective =
        camera != cameras.end() && camera->second->model_id < static_cast<int>(CameraModelId::kOpenCvFisheye);
    if (perspective && IsBehind(point, image->second->cam_from_world))
      findings->Warn("points are behind a camera that sees them", where());
  }
}

void CheckRigs(const Model& model, const CamerasById& cameras, const ImagesById& images, Findings* findings) {
  const auto check_sensor = [&](const Sensor& sensor, const std::string& name) {
    if (sensor.type == SensorType::kCamera && !cameras.contains(sensor.id))
      findings->Error("rigs and frames have a camera that is not there", name + ", " + Named("camera", sensor.id));
  };
  for (const Rig& rig : model.rigs) {
    const std::string name = Named("rig", rig.id);
    if (!rig.ref_sensor)
      findings->Error("rigs have no sensor", name);
    else
      check_sensor(*rig.ref_sensor, name);
    for (const RigSensor& other : rig.sensors) {
      check_sensor(other.sensor, name);
      if (other.sensor_from_rig) CheckPose(*other.sensor_from_rig, name, "rigs", findings);
    }
  }
  const auto rigs = ById(model.rigs);
  for (const Frame& frame : model.frames) {
    const std::string name = Named("frame", frame.id);
    if (!rigs.contains(frame.rig_id)) findings->Error("frames have a rig that is not there", name);
    CheckPose(frame.rig_from_world, name, "frames", findings);
    for (const FrameData& data : frame.data) {
      check_sensor(data.sensor, name);
      if (data.sensor.type == SensorType::kCamera && (data.data_id > std::numeric_limits<std::uint32_t>::max() ||
                                                      !images.contains(static_cast<std::uint32_t>(data.data_id))))
        findings->Error("frames have an image that is not there", name + ", " + Named("image", data.data_id));
    }
  }
}

}  // namespace

std::vector<Finding> CheckModel(const Model& model) {
  Findings findings;
  const auto cameras = ById(model.cameras);
  const auto images = ById(model.images);
  const auto points = ById(model.points3D);
  if (model.cameras.empty()) findings.Error("there are no cameras", "cameras is empty");
  if (model.images.empty()) findings.Error("there are no images", "images is empty");
  if (model.points3D.empty()) findings.Warn("there are no points", "points3D is empty");
  for (const Camera& camera : model.cameras) CheckCamera(camera, &findings);
  CheckNames(model.images, &findings);
  const Tracked tracked = TrackedKeypoints(model);
  for (const Image& image : model.images) CheckImage(image, cameras, points, tracked.at(image.id), &findings);
  for (const Point3D& point : model.points3D) CheckPoint(point, images, cameras, &findings);
  CheckRigs(model, cameras, images, &findings);
  return findings.Take();
}

bool IsValid(const std::vector<Finding>& findings) {
  return std::none_of(findings.begin(), findings.end(),
                      [](const Finding& finding) { return finding.severity == Severity::kError; });
}

Result<Model> ReadValidModel(const std::string& folder, const JobProgress& progress) {
  auto model = ReadModel(folder, Observations::kRead, progress);
  if (!model.ok()) return model;
  for (const Finding& finding : CheckModel(*model))
    if (finding.severity == Severity::kError)
      return Status(ErrorCode::kUnreadable, "the model " + Quoted(folder) + " is damaged: " + finding.what +
                                                ", the first: " + finding.example +
                                                "; pliant model check lists everything that is wrong");
  return model;
}

}  // namespace pliant::colmap
