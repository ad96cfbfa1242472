// SPDX-License-Identifier: Apache-2.0
// Collects the outcome of every clip of a batch into batch.csv, catalogue.sqlite and index.html.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/batch/clip.h"
#include "moiregauge/batch/collected_clip.h"

namespace moiregauge::internal {

struct BatchTotals {
  std::size_t clips = 0;
  std::map<Lamp, std::size_t> count;
  std::map<int, std::size_t> exit_codes;                      // counts of finished clips, without 0
  std::vector<std::pair<std::string, std::string>> failures;  // name and message of the first few
  double wall_s = 0.0, cpu_s = 0.0;                           // sums over clips
};

// Reads one clip after the other, so the memory does not grow with their number. Each of the three files appears as a
// whole. `may_continue` is called before each clip. If it returns false, nothing is written.
// Fails with "what happened: where: what to do".
[[nodiscard]] tl::expected<BatchTotals, std::string> collect_batch(
    const BatchFolder& folder, const std::function<bool(std::size_t)>& may_continue);

}  // namespace moiregauge::internal
