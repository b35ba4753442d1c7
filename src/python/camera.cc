// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/camera/camera.h"

#include <array>
#include <limits>
#include <string>
#include <vector>

#include <pybind11/stl.h>

#include "pliant/base/options.h"
#include "pliant/base/text.h"
#include "pliant/io/camera_file.h"
#include "python/arrays.h"
#include "python/bind.h"
#include "python/calibration.h"
#include "python/errors.h"

namespace py = pybind11;

namespace pliant::python {
namespace {

Calibration MakeCalibration(const std::string& model, const py::object& width, const py::object& height,
                            const py::object& params, const py::object& fps) {
  const std::optional<double> given_fps = fps.is_none() ? std::nullopt : std::optional(NumberOf(fps, "fps"));
  if (given_fps)
    if (const Status status = CheckFps(*given_fps); !status.ok()) RaiseValueError(status.message());
  return {
      ValueOf(Camera::Create(model, WholeOf(width, "width"), WholeOf(height, "height"), NumbersOf(params, "params"))),
      given_fps};
}

// What is needed to make it again.
py::tuple StateOf(const Calibration& calibration) {
  const Camera& camera = calibration.camera;
  py::object photometric = py::none();
  if (calibration.photometric) {
    const PhotometricCalibration& light = *calibration.photometric;
    photometric = py::make_tuple(light.gamma, light.vignetting, light.light_spread, light.light_axis.x(),
                                 light.light_axis.y(), light.light_axis.z());
  }
  return py::make_tuple(std::string(camera.model_name()), camera.width(), camera.height(),
                        std::vector<double>(camera.params().begin(), camera.params().end()), calibration.fps,
                        photometric);
}

Calibration FromState(const py::tuple& state) {
  Calibration calibration = MakeCalibration(py::cast<std::string>(state[0]), state[1], state[2], state[3], state[4]);
  if (state[5].is_none()) return calibration;
  const auto light = py::cast<std::array<double, 6>>(state[5]);
  calibration.photometric = {light[0], light[1], light[2], {light[3], light[4], light[5]}};
  return calibration;
}

bool IsSame(const Calibration& calibration, const py::object& other) {
  return py::isinstance<Calibration>(other) && StateOf(calibration).equal(StateOf(py::cast<const Calibration&>(other)));
}

void Write(const Calibration& calibration, const py::object& path) {
  const py::object checked = py::module_::import("pliant.arguments").attr("path")(path, "path");
  RaiseUnlessOk(
      WriteCameraFile(py::cast<std::string>(checked),
                      {.camera = calibration.camera, .fps = calibration.fps, .photometric = calibration.photometric}));
}

Calibration ReadCalibration(const std::string& path) {
  const CameraFile file = ValueOf(ReadCameraFile(path));
  return {file.camera, file.fps, file.photometric};
}

// `function` of every row of an array with From numbers a row: To numbers a row, not a number where it says nothing.
template <int kFrom, int kTo, class Function>
py::array_t<double> ForEachRow(const py::array_t<double>& rows, const Function& function) {
  using From = Eigen::Matrix<double, kFrom, 1>;
  const py::ssize_t count = rows.shape(0);
  py::array_t<double> results({count, static_cast<py::ssize_t>(kTo)});
  const double* from = rows.data();
  double* to = results.mutable_data();
  {
    const py::gil_scoped_release release;
    for (py::ssize_t row = 0; row < count; ++row, from += kFrom, to += kTo) {
      const auto result = function(From(Eigen::Map<const From>(from)));
      for (int k = 0; k < kTo; ++k) to[k] = result ? (*result)[k] : std::numeric_limits<double>::quiet_NaN();
    }
  }
  return results;
}

py::array_t<double> Project(const Calibration& calibration, const py::object& points_in_cam) {
  const auto points = PointsOf(points_in_cam, 3, "points_in_cam");
  return ForEachRow<3, 2>(points, [&](const Eigen::Vector3d& point) { return calibration.camera.Project(point); });
}

py::array_t<double> Unproject(const Calibration& calibration, const py::object& pixels) {
  const auto points = PointsOf(pixels, 2, "pixels");
  return ForEachRow<2, 3>(points, [&](const Eigen::Vector2d& pixel) { return calibration.camera.Unproject(pixel); });
}

std::string Representation(const Calibration& calibration) {
  return "pliant.Camera('" + std::string(calibration.camera.model_name()) + "', " +
         std::to_string(calibration.camera.width()) + ", " + std::to_string(calibration.camera.height()) + ", [" +
         CommaSeparated(calibration.camera.params(), FormatDouble) + "])";
}

}  // namespace

void BindCamera(py::module_& module) {
  py::class_<Calibration>(
      module, "Camera",
      "One calibrated camera. Frame: x right, y down, z forward. Pixel (0, 0) is the center of the "
      "first pixel, as in OpenCV.\n\n"
      "model is COLMAP's name, and params are in its order: SIMPLE_PINHOLE f, cx, cy; PINHOLE fx, "
      "fy, cx, cy; SIMPLE_RADIAL f, cx, cy, k; RADIAL f, cx, cy, k1, k2; OPENCV fx, fy, cx, cy, k1, "
      "k2, p1, p2; OPENCV_FISHEYE fx, fy, cx, cy, k1, k2, k3, k4. width, height, focal lengths and "
      "principal point are pixels. fps: images a second, where they have no times of their own.\n\n"
      "Raises ValueError for numbers that no lens has.")
      .def(py::init(&MakeCalibration), py::arg("model"), py::arg("width"), py::arg("height"), py::arg("params"),
           py::kw_only(), py::arg("fps") = py::none())
      .def_property_readonly(
          "model", [](const Calibration& c) { return std::string(c.camera.model_name()); }, "COLMAP's name.")
      .def_property_readonly(
          "width", [](const Calibration& c) { return c.camera.width(); }, "Of the images, pixels.")
      .def_property_readonly(
          "height", [](const Calibration& c) { return c.camera.height(); }, "Of the images, pixels.")
      .def_property_readonly(
          "params",
          [](const Calibration& c) {
            return ArrayOf(std::vector<double>(c.camera.params().begin(), c.camera.params().end()));
          },
          "The parameters in COLMAP's order, float64; pixel (0, 0) is the center of the first pixel.")
      .def_readonly("fps", &Calibration::fps, "Images a second, or None where the calibration does not say.")
      .def("project", &Project, py::arg("points_in_cam"),
           "Pixels (n, 2) of points (n, 3) in the camera frame, any unit; NaN where the model is not defined (behind a "
           "pinhole, for example). A pixel may lie outside the image.")
      .def("unproject", &Unproject, py::arg("pixels"),
           "Unit rays (n, 3) in the camera frame through pixels (n, 2); NaN where no ray projects there.")
      .def("write", &Write, py::arg("path"), "Writes a calibration file, a camera.yaml, which read_camera reads again.")
      .def("__eq__", &IsSame, py::is_operator())
      .def("__hash__", [](const Calibration& c) { return py::hash(py::str(StateOf(c))); })
      .def(py::pickle(&StateOf, &FromState))
      .def("__repr__", &Representation);
  module.def("read_camera", &ReadCalibration, py::arg("path"));
}

}  // namespace pliant::python
