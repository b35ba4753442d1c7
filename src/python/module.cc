// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cstddef>

#include "pliant/base/version.h"
#include "python/bind.h"

namespace pliant::python {
namespace {

[[noreturn]] void* RefuseUnmadeInstance(std::size_t /*size*/) {
  throw pybind11::type_error("this object was made by __new__ alone and holds nothing; call its class");
}

// pybind11 allocates the value of an instance that no constructor has made when a function is given it, and nothing
// writes to that memory. All classes of the module refuse such an instance there.
void RefuseUnmadeInstances(const pybind11::module_& module) {
  for (const auto& [name, value] : pybind11::cast<pybind11::dict>(module.attr("__dict__"))) {
    if (PyType_Check(value.ptr()) == 0) continue;
    auto* type = pybind11::detail::get_type_info(reinterpret_cast<PyTypeObject*>(value.ptr()));
    if (type != nullptr) type->operator_new = &RefuseUnmadeInstance;
  }
}

}  // namespace
}  // namespace pliant::python

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
  pliant::python::RefuseUnmadeInstances(module);
}
