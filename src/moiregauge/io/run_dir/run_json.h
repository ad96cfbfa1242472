// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "moiregauge/run/measure.h"

namespace moiregauge::internal {

inline constexpr int kRunSchema = 1;

// Returns run.json (docs/file-formats.md, docs/schema/run.schema.json). Unknown values are null.
[[nodiscard]] nlohmann::ordered_json run_json(const Measurement& measurement, const MeasureOptions& options);

}  // namespace moiregauge::internal
