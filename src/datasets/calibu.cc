// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pugixml.hpp>

#include "datasets/calibration_files.h"
#include "datasets/set_files.h"
#include "pliant/base/files.h"
#include "pliant/base/options.h"
#include "pliant/base/text.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// None where something else is among them.
std::vector<double> NumbersOf(const pugi::xml_node& parent, const char* name) {
  return ParseNumbers(parent.child_value(name)).value_or(std::vector<double>());
}

// The first element of this name; empty where there is none.
pugi::xml_node FindElement(const pugi::xml_document& document, std::string_view name) {
  return document.find_node([&](const pugi::xml_node& node) { return node.name() == name; });
}

// An XML file, perhaps with a camera model.
struct Calibration {
  pugi::xml_document document;
  pugi::xml_node camera;
};
Result<Calibration> ReadCalibration(const fs::path& file) {
  const auto text = ReadFile(file.string());
  if (!text.ok()) return text.status();
  Calibration calibration;
  if (const auto parsed = calibration.document.load_buffer(text->data(), text->size()); !parsed)
    return Status(ErrorCode::kUnreadable, file.string() + " is no XML: " + parsed.description());
  calibration.camera = FindElement(calibration.document, "camera_model");
  return calibration;
}

// Calibu's <camera_model type=...> with <width>, <height>, <params> [ fu; fv; u0; v0; ... ].
Result<Camera> GeometryOf(const fs::path& file, const pugi::xml_node& model_of_camera) {
  const std::vector<double> width = NumbersOf(model_of_camera, "width");
  const std::vector<double> height = NumbersOf(model_of_camera, "height");
  const auto size = width.size() == 1 && height.size() == 1 ? ToImageSize(width[0], height[0]) : std::nullopt;
  if (!size)
    return Status(ErrorCode::kUnreadable,
                  file.string() + " is not a calibration of calibu: its camera_model has no width and height");
  const std::string type = model_of_camera.attribute("type").value();
  if (type != "calibu_fu_fv_u0_v0" && type != "calibu_fu_fv_u0_v0_kb4")
    return Status(ErrorCode::kInvalidArgument, file.string() + " has a camera of the type " + Quoted(type) +
                                                   ", which is not known; calibu_fu_fv_u0_v0_kb4 is");
  const CameraModelId model = type == "calibu_fu_fv_u0_v0" ? CameraModelId::kPinhole : CameraModelId::kOpenCvFisheye;
  auto camera = Camera::Create(model, size->width, size->height, NumbersOf(model_of_camera, "params"));
  if (!camera.ok()) return Status(camera.status().code(), file.string() + ": " + camera.status().message());
  return camera;
}

}  // namespace

// <camera_model type="gamma"> with <gamma> and perhaps <vignetting>, <light_model type="sls"> with the spread <mu> and
// the direction <D>. Where the light is, millimeters from the lens, is not used.
Result<PhotometricCalibration> ReadCalibuPhotometry(const fs::path& file) {
  const auto xml = ReadCalibration(file);
  if (!xml.ok()) return xml.status();
  if (!xml->camera.child("gamma"))
    return Status(ErrorCode::kUnreadable, file.string() + " has no gamma of the camera's response");
  PhotometricCalibration calibration;
  // An entry that is there has so many numbers.
  const auto read = [&](const pugi::xml_node& parent, const char* name,
                        std::size_t count) -> Result<std::vector<double>> {
    std::vector<double> numbers = NumbersOf(parent, name);
    if (parent.child(name) && numbers.size() != count)
      return Status(ErrorCode::kUnreadable,
                    file.string() + ": " + name + " does not have " + std::to_string(count) + " numbers");
    return numbers;
  };
  const auto gamma = read(xml->camera, "gamma", 1);
  if (!gamma.ok()) return gamma.status();
  calibration.gamma = gamma->front();
  const auto vignetting = read(xml->camera, "vignetting", 1);
  if (!vignetting.ok()) return vignetting.status();
  if (!vignetting->empty()) calibration.vignetting = vignetting->front();
  if (const pugi::xml_node light = FindElement(xml->document, "light_model")) {
    const auto spread = read(light, "mu", 1);
    if (!spread.ok()) return spread.status();
    if (!spread->empty()) calibration.light_spread = spread->front();
    const auto axis = read(light, "D", 3);
    if (!axis.ok()) return axis.status();
    if (!axis->empty()) calibration.light_axis = Eigen::Vector3d(axis->data());
  }
  if (Status status = CheckPhotometric(calibration); !status.ok())
    return Status(status.code(), file.string() + ": " + status.message());
  return calibration;
}

Result<std::optional<SourceCalibration>> ReadCalibu(const fs::path& file) {
  const auto xml = ReadCalibration(file);
  if (!xml.ok()) return xml.status();
  if (!xml->camera.attribute("type")) return std::optional<SourceCalibration>();
  auto camera = GeometryOf(file, xml->camera);
  if (!camera.ok()) return camera.status();
  SourceCalibration calibration{*std::move(camera), file};
  const fs::path folder = file.has_parent_path() ? file.parent_path() : ".";
  if (const fs::path beside = OnlyFile(folder, "_photometrical.xml"); !beside.empty()) {
    const auto photometric = ReadCalibuPhotometry(beside);
    if (!photometric.ok()) return photometric.status();
    calibration.photometric = *photometric;
  }
  return std::optional(std::move(calibration));
}

}  // namespace pliant
