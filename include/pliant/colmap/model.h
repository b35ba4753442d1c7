// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// COLMAP's sparse models, as its files have them: cameras, images and points3D, text and binary, and since COLMAP 3.12
// rigs and frames. Everything keeps its order and its last bit, so that a model that COLMAP wrote is written again byte
// for byte.
//
// Frames are COLMAP's: poses are cam_from_world, quaternions w, x, y, z, and the first pixel has its CENTER AT
// (0.5, 0.5). pliant/colmap/convert.h, and nothing else, leads from here to Pliant's values.
// Source: colmap.github.io/format.html, and the files that COLMAP 3.8 writes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "pliant/base/job_progress.h"
#include "pliant/base/options.h"
#include "pliant/base/status.h"

namespace pliant::colmap {

// A camera model of COLMAP's; Pliant has the first six (CameraModelId).
struct CameraModelInfo {
  int id = 0;
  std::string_view name;
  int num_params = 0;
  int num_focal_lengths = 0;  // the first of the parameters; the principal point follows them
};

// Null where there is none.
const CameraModelInfo* FindCameraModel(int id);
const CameraModelInfo* FindCameraModel(std::string_view name);

struct Camera {
  std::uint32_t id = 0;
  int model_id = 0;
  std::uint64_t width = 0;
  std::uint64_t height = 0;
  std::vector<double> params;  // as many as the model has
};

struct Pose {
  std::array<double, 4> qvec{1, 0, 0, 0};  // w, x, y, z; not normalized when read
  std::array<double, 3> tvec{};
};

inline constexpr std::uint64_t kNoPoint3D = ~std::uint64_t{0};

struct Point2D {
  double x = 0;
  double y = 0;
  std::uint64_t point3D_id = kNoPoint3D;
};

struct Image {
  std::uint32_t id = 0;
  Pose cam_from_world;
  std::uint32_t camera_id = 0;
  std::string name;
  std::vector<Point2D> points2D;
};

struct TrackElement {
  std::uint32_t image_id = 0;
  std::uint32_t point2D_idx = 0;
};

struct Point3D {
  std::uint64_t id = 0;
  std::array<double, 3> xyz{};
  std::array<std::uint8_t, 3> rgb{};
  double error = -1;  // mean reprojection error, px; -1: unknown
  std::vector<TrackElement> track;
};

enum class SensorType : int { kInvalid = -1, kCamera = 0, kImu = 1 };

struct Sensor {
  SensorType type = SensorType::kCamera;
  std::uint32_t id = 0;
};

struct RigSensor {
  Sensor sensor;
  std::optional<Pose> sensor_from_rig;
};

struct Rig {
  std::uint32_t id = 0;
  std::optional<Sensor> ref_sensor;
  std::vector<RigSensor> sensors;  // the others
};

struct FrameData {
  Sensor sensor;
  std::uint64_t data_id = 0;
};

struct Frame {
  std::uint32_t id = 0;
  std::uint32_t rig_id = 0;
  Pose rig_from_world;
  std::vector<FrameData> data;
};

struct Model {
  std::vector<Camera> cameras;
  std::vector<Image> images;
  std::vector<Point3D> points3D;
  std::vector<Rig> rigs;      // none before 3.12
  std::vector<Frame> frames;  // none before 3.12
};

// Rows by their ids; they stay where they are.
template <class Row>
std::unordered_map<decltype(Row::id), const Row*> ById(const std::vector<Row>& rows) {
  std::unordered_map<decltype(Row::id), const Row*> by_id;
  for (const Row& row : rows) by_id.emplace(row.id, &row);
  return by_id;
}
using CamerasById = std::unordered_map<std::uint32_t, const Camera*>;
using ImagesById = std::unordered_map<std::uint32_t, const Image*>;
using PointsById = std::unordered_map<std::uint64_t, const Point3D*>;

enum class Format { kText, kBinary, kBoth };

// Whether images get their keypoints and points their tracks, which are most of a model.
enum class Observations { kRead, kSkipped };

// Whether a model's rigs and frames are written; COLMAP before 3.12 leaves them where they are and reads the rest.
enum class Rigs { kLeftOut, kWritten };

// The format of the model in a folder. COLMAP takes the binary files where all three are there, also when text files
// lie beside them: kBoth is a model that COLMAP reads as kBinary. Fails with kNotFound, naming the file that is
// missing.
Result<Format> FindModel(const std::string& folder);

// Reads a folder's model, by default in the format that COLMAP would take. Blanks may be repeated or tabs, lines may
// end with CR LF; numbers may be nan or inf (pliant/colmap/check.h finds them). Fails with kNotFound, or with
// kUnreadable for files that end too early, counts that cannot be, text that is not what it should be, an unknown
// camera model, a missing line of observations, or an id that is there twice; the sentence names the file, and the line
// in text.
// `progress` is told of the files (task "read"); kInterrupted where it asks to stop.
Result<Model> ReadModel(const std::string& folder, Observations observations = Observations::kRead,
                        const JobProgress& progress = {});
// `format` is kBinary or kText.
Result<Model> ReadModel(const std::string& folder, Format format, Observations observations = Observations::kRead,
                        const JobProgress& progress = {});

// cameras.txt or cameras.bin alone, told apart by the extension. Fails as above.
Result<std::vector<Camera>> ReadCameras(const std::string& path);

// Fails with kInvalidArgument if the folder has a model in another format than the one to be written, which COLMAP
// could read instead of it, or rigs and frames that would stay.
Status CheckFolder(const std::string& folder, Format format, Rigs rigs = Rigs::kLeftOut);

// Writes a model as COLMAP does, into a folder that is made if need be. All of its files appear at the end, or none.
// Fails as CheckFolder does, with kInvalidArgument for a name that the format cannot hold, with kUnwritable, and with
// kInterrupted where `progress`, which is told of the images and points of each file (task "write"), asks to stop.
Status WriteModel(const std::string& folder, const Model& model, Format format, Rigs rigs = Rigs::kLeftOut,
                  const JobProgress& progress = {});

}  // namespace pliant::colmap

namespace pliant {

template <>
struct EnumNames<colmap::Format> {
  static constexpr std::array kNames = {std::pair{colmap::Format::kText, std::string_view("text")},
                                        std::pair{colmap::Format::kBinary, std::string_view("binary")},
                                        std::pair{colmap::Format::kBoth, std::string_view("both")}};
};

template <>
struct EnumNames<colmap::SensorType> {
  static constexpr std::array kNames = {std::pair{colmap::SensorType::kInvalid, std::string_view("INVALID")},
                                        std::pair{colmap::SensorType::kCamera, std::string_view("CAMERA")},
                                        std::pair{colmap::SensorType::kImu, std::string_view("IMU")}};
};

}  // namespace pliant
