// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "pliant/datasets/open_sequence.h"
#include "python/arrays.h"
#include "python/bind.h"
#include "python/calibration.h"
#include "python/errors.h"

namespace py = pybind11;

namespace pliant::python {
namespace {

std::unique_ptr<Sequence> Open(const SequenceRequest& request) {
  return ValueOf([&] {
    const py::gil_scoped_release release;
    return OpenSequence(request);
  }());
}

// Reads from the first frame to the last one.
class FrameReader {
 public:
  explicit FrameReader(const SequenceRequest& request) : sequence_(Open(request)) {}

  // (frame_idx, name, timestamp, image, mask, right), or None at the end.
  py::object Next() {
    auto next = [&] {
      const py::gil_scoped_release release;
      return sequence_->Next();
    }();
    const std::optional<SequenceFrame> frame = ValueOf(std::move(next));
    if (!frame) return py::none();
    py::object right = py::none();
    if (const auto image = ValueOf(sequence_->Right())) right = ImageArray(*image);
    const py::object mask = frame->mask.empty() ? py::object(py::none()) : py::object(ImageArray(frame->mask));
    return py::make_tuple(frame->frame_idx, frame->name, frame->timestamp_s, ImageArray(frame->image), mask, right);
  }

 private:
  std::unique_ptr<Sequence> sequence_;
};

class PythonSequence {
 public:
  explicit PythonSequence(const py::dict& request)
      : request_{.image_path = py::cast<std::filesystem::path>(request["image_path"]),
                 .camera_path = py::cast<std::filesystem::path>(request["camera_path"]),
                 .mask_path = py::cast<std::filesystem::path>(request["mask_path"]),
                 .start = py::cast<int>(request["start"]),
                 .end = py::cast<int>(request["end"]),
                 .stride = py::cast<int>(request["stride"])},
        sequence_(Open(request_)) {
    Warn(sequence_->Warnings());
  }

  Calibration camera() const { return {sequence_->camera(), sequence_->Fps(), sequence_->Photometric()}; }
  int size() const { return sequence_->size(); }
  std::optional<double> baseline_mm() const { return sequence_->BaselineMm(); }
  std::unique_ptr<FrameReader> Begin() const { return std::make_unique<FrameReader>(request_); }

  py::object Depth(int frame_idx) const {
    const auto depth = ValueOf(sequence_->Depth(frame_idx));
    if (!depth) return py::none();
    py::array_t<float> array({depth->rows, depth->cols});
    for (int row = 0; row < depth->rows; ++row)
      std::copy_n(depth->ptr<float>(row), depth->cols, array.mutable_data(row, 0));
    return array;
  }
  py::object WorldFromCam(int frame_idx) const {
    const auto pose = sequence_->WorldFromCamera(frame_idx);
    return pose ? py::object(MatrixOf(*pose)) : py::none();
  }

 private:
  SequenceRequest request_;
  std::unique_ptr<Sequence> sequence_;  // that answers all but the images
};

}  // namespace

void BindSequence(py::module_& module) {
  py::class_<FrameReader>(module, "FrameReader").def("next", &FrameReader::Next);
  py::class_<PythonSequence>(module, "SequenceSource")
      .def(py::init<const py::dict&>())
      .def_property_readonly("camera", &PythonSequence::camera)
      .def_property_readonly("size", &PythonSequence::size)
      .def_property_readonly("baseline_mm", &PythonSequence::baseline_mm)
      .def("begin", &PythonSequence::Begin)
      .def("depth", &PythonSequence::Depth)
      .def("world_from_cam", &PythonSequence::WorldFromCam);
}

}  // namespace pliant::python
