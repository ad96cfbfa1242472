// SPDX-License-Identifier: Apache-2.0
// What `moiregauge inspect` prints: everything that is seen in one picture, for people.
#pragma once

#include <string>

#include "moiregauge/io/run_dir/inspect_json.h"

namespace moiregauge::internal::cli {

[[nodiscard]] std::string inspect_text(const InspectReport& report);

// "4 circles, 5 gratings, dots 10 x 10 (100 of 100)": the short form, for an error's one line.
[[nodiscard]] std::string found_in_short(const Inspection& seen);

}  // namespace moiregauge::internal::cli
