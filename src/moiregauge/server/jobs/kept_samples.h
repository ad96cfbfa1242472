// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace moiregauge::internal {

// Keeps the sample events of a running command for pages that open later, in bounded memory.
class KeptSamples {
 public:
  enum class Keep {
    kWhole,   // every second event of a long run, so that the curve is coarse but whole
    kNewest,  // the newest half, because a page shows only the last minute of a live source
  };
  // Adds an event. With more than `max_bytes`, half of the events are dropped.
  void add(std::string event, Keep keep, std::size_t max_bytes);
  void clear();
  [[nodiscard]] const std::vector<std::string>& events() const { return events_; }

 private:
  std::vector<std::string> events_;
  std::size_t bytes_ = 0;
};

}  // namespace moiregauge::internal
