// SPDX-License-Identifier: Apache-2.0
// The words of `moiregauge sheet`, and what they mean.
#pragma once

#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/cli/measure_options.h"
#include "moiregauge/sheet/print_path.h"
#include "moiregauge/sheet/set_layout.h"
#include "moiregauge/sheet/sheet_set.h"

namespace moiregauge::cli {

// As typed.
struct SheetWords {
  std::string site, pitch, pattern, paper = "A4", orientation = "auto", span, reference_size, target_size, circle;
  std::optional<int> references, targets;
  double ink_percent = 100.0, gamma = 1.0;
  std::string output = "sheets";
  bool inverted = false, separate = false, replace = false, quiet = false;
};

// Width and height from "760x56mm", "0.76 x 0.056 m" or "76cm x 56mm".
[[nodiscard]] tl::expected<Extent<frame::Board>, std::string> size_mm(const std::string& text);

struct SheetOrder {
  Site site;
  sheet::PageRequest page;
  sheet::Ink ink;
};

[[nodiscard]] tl::expected<SheetOrder, UsageError> understood(const SheetWords& words);

}  // namespace moiregauge::cli
