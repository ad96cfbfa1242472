// SPDX-License-Identifier: Apache-2.0
// The door through which observations go out while a run is under way, so that a run that is killed keeps them.
// Implemented by io (run.mgj).
#pragma once

#include <string>
#include <vector>

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// Told of everything once and in order, but for what a run that goes on was given (RunHooks::so_far).
class JournalSink {
 public:
  virtual ~JournalSink() = default;
  // The reference frame, before the first frame that is measured against it; `notes`: what was noted when it was made.
  virtual void refer(const Reference& reference, const std::vector<std::string>& notes) = 0;
  virtual void add(const std::string& packed) = 0;  // as ObservationPacking makes it
  // False from the moment on that nothing more can be kept: the measuring ends there.
  [[nodiscard]] virtual bool good() const = 0;
};

}  // namespace moiregauge::internal
