// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pliant/base/version.h"
#include "python/bind.h"

PYBIND11_MODULE(_pliant, module) {
  module.attr("__version__") = pliant::kVersion;
  pliant::python::BindErrors(module);
  pliant::python::BindOptions(module);
  pliant::python::BindCamera(module);
  pliant::python::BindSequence(module);
  pliant::python::BindRun(module);
  pliant::python::BindTracker(module);
  pliant::python::BindTrack(module);
  pliant::python::BindJobs(module);
  pliant::python::BindKernels(module);
  pliant::python::BindSolvers(module);
}
