// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Images that Python has, for the library: a list, an array, or anything that is iterated over.
#pragma once

#include <exception>
#include <mutex>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>
#include <pybind11/pybind11.h>

#include "pliant/datasets/given_images.h"

namespace pliant::python {

// What has a length and is indexed is asked for each image when it is needed; the images of any other iterable are
// kept, since tracking may go back to them. Each is copied, so that the program may use its memory again. To be made
// and destroyed with the GIL.
class PythonImages final : public ImageSource {
 public:
  // Raises ValueError where there is no image, and TypeError for what is no iterable.
  explicit PythonImages(pybind11::object images);

  int count() const override { return count_; }
  Result<std::optional<cv::Mat>> Read(int idx) override;

  // Raises what Python raised while an image was read.
  void Raise() const;

 private:
  std::optional<cv::Mat> Get(int idx);

  pybind11::object images_;
  pybind11::object iterator_;  // of what has no length; none after its end
  int count_ = 0;
  std::mutex mutex_;  // taken before the GIL
  std::vector<cv::Mat> kept_;
  std::exception_ptr error_;
  int failed_idx_ = 0;  // of the image at which it was raised
};

}  // namespace pliant::python
