// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Ctrl-C while the library works: it stops at the next frame, as the command line does, and what Python makes of the
// signal (KeyboardInterrupt, as a rule) is raised after what there is so far is on disk.
#pragma once

#include <atomic>
#include <exception>
#include <functional>

#include <pybind11/pybind11.h>

namespace pliant::python {

// Lives as long as a call of the library. Of Python's main thread alone: signals are handled there.
class Interrupt {
 public:
  Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;
  ~Interrupt();

  // Becomes true when the library is to end: after a signal, or after an exception in a callback.
  const std::atomic<bool>& stop() const { return stop_; }

  // Calls `function`, which calls Python, from a library that runs without the GIL. An exception in it stops the
  // library; after it nothing is called any more.
  void Call(const std::function<void()>& function);

  // To be called after the library has ended, with the GIL: raises what a callback raised, or Python's answer to the
  // signal.
  void Raise();

 private:
  std::atomic<bool> stop_ = false;
  std::atomic<bool>* outer_ = nullptr;  // of a call in whose callback this one is made
  enum class Installed { kNo, kNested, kHandler } installed_ = Installed::kNo;
  std::exception_ptr error_;
};

}  // namespace pliant::python
