// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// NumPy arrays from the library's values and back. An array that is made takes the memory over: nothing is copied.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <pybind11/numpy.h>

#include "pliant/geometry/rigid3.h"

namespace pliant::python {

// The numbers as an array of shape (n, columns...), or (n) without `columns`; each row has columns... numbers.
template <class T>
pybind11::array_t<T> ArrayOf(std::vector<T> numbers, const std::vector<pybind11::ssize_t>& columns = {}) {
  pybind11::ssize_t row = 1;
  for (const pybind11::ssize_t size : columns) row *= size;
  std::vector<pybind11::ssize_t> shape = {static_cast<pybind11::ssize_t>(numbers.size()) / row};
  shape.insert(shape.end(), columns.begin(), columns.end());
  auto owned = std::make_unique<std::vector<T>>(std::move(numbers));
  const T* data = owned->data();
  const pybind11::capsule owner(owned.release(), [](void* memory) { delete static_cast<std::vector<T>*>(memory); });
  return pybind11::array_t<T>(shape, data, owner);
}

// Of shape (n, 3).
pybind11::array_t<double> PositionsArray(std::span<const Eigen::Vector3d> positions);

// Of `frame_count` texts.
pybind11::list ListOf(const std::vector<std::string>& texts);

// The 4x4 matrix of a rigid motion, row by row, behind `numbers`.
void AppendMatrix(const Rigid3& b_from_a, std::vector<double>* numbers);
pybind11::array_t<double> MatrixOf(const Rigid3& b_from_a);

// A whole number, also one of NumPy's and a float that is one; a number; numbers of a list or of an array of one axis.
// Raise TypeError with `what`.
int WholeOf(const pybind11::handle& object, const std::string& what);
double NumberOf(const pybind11::handle& object, const std::string& what);
std::vector<double> NumbersOf(const pybind11::handle& object, const std::string& what);

// Points of an array of shape (n, columns), of any layout and of any real type. Raises ValueError or TypeError with
// `what` ("points_in_cam").
pybind11::array_t<double> PointsOf(const pybind11::handle& array, int columns, const std::string& what);

// The same of three columns, as vectors.
std::vector<Eigen::Vector3d> VectorsOf(const pybind11::handle& array, const std::string& what);
// A rigid motion of an array of shape (4, 4). Raises ValueError, as above, also where it is none.
Rigid3 RigidOf(const pybind11::handle& array, const std::string& what);

// A copy of an 8-bit image, (height, width) or (height, width, 3).
pybind11::array_t<std::uint8_t> ImageArray(const cv::Mat& image);

// A copy of an image: dtype uint8, shape (height, width) or (height, width, 3) in the order blue, green, red; any
// layout in memory. Raises TypeError or ValueError.
cv::Mat ImageOf(const pybind11::handle& array, const std::string& what);
// A mask: dtype uint8 or bool, shape (height, width), 0 or False: ignore this pixel; None: empty.
cv::Mat MaskOf(const pybind11::handle& array);
// A depth prior: dtype float32 or float64, shape (height, width), as float32; None: empty.
cv::Mat DepthPriorOf(const pybind11::handle& array);

}  // namespace pliant::python
