// SPDX-License-Identifier: Apache-2.0
// Interface for observations, delivered during a run, so that a killed run can be resumed. `io` implements it
// (run.mgj).
#pragma once

#include <string>
#include <vector>

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// Receives everything once and in order, except the observations that a resumed run starts with.
class JournalSink {
 public:
  virtual ~JournalSink() = default;
  // Receives the reference frame before the first frame measured against it. `notes`: remarks on the reference frame.
  virtual void refer(const Reference& reference, const std::vector<std::string>& notes) = 0;
  virtual void add(const std::string& packed) = 0;  // packed by ObservationPacking
  // Returns false once nothing more can be stored. The measurement then stops.
  [[nodiscard]] virtual bool good() const = 0;
};

}  // namespace moiregauge::internal
