// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

// Ctrl-C while the library works: it stops at the next frame, as the command line does, and what Python makes of the
// signal (KeyboardInterrupt, as a rule) is raised after what there is so far is on disk.
#pragma once

#include <atomic>

#include "python/callbacks.h"

namespace pliant::python {

// Lives as long as a call of the library. Of Python's main thread alone: signals are handled there.
class Interrupt final : public Callbacks {
 public:
  Interrupt();
  ~Interrupt() override;

  // Becomes true when the library is to end: after a signal, or after an exception in a callback.
  const std::atomic<bool>& stop() const { return stop_; }

  // To be called after the library has ended, with the GIL: raises what a callback raised, or Python's answer to the
  // signal.
  void Raise();

 private:
  void OnError() override { stop_ = true; }

  std::atomic<bool> stop_ = false;
  std::atomic<bool>* outer_ = nullptr;  // of a call in whose callback this one is made
  enum class Installed { kNo, kNested, kHandler } installed_ = Installed::kNo;
};

}  // namespace pliant::python
