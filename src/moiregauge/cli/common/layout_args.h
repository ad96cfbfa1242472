// SPDX-License-Identifier: Apache-2.0
// Arguments that describe a set of markers, for `sheet` and `plan`.
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <tl/expected.hpp>

#include "moiregauge/app/measure_options.h"
#include "moiregauge/sheet/set_layout.h"

namespace moiregauge::internal::cli {

// Arguments as typed.
struct LayoutArgs {
  std::string site, pitch, pattern, span, reference_size, target_size, circle;
  std::optional<int> references, targets;
};

void add_layout_options(CLI::App& command, LayoutArgs& args);

// Reads width and height from "760x56mm", "0.76 x 0.056 m" or "76cm x 56mm".
[[nodiscard]] tl::expected<Extent<frame::Board>, std::string> size_mm(const std::string& text);

// Reads a length, if one is given.
[[nodiscard]] tl::expected<double, UsageError> length_or(const char* option, const std::string& text, double otherwise);

// Area that a layout without --span may fill.
struct Room {
  std::string name;  // "A4"
  Extent<frame::Board> size;
};

struct MarkerLayout {
  Site site;
  std::string note;                          // for the user, e.g. why there are four references; usually empty
  std::optional<sheet::SetRequest> request;  // none if a site file is given
};

// Returns the markers of the site file, or of the described layout. Without --references there are six, or four if six
// do not fit.
[[nodiscard]] tl::expected<MarkerLayout, UsageError> site_of_layout(const LayoutArgs& args, const Room& room);

}  // namespace moiregauge::internal::cli
