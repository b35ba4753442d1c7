// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// First maps, point tracks and a cost from objects of Python (python/pliant/extensions.py), called while the library
// runs without the GIL.
#pragma once

#include <pybind11/pybind11.h>

#include "pliant/tracking/extensions.h"
#include "pliant/tracking/tracker_options.h"
#include "python/callbacks.h"

namespace pliant::python {

// `given`: "initializer" and "tracks", callables of extensions.py or None, "initializer_name", and what FrameCostOf
// takes. They, and `callbacks`, which takes their exceptions, must outlive what uses the extensions.
TrackerExtensions ExtensionsOf(const pybind11::dict& given, const TrackerOptions& options, Callbacks* callbacks);

}  // namespace pliant::python
