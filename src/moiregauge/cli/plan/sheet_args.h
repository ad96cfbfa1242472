// SPDX-License-Identifier: Apache-2.0
// Parses the arguments of `moiregauge sheet`.
#pragma once

#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/app/measure_options.h"
#include "moiregauge/cli/common/layout_args.h"
#include "moiregauge/sheet/print_path.h"
#include "moiregauge/sheet/sheet_set.h"

namespace moiregauge::internal::cli {

// Arguments as typed.
struct SheetArgs {
  LayoutArgs layout;
  std::string paper = "A4", orientation = "auto";
  double ink_percent = 100.0, gamma = 1.0;
  std::string output = "sheets";
  bool inverted = false, separate = false, replace = false, quiet = false;
};

struct SheetOrder {
  Site site;
  sheet::PageRequest page;
  sheet::Ink ink;
  std::string note;  // for the user; may be empty
};

[[nodiscard]] tl::expected<SheetOrder, UsageError> parse_sheet_options(const SheetArgs& args);

}  // namespace moiregauge::internal::cli
