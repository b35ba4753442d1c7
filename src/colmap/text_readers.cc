// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <array>
#include <limits>
#include <utility>

#include "colmap/readers.h"
#include "pliant/base/files.h"
#include "pliant/base/options.h"
#include "pliant/base/text.h"

namespace pliant::colmap {
namespace {

// Takes the fields of a line one after the other; the first that is not what it should be makes `error`.
class Fields {
 public:
  explicit Fields(std::string_view line) : rest_(line) { Trim(); }

  bool empty() const { return rest_.empty(); }
  const std::string& error() const { return error_; }
  void Fail(std::string error) {
    if (error_.empty()) error_ = std::move(error);
  }

  std::string_view Word(std::string_view what) {
    if (rest_.empty()) {
      Fail("there is no " + std::string(what) + "; the line is cut off, or a number is missing");
      return {};
    }
    const std::size_t end = std::min(rest_.find_first_of(" \t"), rest_.size());
    const std::string_view word = rest_.substr(0, end);
    rest_.remove_prefix(end);
    Trim();
    return word;
  }
  // All that is left: a name may have blanks.
  std::string_view Rest() { return std::exchange(rest_, {}); }
  double Number(std::string_view what) {
    const std::string_view word = Word(what);
    double value = 0;
    if (error_.empty() && !ParseDouble(word, &value))
      Fail(Quoted(word) + " is not a number (" + std::string(what) + ")");
    return value;
  }
  std::uint64_t Integer(std::string_view what, std::uint64_t most = std::numeric_limits<std::uint64_t>::max()) {
    const std::string_view word = Word(what);
    std::uint64_t value = 0;
    if (error_.empty() && (!ParseUint64(word, &value) || value > most))
      Fail(Quoted(word) + " is no " + std::string(what));
    return value;
  }
  std::uint32_t Id(std::string_view what) {
    return static_cast<std::uint32_t>(Integer(what, std::numeric_limits<std::uint32_t>::max()));
  }
  Pose TakePose() {
    static constexpr std::array<std::string_view, 4> kRotation = {"QW", "QX", "QY", "QZ"};
    static constexpr std::array<std::string_view, 3> kTranslation = {"TX", "TY", "TZ"};
    Pose pose;
    for (std::size_t i = 0; i < 4; ++i) pose.qvec[i] = Number(kRotation[i]);
    for (std::size_t i = 0; i < 3; ++i) pose.tvec[i] = Number(kTranslation[i]);
    return pose;
  }
  Sensor TakeSensor() {
    Sensor sensor;
    const std::string_view type = Word("SENSOR_TYPE");
    bool known = false;
    for (const auto& [value, name] : EnumNames<SensorType>::kNames) {
      if (name != type) continue;
      sensor.type = value;
      known = true;
    }
    if (!known) Fail(Quoted(type) + " is not a SENSOR_TYPE (CAMERA or IMU)");
    sensor.id = Id("SENSOR_ID");
    return sensor;
  }

 private:
  void Trim() { rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t"), rest_.size())); }

  std::string_view rest_;
  std::string error_;
};

std::string_view WithoutBlanksBehind(std::string_view line) {
  const std::size_t last = line.find_last_not_of(" \t\r");
  return line.substr(0, last == std::string_view::npos ? 0 : last + 1);
}

// The next line that is neither empty nor a comment; false at the end.
bool NextRow(LineReader& reader, std::string_view* line) {
  while (reader.Next(line)) {
    *line = WithoutBlanksBehind(*line);
    const std::size_t first = line->find_first_not_of(" \t");
    if (first != std::string_view::npos && (*line)[first] != '#') return true;
  }
  return false;
}

// One row a line; `parse(fields, row)`.
template <class Row, class Parse>
Result<std::vector<Row>> ReadRows(const std::string& path, const Parse& parse) {
  auto reader = LineReader::Open(path);
  if (!reader.ok()) return reader.status();
  std::vector<Row> rows;
  for (std::string_view line; NextRow(*reader, &line);) {
    Fields fields(line);
    rows.emplace_back();
    parse(fields, &rows.back());
    if (fields.error().empty() && !fields.empty()) fields.Fail("there is more on the line than there should be");
    if (!fields.error().empty()) return reader->Error(fields.error());
  }
  if (Status status = reader->End(); !status.ok()) return status;
  return rows;
}

void ParseKeypoints(Fields& fields, std::vector<Point2D>* points) {
  while (!fields.empty() && fields.error().empty()) {
    Point2D& point = points->emplace_back();
    point.x = fields.Number("X");
    point.y = fields.Number("Y");
    const std::string_view id = fields.Word("POINT3D_ID");
    if (id != "-1" && !ParseUint64(id, &point.point3D_id)) fields.Fail(Quoted(id) + " is not a POINT3D_ID");
  }
}

}  // namespace

Result<std::vector<Camera>> ReadTextCameras(const std::string& path) {
  return ReadRows<Camera>(path, [](Fields& fields, Camera* camera) {
    camera->id = fields.Id("CAMERA_ID");
    const std::string_view name = fields.Word("MODEL");
    const CameraModelInfo* model = FindCameraModel(name);
    if (model == nullptr) {
      fields.Fail(UnknownCameraModel(name));
      return;
    }
    camera->model_id = model->id;
    camera->width = fields.Integer("WIDTH");
    camera->height = fields.Integer("HEIGHT");
    for (int i = 0; i < model->num_params; ++i)
      camera->params.push_back(fields.Number("parameter " + std::to_string(i + 1) + " of " + std::string(name) + "'s " +
                                             std::to_string(model->num_params)));
  });
}

Result<std::vector<Image>> ReadTextImages(const std::string& path, Observations observations) {
  auto reader = LineReader::Open(path);
  if (!reader.ok()) return reader.status();
  std::vector<Image> images;
  for (std::string_view line; NextRow(*reader, &line);) {
    Fields fields(line);
    Image& image = images.emplace_back();
    image.id = fields.Id("IMAGE_ID");
    image.cam_from_world = fields.TakePose();
    image.camera_id = fields.Id("CAMERA_ID");
    if (fields.empty()) fields.Fail("there is no NAME");
    image.name = fields.Rest();
    if (!fields.error().empty()) return reader->Error(fields.error());
    if (!reader->Next(&line))
      return reader->Error("the line with the observations of image " + std::to_string(image.id) +
                           " is missing (it may be empty, but must be there)");
    if (observations == Observations::kSkipped) continue;
    Fields keypoints(WithoutBlanksBehind(line));
    ParseKeypoints(keypoints, &image.points2D);
    if (!keypoints.error().empty())
      return reader->Error(keypoints.error() + "; the line should have the observations of image " +
                           std::to_string(image.id) + ", X Y POINT3D_ID each. Is it missing?");
  }
  if (Status status = reader->End(); !status.ok()) return status;
  return images;
}

Result<std::vector<Point3D>> ReadTextPoints(const std::string& path, Observations observations) {
  return ReadRows<Point3D>(path, [observations](Fields& fields, Point3D* point) {
    point->id = fields.Integer("POINT3D_ID");
    point->xyz = {fields.Number("X"), fields.Number("Y"), fields.Number("Z")};
    for (std::uint8_t& channel : point->rgb) channel = static_cast<std::uint8_t>(fields.Integer("color (0-255)", 255));
    point->error = fields.Number("ERROR");
    if (observations == Observations::kSkipped) fields.Rest();
    while (!fields.empty() && fields.error().empty()) {
      const std::uint32_t image_id = fields.Id("IMAGE_ID");
      point->track.push_back({image_id, fields.Id("POINT2D_IDX")});
    }
  });
}

Result<std::vector<Rig>> ReadTextRigs(const std::string& path) {
  return ReadRows<Rig>(path, [](Fields& fields, Rig* rig) {
    rig->id = fields.Id("RIG_ID");
    const std::uint32_t count = fields.Id("NUM_SENSORS");
    if (count > 0) rig->ref_sensor = fields.TakeSensor();
    for (std::uint32_t i = 1; i < count && fields.error().empty(); ++i) {
      RigSensor& other = rig->sensors.emplace_back();
      other.sensor = fields.TakeSensor();
      if (fields.Integer("HAS_POSE (0 or 1)", 1) == 1) other.sensor_from_rig = fields.TakePose();
    }
  });
}

Result<std::vector<Frame>> ReadTextFrames(const std::string& path) {
  return ReadRows<Frame>(path, [](Fields& fields, Frame* frame) {
    frame->id = fields.Id("FRAME_ID");
    frame->rig_id = fields.Id("RIG_ID");
    frame->rig_from_world = fields.TakePose();
    const std::uint32_t count = fields.Id("NUM_DATA_IDS");
    for (std::uint32_t i = 0; i < count && fields.error().empty(); ++i) {
      const Sensor sensor = fields.TakeSensor();
      frame->data.push_back({sensor, fields.Integer("DATA_ID")});
    }
  });
}

}  // namespace pliant::colmap
