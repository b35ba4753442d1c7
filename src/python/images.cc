// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "python/images.h"

#include <string>
#include <utility>

#include "python/arrays.h"
#include "python/errors.h"

namespace py = pybind11;

namespace pliant::python {

PythonImages::PythonImages(py::object images) : images_(std::move(images)) {
  if (py::hasattr(images_, "__len__") && py::hasattr(images_, "__getitem__")) {
    count_ = static_cast<int>(py::len(images_));
    if (count_ == 0) RaiseValueError("there are no images to track; give at least two");
    return;
  }
  if (!py::hasattr(images_, "__iter__"))
    RaiseTypeError("the input is " + py::cast<std::string>(py::str(py::type::of(images_).attr("__name__"))) +
                   "; give a path, or an iterable of images");
  iterator_ = py::iter(images_);
}

// Nothing beyond the end.
std::optional<cv::Mat> PythonImages::Get(int idx) {
  const std::string title = "image " + std::to_string(idx);
  if (count_ > 0) {
    if (idx >= count_) return std::nullopt;
    return ImageOf(images_[py::int_(idx)], title);
  }
  // No image is asked for before it is wanted: a camera would be one image late.
  while (static_cast<int>(kept_.size()) <= idx && iterator_) {
    const auto next = py::reinterpret_steal<py::object>(PyIter_Next(iterator_.ptr()));
    if (PyErr_Occurred() != nullptr) throw py::error_already_set();
    if (next)
      kept_.push_back(ImageOf(next, "image " + std::to_string(kept_.size())));
    else
      iterator_ = py::object();
  }
  return idx < static_cast<int>(kept_.size()) ? std::optional(kept_[static_cast<std::size_t>(idx)]) : std::nullopt;
}

Result<std::optional<cv::Mat>> PythonImages::Read(int idx) {
  const std::lock_guard lock(mutex_);
  if (!error_ || idx < failed_idx_) {
    const py::gil_scoped_acquire acquire;
    try {
      return Get(idx);
    } catch (...) {
      error_ = std::current_exception();
      failed_idx_ = count_ > 0 ? idx : static_cast<int>(kept_.size());
    }
  }
  return Status(ErrorCode::kUnreadable, "image " + std::to_string(idx) + " could not be had from the program");
}

void PythonImages::Raise() const {
  if (error_) std::rethrow_exception(error_);
}

}  // namespace pliant::python
