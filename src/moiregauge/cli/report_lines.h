// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "moiregauge/run/measure.h"

namespace moiregauge::cli {

// The three lines at the end of a run: what was found, the result with its uncertainty, what to do next.
[[nodiscard]] std::string report_lines(const Measurement& measurement, const MeasureOptions& options,
                                       const std::string& output);

}  // namespace moiregauge::cli
