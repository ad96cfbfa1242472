// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/common/interrupt.h"

#include <atomic>

namespace moiregauge::internal::cli {
namespace {

// Set by the signal handler, read by other threads.
std::atomic<bool> asked_to_stop{false};  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)
static_assert(std::atomic<bool>::is_always_lock_free);

void on_interrupt(int signal) {
  if (asked_to_stop) std::signal(signal, SIG_DFL), std::raise(signal);  // takes effect when we return
  asked_to_stop = true;
}

}  // namespace

bool interrupted() { return asked_to_stop; }

InterruptGuard::InterruptGuard() {
  asked_to_stop = false;
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  sigaction(SIGINT, &action, &old_interrupt_);
  sigaction(SIGTERM, &action, &old_terminate_);
}

InterruptGuard::~InterruptGuard() {
  sigaction(SIGINT, &old_interrupt_, nullptr);
  sigaction(SIGTERM, &old_terminate_, nullptr);
}

}  // namespace moiregauge::internal::cli
