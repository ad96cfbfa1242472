// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/exit_line.h"

#include <cstdio>

#include <fmt/format.h>

namespace moiregauge::cli {

int fail(Exit exit, const std::string& message) {
  fmt::print(stderr, "error: {}\n", message);
  return static_cast<int>(exit);
}

}  // namespace moiregauge::cli
