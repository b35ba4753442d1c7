// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "python/arrays.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "python/errors.h"

namespace py = pybind11;

namespace pliant::python {
namespace {

std::string ShapeText(const py::array& array) {
  return py::cast<std::string>(py::str(array.dtype())) + " of shape " +
         py::cast<std::string>(py::str(array.attr("shape")));
}

std::string TypeName(const py::handle& object) {
  return py::cast<std::string>(py::str(py::type::of(object).attr("__name__")));
}

// An object that is no array is one of its elements; raises TypeError where NumPy makes none of it.
py::array AnyArray(const py::handle& object, const std::string& what, const std::string& wanted) {
  if (!py::isinstance<py::array>(object)) RaiseTypeError(what + " is " + wanted + ", not " + TypeName(object));
  return py::reinterpret_borrow<py::array>(object);
}

cv::Mat CopyOf(const py::array& array, int channels) {
  const auto bytes = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!bytes) throw py::error_already_set();
  cv::Mat image(static_cast<int>(bytes.shape(0)), static_cast<int>(bytes.shape(1)), CV_8UC(channels));
  std::copy_n(bytes.data(), bytes.size(), image.data);
  return image;
}

constexpr py::ssize_t kMostPixels = 100'000;  // a side

bool IsImageSide(py::ssize_t size) { return size > 0 && size <= kMostPixels; }

}  // namespace

double NumberOf(const py::handle& object, const std::string& what) {
  const bool is_text = py::isinstance<py::str>(object) || py::isinstance<py::bytes>(object);
  const double value = is_text ? -1.0 : PyFloat_AsDouble(object.ptr());
  if (!is_text && (value != -1.0 || PyErr_Occurred() == nullptr)) return value;
  PyErr_Clear();
  RaiseTypeError(what + " is a " + TypeName(object) + "; give a number");
}

int WholeOf(const py::handle& object, const std::string& what) {
  const double value = NumberOf(object, what);
  constexpr int kLargest = std::numeric_limits<int>::max();
  if (value != std::floor(value) || std::abs(value) > kLargest)
    RaiseValueError(what + " is " + py::cast<std::string>(py::str(object)) + "; give a whole number" +
                    (std::abs(value) > kLargest ? " of at most " + std::to_string(kLargest) : ""));
  return static_cast<int>(value);
}

std::vector<double> NumbersOf(const py::handle& object, const std::string& what) {
  const std::string wanted = "a list of numbers, or an array of one axis";
  const bool is_list = py::isinstance<py::sequence>(object) || py::isinstance<py::array>(object);
  if (!is_list || py::isinstance<py::str>(object) || py::isinstance<py::bytes>(object))
    RaiseTypeError(what + " is a " + TypeName(object) + "; give " + wanted);
  if (py::isinstance<py::array>(object) && py::cast<py::array>(object).ndim() != 1)
    RaiseValueError(what + " is " + wanted + "; this one is " + ShapeText(py::cast<py::array>(object)));
  std::vector<double> numbers;
  for (const py::handle number : py::cast<py::iterable>(object)) numbers.push_back(NumberOf(number, what));
  return numbers;
}

py::list ListOf(const std::vector<std::string>& texts) {
  py::list list;
  for (const std::string& text : texts) list.append(text);
  return list;
}

void AppendMatrix(const Rigid3& b_from_a, std::vector<double>* numbers) {
  const Eigen::Matrix3d rotation = b_from_a.RotationMatrix();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) numbers->push_back(rotation(row, column));
    numbers->push_back(b_from_a.translation[row]);
  }
  numbers->insert(numbers->end(), {0.0, 0.0, 0.0, 1.0});
}

py::array_t<double> PositionsArray(std::span<const Eigen::Vector3d> positions) {
  std::vector<double> numbers;
  numbers.reserve(3 * positions.size());
  for (const Eigen::Vector3d& position : positions)
    numbers.insert(numbers.end(), {position.x(), position.y(), position.z()});
  return ArrayOf(std::move(numbers), {3});
}

py::array_t<double> MatrixOf(const Rigid3& b_from_a) {
  std::vector<double> numbers;
  AppendMatrix(b_from_a, &numbers);
  py::array_t<double> matrix({4, 4});
  std::copy(numbers.begin(), numbers.end(), matrix.mutable_data());
  return matrix;
}

py::array_t<double> PointsOf(const py::handle& object, int columns, const std::string& what) {
  const std::string wanted = "an array of real numbers of shape (n, " + std::to_string(columns) + ")";
  const bool is_rows = py::isinstance<py::list>(object) || py::isinstance<py::tuple>(object);
  const py::array of_rows = is_rows ? py::array::ensure(object) : py::array();
  const py::array array = AnyArray(is_rows && of_rows ? py::handle(of_rows) : object, what, wanted);
  const char kind = array.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u')
    RaiseTypeError(what + " is " + wanted + "; this one is " + ShapeText(array));
  if (array.ndim() != 2 || array.shape(1) != columns)
    RaiseValueError(what + " is " + wanted + "; this one is " + ShapeText(array));
  auto points = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!points) throw py::error_already_set();
  return points;
}

std::vector<Eigen::Vector3d> VectorsOf(const py::handle& array, const std::string& what) {
  const auto numbers = PointsOf(array, 3, what);
  std::vector<Eigen::Vector3d> vectors(static_cast<std::size_t>(numbers.shape(0)));
  const double* from = numbers.data();
  for (Eigen::Vector3d& vector : vectors) {
    vector = Eigen::Map<const Eigen::Vector3d>(from);
    from += 3;
  }
  return vectors;
}

Rigid3 RigidOf(const py::handle& array, const std::string& what) {
  constexpr double kTolerance = 1e-6;  // of single precision
  using Matrix = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  const auto numbers = PointsOf(array, 4, what);
  if (numbers.shape(0) != 4)
    RaiseValueError(what + " has " + std::to_string(numbers.shape(0)) + " rows; a rigid motion is a 4x4 matrix");
  const Matrix matrix = Eigen::Map<const Matrix>(numbers.data());
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  const bool rigid = matrix.allFinite() && rotation.determinant() > 0 &&
                     (rotation * rotation.transpose()).isIdentity(kTolerance) &&
                     matrix.row(3).isApprox(Eigen::RowVector4d::Unit(3), kTolerance);
  if (!rigid) RaiseValueError(what + " is no rigid motion; give a rotation, a translation and the row 0, 0, 0, 1");
  return {rotation, matrix.topRightCorner<3, 1>()};
}

py::array_t<std::uint8_t> ImageArray(const cv::Mat& image) {
  std::vector<py::ssize_t> shape = {image.rows, image.cols};
  if (image.channels() > 1) shape.push_back(image.channels());
  py::array_t<std::uint8_t> array(shape);
  const auto row_bytes = static_cast<std::size_t>(image.cols) * image.elemSize();
  for (int row = 0; row < image.rows; ++row)
    std::copy_n(image.ptr<std::uint8_t>(row), row_bytes, array.mutable_data() + row * row_bytes);
  return array;
}

cv::Mat ImageOf(const py::handle& object, const std::string& what) {
  const std::string wanted =
      "a NumPy array of dtype uint8 and shape (height, width), or (height, width, 3) in the order blue, green, red";
  const py::array array = AnyArray(object, what, wanted);
  if (!array.dtype().is(py::dtype::of<std::uint8_t>()) && !array.dtype().equal(py::dtype::of<std::uint8_t>()))
    RaiseTypeError(what + " is " + wanted + "; this one is " + ShapeText(array));
  const bool gray = array.ndim() == 2;
  if ((!gray && (array.ndim() != 3 || array.shape(2) != 3)) || !IsImageSide(array.shape(0)) ||
      !IsImageSide(array.shape(1)))
    RaiseValueError(what + " is " + wanted + "; this one is " + ShapeText(array));
  return CopyOf(array, gray ? 1 : 3);
}

cv::Mat MaskOf(const py::handle& object) {
  if (object.is_none()) return {};
  const std::string wanted = "a NumPy array of dtype uint8 or bool and shape (height, width), 0: ignore this pixel";
  const py::array array = AnyArray(object, "the mask", wanted);
  const char kind = array.dtype().kind();
  if (kind != 'b' && (kind != 'u' || array.itemsize() != 1))
    RaiseTypeError("the mask is " + wanted + "; this one is " + ShapeText(array));
  if (array.ndim() != 2 || !IsImageSide(array.shape(0)) || !IsImageSide(array.shape(1)))
    RaiseValueError("the mask is " + wanted + "; this one is " + ShapeText(array));
  cv::Mat mask = CopyOf(array, 1);
  if (kind == 'b') mask.setTo(255, mask);
  return mask;
}

cv::Mat DepthPriorOf(const py::handle& object) {
  if (object.is_none()) return {};
  const std::string wanted = "a NumPy array of dtype float32 or float64 and shape (height, width), 0 or NaN: none";
  const py::array array = AnyArray(object, "the depth prior", wanted);
  if (array.dtype().kind() != 'f' || array.itemsize() < 4)
    RaiseTypeError("the depth prior is " + wanted + "; this one is " + ShapeText(array));
  if (array.ndim() != 2 || !IsImageSide(array.shape(0)) || !IsImageSide(array.shape(1)))
    RaiseValueError("the depth prior is " + wanted + "; this one is " + ShapeText(array));
  const auto values = py::array_t<float, py::array::c_style | py::array::forcecast>::ensure(array);
  cv::Mat prior(static_cast<int>(values.shape(0)), static_cast<int>(values.shape(1)), CV_32FC1);
  std::copy_n(values.data(), values.size(), prior.ptr<float>());
  return prior;
}

}  // namespace pliant::python
