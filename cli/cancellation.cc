// SPDX-License-Identifier: Apache-2.0
#include "cli/cancellation.h"

#include <atomic>
#include <csignal>

namespace rsstab::cli {
namespace {

// A signal handler can reach nothing but a global, and only a lock-free one.
std::atomic<bool> cancel_requested = false;
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void OnSignal(int signal_number) {
  if (cancel_requested.exchange(true)) {
    std::signal(signal_number, SIG_DFL);
    std::raise(signal_number);
  }
}

}  // namespace

void InstallSignalHandlers() {
  struct sigaction stop = {};
  stop.sa_handler = &OnSignal;
  sigemptyset(&stop.sa_mask);
  for (const int signal_number : {SIGINT, SIGTERM, SIGHUP}) {
    sigaction(signal_number, &stop, nullptr);
  }
  struct sigaction ignore = {};
  ignore.sa_handler = SIG_IGN;
  sigemptyset(&ignore.sa_mask);
  sigaction(SIGPIPE, &ignore, nullptr);
  sigaction(SIGXFSZ, &ignore, nullptr);
}

bool CancelRequested() { return cancel_requested.load(std::memory_order_relaxed); }

}  // namespace rsstab::cli
