// SPDX-FileCopyrightText: 2026 The Pliant authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/interrupt.h"

#include <csignal>

namespace pliant::cli {
namespace {

// A signal handler can reach nothing but a global; a lock-free atomic is safe to write there.
std::atomic<bool> stop_requested = false;
static_assert(std::atomic<bool>::is_always_lock_free);

std::atomic<int> last_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free);

void RequestStop(int signal) {
  last_signal = signal;
  stop_requested = true;
}

}  // namespace

std::atomic<bool>& StopOnSignals() {
  struct sigaction action = {};
  action.sa_handler = RequestStop;
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);  // the next signal gets its default action
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction hang_up = {};
  sigaction(SIGHUP, nullptr, &hang_up);
  if (hang_up.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);  // nohup: the run outlives its terminal
  std::signal(SIGPIPE, SIG_IGN);  // whoever read the progress is gone; that is no reason to end a run
  return stop_requested;
}

int LastSignal() { return last_signal; }

}  // namespace pliant::cli
