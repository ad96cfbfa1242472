// SPDX-License-Identifier: Apache-2.0
#include "moiregauge/cli/common/exit_line.h"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>

#include "moiregauge/cli/common/terminal_text.h"

namespace moiregauge::internal::cli {

int fail(Exit exit, const std::string& message) {
  print_note(fmt::format("error: {}\n", message));
  return static_cast<int>(exit);
}

std::string mistakes_in(const std::string& kind, const std::string& path, const std::string& lines) {
  const auto count = 1 + std::count(lines.begin(), lines.end(), '\n');
  return fmt::format("{}: {}: correct {}\n{}", kind, path,
                     count == 1 ? "this mistake:" : fmt::format("these {} mistakes:", count), lines);
}

}  // namespace moiregauge::internal::cli
