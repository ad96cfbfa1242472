// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/observation/reference/observations.h"

namespace moiregauge::internal {

void Observations::append(const Observations& other, std::size_t first, std::size_t end) {
  for (std::size_t n = first; n < end; ++n) packed_.push_back(other.packed_[n]);
}

// All bytes were packed here, or unpacked once before, so this cannot fail.
Observation Observations::read(const std::string& bytes) const {
  return packing_.unpacked(bytes).value_or(Observation{});
}

}  // namespace moiregauge::internal
