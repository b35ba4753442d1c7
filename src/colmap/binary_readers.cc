// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>

#include "colmap/readers.h"
#include "pliant/base/files.h"
#include "pliant/base/text.h"

namespace pliant::colmap {
namespace {

constexpr std::size_t kBufferBytes = 1 << 20;
// A name is a path.
constexpr std::size_t kLongestName = 1 << 16;

// Takes little-endian numbers off a file; once there are too few bytes every further one is 0.
class BinaryReader {
 public:
  static Result<BinaryReader> Open(const std::string& path) {
    // Checks that it is there and a file.
    if (const auto checked = LineReader::Open(path); !checked.ok()) return checked.status();
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    std::ifstream stream(path, std::ios::binary);
    if (error || !stream) return Status(ErrorCode::kUnreadable, "cannot read " + Quoted(path));
    return BinaryReader(path, std::move(stream), size);
  }

  std::uint64_t Take(std::size_t num_bytes) {
    std::array<unsigned char, 8> bytes{};
    TakeBytes(bytes.data(), num_bytes);
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < num_bytes; ++i) value |= static_cast<std::uint64_t>(bytes[i]) << (8 * i);
    return value;
  }
  std::uint32_t Take32() { return static_cast<std::uint32_t>(Take(4)); }
  double TakeDouble() { return std::bit_cast<double>(Take(8)); }
  Pose TakePose() {
    Pose pose;
    for (double& value : pose.qvec) value = TakeDouble();
    for (double& value : pose.tvec) value = TakeDouble();
    return pose;
  }
  Sensor TakeSensor() {
    Sensor sensor;
    const auto type = static_cast<std::int32_t>(Take32());
    if (type < static_cast<int>(SensorType::kInvalid) || type > static_cast<int>(SensorType::kImu))
      Fail("its sensor type " + std::to_string(type) + " is not one of COLMAP's");
    sensor.type = static_cast<SensorType>(type);
    sensor.id = Take32();
    return sensor;
  }
  std::string TakeName() {
    std::string name;
    while (ok()) {
      const auto c = static_cast<char>(Take(1));
      if (c == '\0') break;
      name.push_back(c);
      if (name.size() > kLongestName) Fail("an image's name does not end");
    }
    return name;
  }
  // A count of things that have so many bytes each: one that the rest of the file cannot hold is a lie.
  std::uint64_t TakeCount(std::size_t num_bytes, std::size_t least_bytes_each, std::string_view what) {
    const std::uint64_t count = Take(num_bytes);
    if (ok() && count > remaining_ / least_bytes_each)
      Fail("it says that there are " + std::to_string(count) + " " + std::string(what) + ", but has only " +
           std::to_string(remaining_) + " more bytes");
    return ok() ? count : 0;
  }

  void Skip(std::uint64_t num_bytes) {
    if (!ok()) return;
    if (remaining_ < num_bytes) return Fail("it ends too early");
    remaining_ -= num_bytes;
    const std::uint64_t buffered = std::min<std::uint64_t>(num_bytes, buffer_.size() - position_);
    position_ += static_cast<std::size_t>(buffered);
    stream_.seekg(static_cast<std::streamoff>(num_bytes - buffered), std::ios::cur);
  }

  bool ok() const { return error_.empty(); }
  std::uint64_t remaining() const { return remaining_; }
  void Fail(std::string error) {
    if (ok()) error_ = std::move(error);
  }
  Status status() const { return {ErrorCode::kUnreadable, Quoted(path_) + " is damaged: " + error_}; }

 private:
  BinaryReader(std::string path, std::ifstream stream, std::uint64_t size)
      : path_(std::move(path)), stream_(std::move(stream)), remaining_(size) {}

  void TakeBytes(unsigned char* bytes, std::size_t count) {
    if (!ok()) return;
    if (remaining_ < count) return Fail("it ends too early");
    if (buffer_.size() - position_ < count && !Fill()) return Fail("it cannot be read to its end");
    std::memcpy(bytes, buffer_.data() + position_, count);
    position_ += count;
    remaining_ -= count;
  }
  // The bytes that are left, and then as many as there is room for.
  bool Fill() {
    buffer_.erase(0, position_);
    position_ = 0;
    const std::size_t had = buffer_.size();
    buffer_.resize(had + static_cast<std::size_t>(std::min<std::uint64_t>(kBufferBytes, remaining_ - had)));
    stream_.read(buffer_.data() + had, static_cast<std::streamsize>(buffer_.size() - had));
    return static_cast<bool>(stream_);
  }

  std::string path_;
  std::ifstream stream_;
  std::string buffer_;
  std::size_t position_ = 0;
  std::uint64_t remaining_;
  std::string error_;
};

// `take(reader, row)` for each of the rows, of at least so many bytes.
template <class Row, class TakeRow>
Result<std::vector<Row>> ReadRows(const std::string& path, std::size_t least_bytes, std::string_view what,
                                  const TakeRow& take) {
  auto reader = BinaryReader::Open(path);
  if (!reader.ok()) return reader.status();
  const std::uint64_t count = reader->TakeCount(8, least_bytes, what);
  std::vector<Row> rows;
  for (std::uint64_t i = 0; i < count && reader->ok(); ++i) take(*reader, &rows.emplace_back());
  if (reader->ok() && reader->remaining() > 0)
    reader->Fail(std::to_string(reader->remaining()) + " bytes follow the last of its " + std::to_string(count) + " " +
                 std::string(what));
  if (!reader->ok()) return reader->status();
  return rows;
}

constexpr std::size_t kPoseBytes = 7 * 8;
constexpr std::size_t kSensorBytes = 8;

}  // namespace

Result<std::vector<Camera>> ReadBinaryCameras(const std::string& path) {
  return ReadRows<Camera>(path, 4 + 4 + 8 + 8 + 3 * 8, "cameras", [](BinaryReader& reader, Camera* camera) {
    camera->id = reader.Take32();
    camera->model_id = static_cast<std::int32_t>(reader.Take32());
    camera->width = reader.Take(8);
    camera->height = reader.Take(8);
    const CameraModelInfo* model = FindCameraModel(camera->model_id);
    if (model == nullptr) return reader.Fail(UnknownCameraModel(std::to_string(camera->model_id)));
    for (int i = 0; i < model->num_params; ++i) camera->params.push_back(reader.TakeDouble());
  });
}

Result<std::vector<Image>> ReadBinaryImages(const std::string& path, Observations observations) {
  return ReadRows<Image>(path, 4 + kPoseBytes + 4 + 1 + 8, "images",
                         [observations](BinaryReader& reader, Image* image) {
                           image->id = reader.Take32();
                           image->cam_from_world = reader.TakePose();
                           image->camera_id = reader.Take32();
                           image->name = reader.TakeName();
                           const std::uint64_t count = reader.TakeCount(8, 3 * 8, "observations");
                           if (observations == Observations::kSkipped) return reader.Skip(count * 3 * 8);
                           image->points2D.resize(count);
                           for (Point2D& point : image->points2D) {
                             point.x = reader.TakeDouble();
                             point.y = reader.TakeDouble();
                             point.point3D_id = reader.Take(8);
                           }
                         });
}

Result<std::vector<Point3D>> ReadBinaryPoints(const std::string& path, Observations observations) {
  return ReadRows<Point3D>(path, 8 + 3 * 8 + 3 + 8 + 8, "points", [observations](BinaryReader& reader, Point3D* point) {
    point->id = reader.Take(8);
    for (double& value : point->xyz) value = reader.TakeDouble();
    for (std::uint8_t& channel : point->rgb) channel = static_cast<std::uint8_t>(reader.Take(1));
    point->error = reader.TakeDouble();
    const std::uint64_t length = reader.TakeCount(8, 8, "track elements");
    if (observations == Observations::kSkipped) return reader.Skip(length * 8);
    point->track.resize(length);
    for (TrackElement& element : point->track) {
      element.image_id = reader.Take32();
      element.point2D_idx = reader.Take32();
    }
  });
}

Result<std::vector<Rig>> ReadBinaryRigs(const std::string& path) {
  return ReadRows<Rig>(path, 4 + 4, "rigs", [](BinaryReader& reader, Rig* rig) {
    rig->id = reader.Take32();
    const std::uint64_t count = reader.TakeCount(4, kSensorBytes, "sensors");
    if (count > 0) rig->ref_sensor = reader.TakeSensor();
    for (std::uint64_t i = 1; i < count && reader.ok(); ++i) {
      RigSensor& other = rig->sensors.emplace_back();
      other.sensor = reader.TakeSensor();
      if (reader.Take(1) != 0) other.sensor_from_rig = reader.TakePose();
    }
  });
}

Result<std::vector<Frame>> ReadBinaryFrames(const std::string& path) {
  return ReadRows<Frame>(path, 4 + 4 + kPoseBytes + 4, "frames", [](BinaryReader& reader, Frame* frame) {
    frame->id = reader.Take32();
    frame->rig_id = reader.Take32();
    frame->rig_from_world = reader.TakePose();
    const std::uint64_t count = reader.TakeCount(4, kSensorBytes + 8, "data ids");
    for (std::uint64_t i = 0; i < count && reader.ok(); ++i) {
      const Sensor sensor = reader.TakeSensor();
      frame->data.push_back({sensor, reader.Take(8)});
    }
  });
}

}  // namespace pliant::colmap
