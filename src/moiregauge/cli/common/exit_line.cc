// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/common/exit_line.h"

#include <cstdio>

#include <fmt/format.h>

#include "moiregauge/cli/common/terminal_text.h"

namespace moiregauge::internal::cli {

int fail(Exit exit, const std::string& message) {
  print_note(fmt::format("error: {}\n", message));
  return static_cast<int>(exit);
}

}  // namespace moiregauge::internal::cli
