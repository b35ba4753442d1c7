// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// The parts of the compiled Python module pliant._pliant, one a file. What users call is in python/pliant, which adds
// defaults and documentation; here Python's values become the library's and back.
#pragma once

#include <pybind11/pybind11.h>

namespace pliant::python {

void BindErrors(pybind11::module_& module);    // Error
void BindOptions(pybind11::module_& module);   // list_options
void BindCamera(pybind11::module_& module);    // Camera
void BindSequence(pybind11::module_& module);  // SequenceSource, FrameReader
void BindRun(pybind11::module_& module);       // read_run, read_observations, read_map
void BindTracker(pybind11::module_& module);   // FrameReport, Tracker
void BindTrack(pybind11::module_& module);     // track
void BindJobs(pybind11::module_& module);      // simulate, refine, surface, evaluate, export, report
void BindKernels(pybind11::module_& module);   // triangulate, relative_pose, deformation_graph
void BindSolvers(pybind11::module_& module);   // solve_frame, solve_window

}  // namespace pliant::python
