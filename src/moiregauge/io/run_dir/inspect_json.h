// SPDX-License-Identifier: Apache-2.0
// Writes inspect.json, the description of all objects detected in one image (docs/file-formats.md).
#pragma once

#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "moiregauge/displacement/expected_uncertainty.h"
#include "moiregauge/observation/views/inspection.h"
#include "moiregauge/results/summary.h"
#include "moiregauge/run/frame_source.h"

namespace moiregauge::internal {

struct InspectReport {
  InputInfo input;
  long frame = 0;
  double time_s = kNotMeasured;
  Inspection seen;
  std::vector<ExpectedUncertainty> expected;  // empty without a reference frame
  Exit exit = Exit::kMeasured;
};

[[nodiscard]] nlohmann::ordered_json inspect_json(const InspectReport& report);

}  // namespace moiregauge::internal
