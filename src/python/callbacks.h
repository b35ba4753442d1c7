// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Calls of Python from a library that runs without the GIL. An exception cannot pass through the library: the first one
// is kept, nothing is called after it, and it is raised when the library has ended.
#pragma once

#include <exception>
#include <functional>

#include <pybind11/pybind11.h>

namespace pliant::python {

class Callbacks {
 public:
  Callbacks() = default;
  Callbacks(const Callbacks&) = delete;
  Callbacks& operator=(const Callbacks&) = delete;
  virtual ~Callbacks() = default;

  // Calls `function`, which calls Python, with the GIL.
  void Call(const std::function<void()>& function) {
    if (error_) return;
    const pybind11::gil_scoped_acquire acquire;
    try {
      function();
    } catch (...) {
      error_ = std::current_exception();
      OnError();
    }
  }

  bool failed() const { return error_ != nullptr; }

  // To be called after the library has ended, with the GIL: raises what a callback raised.
  void RaiseError() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  virtual void OnError() {}

  std::exception_ptr error_;
};

}  // namespace pliant::python
