// SPDX-License-Identifier: Apache-2.0
// One clear line on stderr and the right exit code.
#pragma once

#include <string>

#include "moiregauge/results/summary.h"

namespace moiregauge::internal::cli {

// Prints "error: <message>" and gives the code to return.
int fail(Exit exit, const std::string& message);

}  // namespace moiregauge::internal::cli
