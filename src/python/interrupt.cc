// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "python/interrupt.h"

#include <csignal>

namespace py = pybind11;

namespace pliant::python {
namespace {

// A signal handler can reach nothing but globals.
std::atomic<std::atomic<bool>*> active_stop = nullptr;
struct sigaction handler_before = {};
static_assert(std::atomic<std::atomic<bool>*>::is_always_lock_free);

// Python's own handler notes the signal, for when Python runs again.
void StopAndTellPython(int signal) {
  if (std::atomic<bool>* stop = active_stop) *stop = true;
  handler_before.sa_handler(signal);
}

bool InMainThread() {
  const py::object main = py::module_::import("threading").attr("main_thread")();
  return py::cast<unsigned long>(main.attr("ident")) == PyThread_get_thread_ident();
}

}  // namespace

Interrupt::Interrupt() {
  if (!InMainThread()) return;
  if (active_stop != nullptr) {
    outer_ = active_stop.exchange(&stop_);
    installed_ = Installed::kNested;
    return;
  }
  sigaction(SIGINT, nullptr, &handler_before);
  if (handler_before.sa_handler == SIG_IGN || handler_before.sa_handler == SIG_DFL) return;
  active_stop = &stop_;
  struct sigaction action = handler_before;
  action.sa_handler = StopAndTellPython;
  sigaction(SIGINT, &action, nullptr);
  installed_ = Installed::kHandler;
}

Interrupt::~Interrupt() {
  if (installed_ == Installed::kNo) return;
  if (installed_ == Installed::kHandler) sigaction(SIGINT, &handler_before, nullptr);
  active_stop = outer_;
}

void Interrupt::Raise() {
  RaiseError();
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

}  // namespace pliant::python
