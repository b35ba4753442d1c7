// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/camera/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <type_traits>

namespace pliant {
namespace {

Status Invalid(std::string_view model, const std::string& what) {
  return {ErrorCode::kInvalidArgument, "the " + std::string(model) + " camera " + what};
}

template <class Model>
Result<Camera::Model> CreateModel(std::span<const double> params) {
  if (params.size() != Model::kNumParams)
    return Invalid(Model::kName, "takes " + std::to_string(Model::kNumParams) + " parameters (" +
                                     std::string(Model::kParamNames) + ") and got " + std::to_string(params.size()));
  typename Model::Params values;
  std::copy(params.begin(), params.end(), values.begin());
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]))
      return Invalid(Model::kName, "has a parameter that is not a finite number: number " + std::to_string(i + 1) +
                                       " of " + std::string(Model::kParamNames));
  const Model model(values);
  if (!(model.fx() > 0.0 && model.fy() > 0.0))
    return Invalid(Model::kName, "has a focal length of " + FormatDouble(std::min(model.fx(), model.fy())) +
                                     " px; it must be positive");
  return Camera::Model(model);
}

Result<Camera::Model> CreateModel(CameraModelId model, std::span<const double> params) {
  switch (model) {
    case CameraModelId::kSimplePinhole:
      return CreateModel<SimplePinhole>(params);
    case CameraModelId::kPinhole:
      return CreateModel<Pinhole>(params);
    case CameraModelId::kSimpleRadial:
      return CreateModel<SimpleRadial>(params);
    case CameraModelId::kRadial:
      return CreateModel<Radial>(params);
    case CameraModelId::kOpenCv:
      return CreateModel<OpenCv>(params);
    case CameraModelId::kOpenCvFisheye:
      return CreateModel<OpenCvFisheye>(params);
  }
  return Status(ErrorCode::kInvalidArgument, "there is no camera model number " +
                                                 std::to_string(static_cast<int>(model)) + "; the numbers are 0 to 5");
}

// What no lens has, but a slip in the order or the unit of the parameters gives.
Status CheckPlausible(const Camera& camera) {
  constexpr double kLongest = 1000;    // focal length by the image's longer side: a field of view of 0.06 degrees
  constexpr double kShortest = 0.001;  // and one that sees everything in a pixel
  const double side = std::max(camera.width(), camera.height());
  const double focal = camera.MeanFocalLengthPx();
  const std::string size = std::to_string(camera.width()) + "x" + std::to_string(camera.height());
  if (!(focal > kShortest * side && focal < kLongest * side))
    return Invalid(camera.model_name(), "has a focal length of " + FormatDouble(focal) + " px for an image of " + size +
                                            "; check the parameters' order and unit (px)");
  return camera.Visit([&](const auto& model) {
    const bool near = model.cx() > -camera.width() && model.cx() < 2.0 * camera.width() &&
                      model.cy() > -camera.height() && model.cy() < 2.0 * camera.height();
    if (near) return Status::Ok();
    return Invalid(camera.model_name(), "has its principal point at (" + FormatDouble(model.cx()) + ", " +
                                            FormatDouble(model.cy()) + "), far outside the image of " + size +
                                            "; check the parameters' order");
  });
}

// Endoscopes show a disc in a rectangular image: the corners may lie beyond the fold, the inscribed circle may not.
bool SeesInscribedCircle(const Camera& camera) {
  constexpr int kSamples = 64;
  const double radius = 0.5 * (std::min(camera.width(), camera.height()) - 1);
  for (int i = 0; i < kSamples; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kSamples;
    const Eigen::Vector2d center(0.5 * (camera.width() - 1), 0.5 * (camera.height() - 1));
    if (!camera.Unproject(center + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)))) return false;
  }
  return true;
}

// How many focal lengths a model has; they are its first parameters.
std::size_t NumFocalLengths(const Camera& camera) {
  return camera.Visit([](const auto& model) -> std::size_t { return model.kParamNames.starts_with("fx") ? 2 : 1; });
}

}  // namespace

Result<Camera> Camera::Create(CameraModelId model, int width, int height, std::span<const double> params) {
  auto created = CreateModel(model, params);
  if (!created.ok()) return created.status();
  if (width <= 0 || height <= 0)
    return Invalid(EnumName(model), "has an image size of " + std::to_string(width) + "x" + std::to_string(height) +
                                        "; both must be positive");
  Camera camera(std::move(created).value(), width, height);
  if (Status plausible = CheckPlausible(camera); !plausible.ok()) return plausible;
  if (!SeesInscribedCircle(camera))
    return Invalid(EnumName(model), "has a distortion that folds over inside the image of " + std::to_string(width) +
                                        "x" + std::to_string(height) +
                                        "; check the coefficients' order and the image size");
  return camera;
}

Result<Camera> Camera::Create(std::string_view model_name, int width, int height, std::span<const double> params) {
  std::vector<std::string> names;
  for (const auto& [id, name] : EnumNames<CameraModelId>::kNames) {
    if (name == model_name) return Create(id, width, height, params);
    names.emplace_back(name);
  }
  return Status(ErrorCode::kInvalidArgument, "there is no camera model '" + std::string(model_name) +
                                                 "'; did you mean '" + NearestName(model_name, names) + "'?");
}

Result<Camera> Camera::WithFocalLengthTimes(double factor) const {
  std::vector<double> changed(params().begin(), params().end());
  for (std::size_t i = 0; i < NumFocalLengths(*this); ++i) changed[i] *= factor;
  return Create(model_id(), width_, height_, changed);
}

Result<Camera> Camera::Resized(double scale) const {
  const std::size_t focals = NumFocalLengths(*this);
  std::vector<double> resized(params().begin(), params().end());
  for (std::size_t i = 0; i < focals; ++i) resized[i] *= scale;
  for (std::size_t i = focals; i < focals + 2; ++i) resized[i] = scale * (resized[i] + 0.5) - 0.5;  // centers of pixels
  const auto side = [scale](int side_px) { return std::max(1, static_cast<int>(std::lround(scale * side_px))); };
  return Create(model_id(), side(width_), side(height_), resized);
}

CameraModelId Camera::model_id() const { return EnumNames<CameraModelId>::kNames[model_.index()].first; }

std::span<const double> Camera::params() const {
  return Visit([](const auto& model) { return std::span<const double>(model.params()); });
}

double Camera::MeanFocalLengthPx() const {
  return Visit([](const auto& model) { return 0.5 * (model.fx() + model.fy()); });
}

double Camera::HorizontalFocalLengthPx() const {
  return Visit([](const auto& model) { return model.fx(); });
}

std::optional<Eigen::Vector2d> Camera::Project(const Eigen::Vector3d& point_in_cam) const {
  Eigen::Vector2d pixel;
  if (!Visit([&](const auto& model) { return model.Project(point_in_cam.data(), pixel.data()); })) return std::nullopt;
  return pixel;
}

std::optional<Projection> Camera::ProjectWithJacobian(const Eigen::Vector3d& point_in_cam) const {
  Projection projection;
  Eigen::Matrix<double, 2, 3, Eigen::RowMajor> jacobian;
  if (!Visit([&](const auto& model) {
        return model.ProjectWithJacobian(point_in_cam.data(), projection.pixel.data(), jacobian.data());
      }))
    return std::nullopt;
  projection.d_pixel_d_point = jacobian;
  return projection;
}

std::optional<Eigen::Vector3d> Camera::Unproject(const Eigen::Vector2d& pixel) const {
  Eigen::Vector3d ray;
  if (!Visit([&](const auto& model) { return model.Unproject(pixel.data(), ray.data()); })) return std::nullopt;
  return ray;
}

std::vector<std::optional<Eigen::Vector2d>> Camera::Project(std::span<const Eigen::Vector3d> points_in_cam) const {
  std::vector<std::optional<Eigen::Vector2d>> pixels(points_in_cam.size());
  Visit([&](const auto& model) {
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      Eigen::Vector2d pixel;
      if (model.Project(points_in_cam[i].data(), pixel.data())) pixels[i] = pixel;
    }
  });
  return pixels;
}

std::vector<std::optional<Eigen::Vector3d>> Camera::Unproject(std::span<const Eigen::Vector2d> pixels) const {
  std::vector<std::optional<Eigen::Vector3d>> rays(pixels.size());
  Visit([&](const auto& model) {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      Eigen::Vector3d ray;
      if (model.Unproject(pixels[i].data(), ray.data())) rays[i] = ray;
    }
  });
  return rays;
}

}  // namespace pliant
