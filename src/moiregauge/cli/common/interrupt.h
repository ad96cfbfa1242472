// SPDX-License-Identifier: Apache-2.0
// Ctrl-C (SIGINT) and SIGTERM stop the present work at its next step. A second one ends the process as usual.
#pragma once

#include <csignal>

namespace moiregauge::internal::cli {

// Returns true if a signal has come since the present guard was made.
[[nodiscard]] bool interrupted();

class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

 private:
  struct sigaction old_interrupt_ {};
  struct sigaction old_terminate_ {};
};

}  // namespace moiregauge::internal::cli
