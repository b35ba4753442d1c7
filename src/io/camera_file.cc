// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/io/camera_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <span>

#include <opencv2/core.hpp>

#include "io/opencv_calibration.h"
#include "io/yaml.h"
#include "pliant/base/files.h"
#include "pliant/base/text.h"
#include "pliant/colmap/convert.h"

namespace pliant {
namespace {

const std::vector<std::string> kKeys = {"model",    "width", "height", "params",     "fps",          "depth_scale",
                                        "baseline", "unit",  "gamma",  "vignetting", "light_spread", "light_axis"};

bool ParseYamlNumber(const YAML::Node& node, double* value) {
  if (!node.IsScalar()) return false;
  try {
    *value = node.as<double>();  // also .nan and .inf
    return true;
  } catch (const YAML::Exception&) {
    return false;
  }
}

// One of camera.yaml's numbers.
struct NumberField {
  const char* name;
  double value = 0;
  bool given = false;
};

Status ReadNumber(const std::string& path, const YAML::Node& root, NumberField* field) {
  const YAML::Node node = root[field->name];
  if (!node) return Status::Ok();
  field->given = true;
  if (!ParseYamlNumber(node, &field->value) || !std::isfinite(field->value))
    return {ErrorCode::kInvalidArgument, PathAndLine(path, node) + ": " + field->name + " is not a finite number"};
  return Status::Ok();
}

Result<std::vector<double>> Numbers(const std::string& path, const YAML::Node& node, const std::string& name,
                                    const std::string& example) {
  const Status invalid(ErrorCode::kInvalidArgument,
                       PathAndLine(path, node) + ": " + name + " must be a list of numbers, such as " + example);
  if (!node.IsSequence()) return invalid;
  std::vector<double> numbers;
  for (const YAML::Node& entry : node) {
    numbers.emplace_back();
    if (!ParseYamlNumber(entry, &numbers.back())) return invalid;
  }
  return numbers;
}

// Nothing where the file says nothing of it.
Result<std::optional<PhotometricCalibration>> Photometric(const std::string& path, const YAML::Node& root) {
  NumberField gamma{"gamma"};
  NumberField vignetting{"vignetting"};
  NumberField light_spread{"light_spread"};
  for (NumberField* field : {&gamma, &vignetting, &light_spread})
    if (Status status = ReadNumber(path, root, field); !status.ok()) return status;
  const YAML::Node axis = root["light_axis"];
  if (!gamma.given && !vignetting.given && !light_spread.given && !axis) return std::optional<PhotometricCalibration>();
  if (!gamma.given)
    return Status(ErrorCode::kInvalidArgument, Quoted(path) + ": gamma is missing; a photometric calibration needs it");
  PhotometricCalibration calibration;
  calibration.gamma = gamma.value;
  calibration.vignetting = vignetting.value;
  calibration.light_spread = light_spread.value;
  if (axis) {
    const auto numbers = Numbers(path, axis, "light_axis", "[0, 0, 1]");
    if (!numbers.ok()) return numbers.status();
    calibration.light_axis =
        numbers->size() == 3 ? Eigen::Vector3d((*numbers)[0], (*numbers)[1], (*numbers)[2]) : Eigen::Vector3d::Zero();
  }
  if (Status status = CheckPhotometric(calibration); !status.ok())
    return Status(status.code(), Quoted(path) + ": " + status.message());
  return std::optional(calibration);
}

Result<CameraFile> FromPliant(const std::string& path, const YAML::Node& root) {
  const auto invalid = [](const std::string& where, const std::string& what) {
    return Status(ErrorCode::kInvalidArgument, where + ": " + what);
  };
  for (const auto& entry : root) {
    const std::string key = KeyText(entry.first);
    if (std::find(kKeys.begin(), kKeys.end(), key) == kKeys.end())
      return invalid(PathAndLine(path, entry.first), "there is no entry " + Quoted(key) +
                                                         " in a camera.yaml; did you mean " +
                                                         Quoted(NearestName(key, kKeys)) + "?");
  }
  for (const char* key : {"model", "width", "height", "params"})
    if (!root[key])
      return invalid(Quoted(path), std::string(key) + " is missing; a camera needs model, width, height, params");

  NumberField width{"width"};
  NumberField height{"height"};
  NumberField fps{"fps"};
  NumberField depth_scale{"depth_scale"};
  NumberField baseline{"baseline"};
  for (NumberField* field : {&width, &height, &fps, &depth_scale, &baseline})
    if (const Status status = ReadNumber(path, root, field); !status.ok()) return status;
  for (const NumberField* field : {&width, &height})
    if (field->value != std::floor(field->value) || std::abs(field->value) > 1e6)
      return invalid(Quoted(path), std::string(field->name) + " must be a whole number of pixels");
  if (fps.given)
    if (const Status status = CheckFps(fps.value); !status.ok()) return invalid(Quoted(path), status.message());
  if (depth_scale.given && !(depth_scale.value > 0.0)) return invalid(Quoted(path), "depth_scale must be positive");

  double unit_mm = 1.0;
  if (const YAML::Node unit = root["unit"]; unit) {
    if (!unit.IsScalar() || (unit.Scalar() != "mm" && unit.Scalar() != "m"))
      return invalid(PathAndLine(path, unit),
                     "unit must be mm or m; scale depth_scale, baseline and groundtruth.txt to one of them");
    unit_mm = unit.Scalar() == "m" ? 1000.0 : 1.0;
  }

  const auto photometric = Photometric(path, root);
  if (!photometric.ok()) return photometric.status();
  const auto params = Numbers(path, root["params"], "params", "[fx, fy, cx, cy]");
  if (!params.ok()) return params.status();
  if (!root["model"].IsScalar())
    return invalid(PathAndLine(path, root["model"]), "model must be a name, such as PINHOLE");
  auto camera =
      Camera::Create(root["model"].Scalar(), static_cast<int>(width.value), static_cast<int>(height.value), *params);
  if (!camera.ok()) return invalid(Quoted(path), camera.status().message());
  CameraFile file{std::move(camera).value()};
  if (fps.given) file.fps = fps.value;
  if (depth_scale.given) file.depth_scale = unit_mm * depth_scale.value;
  if (baseline.given) file.baseline_mm = unit_mm * baseline.value;
  file.unit_mm = unit_mm;
  file.photometric = *photometric;
  return file;
}

void AppendNumbers(const YAML::Node& node, std::vector<double>* numbers) {
  if (node.IsMap() && node["data"]) return AppendNumbers(node["data"], numbers);
  if (node.IsSequence()) {
    for (const YAML::Node& entry : node) AppendNumbers(entry, numbers);
  } else if (double value = 0; ParseYamlNumber(node, &value)) {
    numbers->push_back(value);
  }
}

CalibrationEntries EntriesOf(const YAML::Node& root) {
  return {[root](std::string_view name) {
            std::vector<double> numbers;
            if (const YAML::Node node = root[std::string(name)]) AppendNumbers(node, &numbers);
            return numbers;
          },
          [root](std::string_view name) {
            const YAML::Node node = root[std::string(name)];
            return node && node.IsScalar() ? node.Scalar() : std::string();
          }};
}

void AppendNumbers(const cv::FileNode& node, std::vector<double>* numbers) {
  if (node.isReal() || node.isInt()) {
    numbers->push_back(node.real());
  } else if (node.isSeq()) {
    for (const cv::FileNode& entry : node) AppendNumbers(entry, numbers);
  } else if (node.isMap() && !node["data"].empty()) {
    AppendNumbers(node["data"], numbers);
  }
}

CalibrationEntries EntriesOf(const cv::FileStorage& storage) {
  return {[&storage](std::string_view name) {
            std::vector<double> numbers;
            AppendNumbers(storage[std::string(name)], &numbers);
            return numbers;
          },
          [&storage](std::string_view name) {
            const cv::FileNode node = storage[std::string(name)];
            return node.isString() ? node.string() : std::string();
          }};
}

Result<CameraFile> FromOpenCv(const std::string& path, const CalibrationEntries& entries,
                              const CameraFileOptions& options) {
  if (!HasCameraMatrix(entries))
    return Status(ErrorCode::kUnreadable,
                  Quoted(path) +
                      " holds no camera: neither model and params, nor a camera matrix (M1, K, camera_matrix, "
                      "cameraMatrix)");
  auto file = CameraFromOpenCv(entries, options);
  if (!file.ok()) return Status(file.status().code(), Quoted(path) + ": " + file.status().message());
  return file;
}

// A file's entries, and what they lie in.
struct CalibrationText {
  std::string text;
  bool is_xml = false;
};

Result<CalibrationText> ReadText(const std::string& path) {
  auto text = ReadFile(path);
  if (!text.ok()) return text.status();
  const std::size_t first = text->find_first_not_of(" \t\r\n");
  if (first == std::string::npos) return Status(ErrorCode::kUnreadable, Quoted(path) + " is empty; give a calibration");
  if (text->find('\0') != std::string::npos)
    return Status(ErrorCode::kUnreadable, Quoted(path) + " is a binary file; COLMAP's cameras end in .bin");
  const bool is_xml = (*text)[first] == '<';
  // OpenCV writes a first line that YAML does not allow; a comment keeps the line numbers.
  if (text->starts_with("%YAML")) (*text)[0] = '#';
  return CalibrationText{*std::move(text), is_xml};
}

// What `read` makes of an OpenCV file's entries.
template <class Read>
auto FromXml(const std::string& path, const std::string& text, const Read& read)
    -> decltype(read(CalibrationEntries())) {
  try {
    const cv::FileStorage storage(text, cv::FileStorage::READ | cv::FileStorage::MEMORY | cv::FileStorage::FORMAT_XML);
    return read(EntriesOf(storage));
  } catch (const cv::Exception& error) {
    return Status(ErrorCode::kUnreadable, Quoted(path) + " is not an OpenCV calibration: " + error.err);
  }
}

bool IsPliants(const YAML::Node& root) {
  return root.IsMap() && (root["params"] || (root["model"] && !HasCameraMatrix(EntriesOf(root))));
}

bool IsColmaps(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension();
  return extension == ".bin" || extension == ".txt";
}

}  // namespace

std::optional<ImageSize> ToImageSize(double width, double height) {
  constexpr double kMaxSide_px = 1e6;
  const auto is_side = [](double side) { return side >= 1 && side <= kMaxSide_px && side == std::floor(side); };
  if (!is_side(width) || !is_side(height)) return std::nullopt;
  return ImageSize{static_cast<int>(width), static_cast<int>(height)};
}

Result<CameraFile> ReadCameraFile(const std::string& path, const CameraFileOptions& options) {
  if (IsColmaps(path)) {
    auto camera = colmap::ReadCamera(path, options.camera_id);
    if (!camera.ok()) return camera.status();
    return CameraFile{std::move(camera).value()};
  }
  const auto file = ReadText(path);
  if (!file.ok()) return file.status();
  const auto read = [&](const CalibrationEntries& entries) { return FromOpenCv(path, entries, options); };
  if (file->is_xml) return FromXml(path, file->text, read);
  const auto root = ParseYamlMap(path, file->text);
  if (!root.ok()) return root.status();
  return IsPliants(*root) ? FromPliant(path, *root) : read(EntriesOf(*root));
}

Result<std::optional<StereoCalibration>> ReadStereoCalibration(const std::string& path) {
  if (IsColmaps(path)) return std::optional<StereoCalibration>();
  const auto file = ReadText(path);
  if (!file.ok()) return file.status();
  const auto read = [&](const CalibrationEntries& entries) {
    auto pair = StereoFromOpenCv(entries);
    if (!pair.ok())
      return Result<std::optional<StereoCalibration>>(
          Status(pair.status().code(), Quoted(path) + ": " + pair.status().message()));
    return pair;
  };
  if (file->is_xml) return FromXml(path, file->text, read);
  const auto root = ParseYamlMap(path, file->text);
  if (!root.ok()) return root.status();
  if (IsPliants(*root)) return std::optional<StereoCalibration>();
  return read(EntriesOf(*root));
}

Result<Camera> ReadCamera(const std::string& path, const CameraFileOptions& options) {
  auto file = ReadCameraFile(path, options);
  if (!file.ok()) return file.status();
  return std::move(file->camera);
}

Status CheckFps(double fps) {
  constexpr double kFewest = 1e-3;
  constexpr double kMost = 1e5;  // the steps of times are ten of the last decimal of trajectory.txt
  if (fps >= kFewest && fps <= kMost) return Status::Ok();
  return {ErrorCode::kInvalidArgument, "fps is " + FormatDouble(fps) + "; give frames a second, from 0.001 to 100000"};
}

Status WriteCameraFile(const std::string& path, const CameraFile& file, LengthUnit unit) {
  const std::string name = unit == LengthUnit::kMillimeters ? "mm" : "map units";
  std::string text = "model: " + std::string(file.camera.model_name()) +
                     "\nwidth: " + std::to_string(file.camera.width()) +
                     "\nheight: " + std::to_string(file.camera.height()) + "\nparams: [" +
                     CommaSeparated(file.camera.params(), FormatDouble) + "]\n";
  if (file.fps) text += "fps: " + FormatDouble(*file.fps) + "\n";
  if (file.depth_scale) text += "depth_scale: " + FormatDouble(*file.depth_scale) + "  # " + name + " per step\n";
  if (file.baseline_mm) text += "baseline: " + FormatDouble(*file.baseline_mm) + "  # " + name + "\n";
  if (const auto& light = file.photometric) {
    text += "gamma: " + FormatDouble(light->gamma) + "\nvignetting: " + FormatDouble(light->vignetting) +
            "\nlight_spread: " + FormatDouble(light->light_spread) + "\nlight_axis: [" +
            CommaSeparated(light->light_axis, FormatDouble) + "]\n";
  }
  if (unit == LengthUnit::kMillimeters) text += "unit: mm\n";
  return WriteFileAtomically(path, text);
}

namespace {

std::string OpenCvMatrix(std::string_view name, int rows, int cols, std::span<const double> values) {
  return std::string(name) + ": !!opencv-matrix\n   rows: " + std::to_string(rows) +
         "\n   cols: " + std::to_string(cols) + "\n   dt: d\n   data: [ " + CommaSeparated(values, FormatDouble) +
         " ]\n";
}

std::string OpenCvEye(const std::string& number, const StereoCalibration::Eye& eye) {
  return OpenCvMatrix("M" + number, 3, 3, std::array{eye.fx, 0.0, eye.cx, 0.0, eye.fy, eye.cy, 0.0, 0.0, 1.0}) +
         OpenCvMatrix("D" + number, 1, static_cast<int>(eye.distortion.size()), eye.distortion);
}

}  // namespace

Status WriteStereoCalibration(const std::string& path, const StereoCalibration& calibration) {
  std::string text = "%YAML:1.0\n---\n";
  if (calibration.image_size)
    text += "image_width: " + std::to_string(calibration.image_size->width) +
            "\nimage_height: " + std::to_string(calibration.image_size->height) + "\n";
  text += OpenCvEye("1", calibration.left) + OpenCvEye("2", calibration.right);
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rotation = calibration.right_from_left.RotationMatrix();
  text += OpenCvMatrix("R", 3, 3, {rotation.data(), 9});
  text += OpenCvMatrix("T", 3, 1, {calibration.right_from_left.translation.data(), 3});
  return WriteFileAtomically(path, text);
}

}  // namespace pliant
