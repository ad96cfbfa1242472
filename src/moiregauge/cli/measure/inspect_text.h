// SPDX-License-Identifier: Apache-2.0
// Text of `moiregauge inspect`: everything that is detected in one image.
#pragma once

#include <string>

#include "moiregauge/io/run_dir/inspect_json.h"

namespace moiregauge::internal::cli {

[[nodiscard]] std::string inspect_text(const InspectReport& report);

// Returns the short form for an error line: "4 circles, 5 gratings, dots 10 x 10 (100 of 100)".
[[nodiscard]] std::string found_in_short(const Inspection& seen);

}  // namespace moiregauge::internal::cli
