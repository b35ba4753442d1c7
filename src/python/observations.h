// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Observations as the columns of pliant.Observations.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <pybind11/pybind11.h>

#include "pliant/scene/frame_report.h"

namespace pliant::python {

class ObservationColumns {
 public:
  // Makes room for so many rows, where that is known about; there may be more.
  void Reserve(std::size_t rows);
  void Append(int frame_idx, std::span<const PointObservation> observations);
  // pliant.Observations, which takes the columns over.
  pybind11::object Take();

 private:
  std::vector<std::int32_t> frame_idx_;
  std::vector<std::int64_t> point_id_;
  std::vector<double> pixel_;
  std::vector<double> position_;
  std::vector<double> ssim_;
  std::vector<double> sigma_;
};

}  // namespace pliant::python
