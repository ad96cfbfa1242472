// SPDX-License-Identifier: Apache-2.0
// Simulates one recording of the corpus, measures it as `moiregauge measure --site` does, and compares it with the
// truth.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "faults/fault_cases.h"

namespace moiregauge::internal::faults {

// A row is one target in one frame other than the reference frame.
struct Verdict {
  int rows = 0;
  int ok = 0;                           // `ok` in a run that was not refused
  std::map<std::string, int> statuses;  // counts of the other statuses; "refused" for all rows of a refused run
  // Silent lies (docs/accuracy.md): `ok`, with an error of more than 5 u and 0.5 um in dx or dy.
  int lies = 0;
  double worst_u = 0.0, worst_um = 0.0;  // largest error of an `ok` row, in u and um
  double median_u_um = 0.0;              // for dy in the `ok` rows
  std::string refusal;                   // reason if there is no reference frame
  std::vector<std::string> warnings;
};

// Makes and measures the recording, and returns the result. Temporary files of compressed recordings are in `folder`.
[[nodiscard]] Verdict verdict_on(const Sequence& sequence, const std::string& folder);

}  // namespace moiregauge::internal::faults
