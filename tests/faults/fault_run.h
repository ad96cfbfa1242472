// SPDX-License-Identifier: Apache-2.0
// One recording of the corpus made, measured as `moiregauge measure --site` does, and judged against the truth.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "faults/fault_cases.h"

namespace moiregauge::internal::faults {

// A row is one target in one frame other than the reference frame.
struct Verdict {
  int rows = 0;
  int ok = 0;                            // called `ok` in a run that was not refused
  std::map<std::string, int> statuses;   // of the others; "refused" for a run that was
  int lies = 0;                          // DESIGN 5: `ok`, and in dx or dy an error of more than 5 u and 0.5 um
  double worst_u = 0.0, worst_um = 0.0;  // largest error of an `ok` row, in u and um
  double median_u_um = 0.0;              // of dy of the `ok` rows
  std::string refusal;                   // why there is no reference frame
  std::vector<std::string> warnings;
};

// Temporary files of compressed recordings go into `folder`.
[[nodiscard]] Verdict verdict_on(const Sequence& sequence, const std::string& folder);

}  // namespace moiregauge::internal::faults
