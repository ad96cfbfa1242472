// SPDX-License-Identifier: Apache-2.0
// One clear line on stderr and the right exit code.
#pragma once

#include <string>

#include "moiregauge/results/summary.h"

namespace moiregauge::internal::cli {

// Prints "error: <message>" and gives the code to return.
int fail(Exit exit, const std::string& message);

// The message about a text file of which every line of `lines` tells one mistake and its place: one line that says
// which file is wrong, then those. kind: "site file".
[[nodiscard]] std::string mistakes_in(const std::string& kind, const std::string& path, const std::string& lines);

}  // namespace moiregauge::internal::cli
