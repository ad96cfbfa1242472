// SPDX-License-Identifier: Apache-2.0
// The words for a set of markers that `sheet` prints and `plan` judges.
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <tl/expected.hpp>

#include "moiregauge/app/measure_options.h"
#include "moiregauge/sheet/set_layout.h"

namespace moiregauge::internal::cli {

// As typed.
struct LayoutArgs {
  std::string site, pitch, pattern, span, reference_size, target_size, circle;
  std::optional<int> references, targets;
};

void add_layout_options(CLI::App& command, LayoutArgs& args);

// Width and height from "760x56mm", "0.76 x 0.056 m" or "76cm x 56mm".
[[nodiscard]] tl::expected<Extent<frame::Board>, std::string> size_mm(const std::string& text);

// A length, where one is given.
[[nodiscard]] tl::expected<double, UsageError> length_or(const char* option, const std::string& text, double otherwise);

// Where there is no --span, the widest that leaves `size` alone.
struct Room {
  std::string name;  // "A4"
  Extent<frame::Board> size;
};

// The site file's markers, or those of the layout asked for.
[[nodiscard]] tl::expected<Site, UsageError> site_of_layout(const LayoutArgs& args, const Room& room);

}  // namespace moiregauge::internal::cli
