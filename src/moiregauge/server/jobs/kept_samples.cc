// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/server/jobs/kept_samples.h"

#include <utility>

namespace moiregauge::internal {

void KeptSamples::add(std::string event, Keep keep, std::size_t max_bytes) {
  bytes_ += event.size();
  events_.push_back(std::move(event));
  if (bytes_ <= max_bytes) return;
  const std::size_t first = keep == Keep::kNewest ? events_.size() / 2 : 0, step = keep == Keep::kNewest ? 1 : 2;
  std::vector<std::string> half;
  bytes_ = 0;
  for (std::size_t i = first; i < events_.size(); i += step) {
    bytes_ += events_[i].size();
    half.push_back(std::move(events_[i]));
  }
  events_ = std::move(half);
}

void KeptSamples::clear() {
  events_.clear();
  bytes_ = 0;
}

}  // namespace moiregauge::internal
