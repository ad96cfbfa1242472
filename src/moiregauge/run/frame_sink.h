// SPDX-License-Identifier: Apache-2.0
// The door through which pictures of the measured frames go out while a run is under way. Implemented by io (stabilised
// crops).
#pragma once

#include "moiregauge/observation/reference/reference.h"
#include "moiregauge/run/frame_source.h"

namespace moiregauge::internal {

class FrameSink {
 public:
  virtual ~FrameSink() = default;
  // Every selected frame in order, as soon as it is observed. `reference` is null until there is a reference frame.
  // Keeps its own failures: they never end the measuring.
  virtual void add(const Frame& frame, int bits, const Reference* reference, const Observation& seen) = 0;
};

}  // namespace moiregauge::internal
