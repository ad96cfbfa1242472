// SPDX-License-Identifier: Apache-2.0
// Interface for images of the measured frames, delivered during a run. `io` implements it (stabilised crops).
#pragma once

#include "moiregauge/observation/reference/reference.h"
#include "moiregauge/run/frame_source.h"

namespace moiregauge::internal {

class FrameSink {
 public:
  virtual ~FrameSink() = default;
  // Receives every selected frame in order, once it is observed. `reference` is null until there is a reference frame.
  // Failures are stored in the sink and never end the measurement.
  virtual void add(const Frame& frame, int bits, const Reference* reference, const Observation& seen) = 0;
};

}  // namespace moiregauge::internal
