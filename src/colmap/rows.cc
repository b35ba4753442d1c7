// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap/rows.h"

#include "pliant/base/text.h"

namespace pliant::colmap {
namespace {

constexpr int kQuaternionDecimals = 9;
constexpr int kLengthDecimals = 6;
constexpr int kPixelDecimals = 4;

void AppendNumber(double value, Digits digits, int decimals, std::string* out) {
  if (digits == Digits::kExact)
    AppendExact(out, value);
  else
    AppendFixed(out, value, decimals);
}

void AppendUnsigned(std::uint64_t value, std::string* out) { *out += std::to_string(value); }

void AppendTextPose(const Pose& pose, Digits digits, std::string* out) {
  for (const double value : pose.qvec) {
    out->push_back(' ');
    AppendNumber(value, digits, kQuaternionDecimals, out);
  }
  for (const double value : pose.tvec) {
    out->push_back(' ');
    AppendNumber(value, digits, kLengthDecimals, out);
  }
}

void AppendBinaryPose(const Pose& pose, std::string* out) {
  for (const double value : pose.qvec) AppendDouble(out, value);
  for (const double value : pose.tvec) AppendDouble(out, value);
}

void AppendTextSensor(const Sensor& sensor, std::string* out) {
  out->push_back(' ');
  out->append(EnumName(sensor.type)).push_back(' ');
  AppendUnsigned(sensor.id, out);
}

void AppendBinarySensor(const Sensor& sensor, std::string* out) {
  AppendBytes(out, static_cast<std::uint32_t>(sensor.type), 4);
  AppendBytes(out, sensor.id, 4);
}

std::uint32_t SensorCount(const Rig& rig) {
  return static_cast<std::uint32_t>(rig.sensors.size()) + (rig.ref_sensor ? 1U : 0U);
}

}  // namespace

void AppendTextCamera(const Camera& camera, std::string* out) {
  const CameraModelInfo* model = FindCameraModel(camera.model_id);
  AppendUnsigned(camera.id, out);
  out->push_back(' ');
  out->append(model == nullptr ? std::string_view("UNKNOWN") : model->name).push_back(' ');
  AppendUnsigned(camera.width, out);
  out->push_back(' ');
  AppendUnsigned(camera.height, out);
  for (const double param : camera.params) {
    out->push_back(' ');
    AppendExact(out, param);
  }
  out->push_back('\n');
}

void AppendTextImage(const Image& image, Digits digits, std::string* out) {
  AppendUnsigned(image.id, out);
  AppendTextPose(image.cam_from_world, digits, out);
  out->push_back(' ');
  AppendUnsigned(image.camera_id, out);
  out->push_back(' ');
  out->append(image.name).push_back('\n');
  bool first = true;
  for (const Point2D& point : image.points2D) {
    if (!first) out->push_back(' ');
    first = false;
    AppendNumber(point.x, digits, kPixelDecimals, out);
    out->push_back(' ');
    AppendNumber(point.y, digits, kPixelDecimals, out);
    out->push_back(' ');
    if (point.point3D_id == kNoPoint3D)
      out->append("-1");
    else
      AppendUnsigned(point.point3D_id, out);
  }
  out->push_back('\n');
}

void AppendTextPoint(const Point3D& point, std::span<const TrackElement> track, Digits digits, std::string* out) {
  AppendUnsigned(point.id, out);
  for (const double value : point.xyz) {
    out->push_back(' ');
    AppendNumber(value, digits, kLengthDecimals, out);
  }
  for (const std::uint8_t channel : point.rgb) {
    out->push_back(' ');
    AppendUnsigned(channel, out);
  }
  out->push_back(' ');
  AppendNumber(point.error, digits, kPixelDecimals, out);
  for (const TrackElement& element : track) {
    out->push_back(' ');
    AppendUnsigned(element.image_id, out);
    out->push_back(' ');
    AppendUnsigned(element.point2D_idx, out);
  }
  out->push_back('\n');
}

void AppendTextRig(const Rig& rig, std::string* out) {
  AppendUnsigned(rig.id, out);
  out->push_back(' ');
  AppendUnsigned(SensorCount(rig), out);
  if (rig.ref_sensor) AppendTextSensor(*rig.ref_sensor, out);
  for (const RigSensor& other : rig.sensors) {
    AppendTextSensor(other.sensor, out);
    out->append(other.sensor_from_rig ? " 1" : " 0");
    if (other.sensor_from_rig) AppendTextPose(*other.sensor_from_rig, Digits::kExact, out);
  }
  out->push_back('\n');
}

void AppendTextFrame(const Frame& frame, std::string* out) {
  AppendUnsigned(frame.id, out);
  out->push_back(' ');
  AppendUnsigned(frame.rig_id, out);
  AppendTextPose(frame.rig_from_world, Digits::kExact, out);
  out->push_back(' ');
  AppendUnsigned(frame.data.size(), out);
  for (const FrameData& data : frame.data) {
    AppendTextSensor(data.sensor, out);
    out->push_back(' ');
    AppendUnsigned(data.data_id, out);
  }
  out->push_back('\n');
}

void AppendBinaryCamera(const Camera& camera, std::string* out) {
  AppendBytes(out, camera.id, 4);
  AppendBytes(out, static_cast<std::uint32_t>(camera.model_id), 4);
  AppendBytes(out, camera.width, 8);
  AppendBytes(out, camera.height, 8);
  for (const double param : camera.params) AppendDouble(out, param);
}

void AppendBinaryImage(const Image& image, std::string* out) {
  AppendBytes(out, image.id, 4);
  AppendBinaryPose(image.cam_from_world, out);
  AppendBytes(out, image.camera_id, 4);
  out->append(image.name).push_back('\0');
  AppendBytes(out, image.points2D.size(), 8);
  for (const Point2D& point : image.points2D) {
    AppendDouble(out, point.x);
    AppendDouble(out, point.y);
    AppendBytes(out, point.point3D_id, 8);
  }
}

void AppendBinaryPoint(const Point3D& point, std::span<const TrackElement> track, std::string* out) {
  AppendBytes(out, point.id, 8);
  for (const double value : point.xyz) AppendDouble(out, value);
  for (const std::uint8_t channel : point.rgb) AppendBytes(out, channel, 1);
  AppendDouble(out, point.error);
  AppendBytes(out, track.size(), 8);
  for (const TrackElement& element : track) {
    AppendBytes(out, element.image_id, 4);
    AppendBytes(out, element.point2D_idx, 4);
  }
}

void AppendBinaryRig(const Rig& rig, std::string* out) {
  AppendBytes(out, rig.id, 4);
  AppendBytes(out, SensorCount(rig), 4);
  if (rig.ref_sensor) AppendBinarySensor(*rig.ref_sensor, out);
  for (const RigSensor& other : rig.sensors) {
    AppendBinarySensor(other.sensor, out);
    AppendBytes(out, other.sensor_from_rig ? 1 : 0, 1);
    if (other.sensor_from_rig) AppendBinaryPose(*other.sensor_from_rig, out);
  }
}

void AppendBinaryFrame(const Frame& frame, std::string* out) {
  AppendBytes(out, frame.id, 4);
  AppendBytes(out, frame.rig_id, 4);
  AppendBinaryPose(frame.rig_from_world, out);
  AppendBytes(out, frame.data.size(), 4);
  for (const FrameData& data : frame.data) {
    AppendBinarySensor(data.sensor, out);
    AppendBytes(out, data.data_id, 8);
  }
}

std::string CamerasHeader(std::uint64_t count) {
  return "# Camera list with one line of data per camera:\n#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n"
         "# Number of cameras: " +
         std::to_string(count);
}

std::string ImagesHeader(std::uint64_t count) {
  return "# Image list with two lines of data per image:\n"
         "#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n#   POINTS2D[] as (X, Y, POINT3D_ID)\n"
         "# Number of images: " +
         std::to_string(count);
}

std::string PointsHeader(std::uint64_t count) {
  return "# 3D point list with one line of data per point:\n"
         "#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n# Number of points: " +
         std::to_string(count);
}

std::string RigsHeader(std::uint64_t count) {
  return "# Rig calib list with one line of data per calib:\n"
         "#   RIG_ID, NUM_SENSORS, REF_SENSOR_TYPE, REF_SENSOR_ID, SENSORS[] as (SENSOR_TYPE, SENSOR_ID, HAS_POSE, "
         "[QW, QX, QY, QZ, TX, TY, TZ])\n# Number of rigs: " +
         std::to_string(count);
}

std::string FramesHeader(std::uint64_t count) {
  return "# Frame list with one line of data per frame:\n"
         "#   FRAME_ID, RIG_ID, RIG_FROM_WORLD[QW, QX, QY, QZ, TX, TY, TZ], NUM_DATA_IDS, DATA_IDS[] as "
         "(SENSOR_TYPE, SENSOR_ID, DATA_ID)\n# Number of frames: " +
         std::to_string(count);
}

}  // namespace pliant::colmap
