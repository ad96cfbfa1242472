// SPDX-License-Identifier: Apache-2.0
// Ctrl-C, or a polite request to end, asks the work at hand to stop at its next step; a second one kills as usual.
#pragma once

#include <csignal>

namespace moiregauge::internal::cli {

// Since the guard at hand was made.
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
