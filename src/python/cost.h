// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// A term of the joint problem from an object of Python (python/pliant/extensions.py), called while the library solves
// without the GIL.
#pragma once

#include <memory>

#include <pybind11/pybind11.h>

#include "pliant/estimation/frame/frame_cost.h"
#include "python/callbacks.h"

namespace pliant::python {

// `given`: "cost", a callable of extensions.py or None (the result is null then), and "cost_name". It, and `callbacks`,
// which takes its exceptions, must outlive the result.
std::shared_ptr<const FrameCost> FrameCostOf(const pybind11::dict& given, Callbacks* callbacks);

}  // namespace pliant::python
