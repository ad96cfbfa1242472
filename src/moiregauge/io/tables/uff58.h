// SPDX-License-Identifier: Apache-2.0
// Universal File Format (SDRC): dataset 164 (units), 15 (nodes), and a dataset 58 of real double-precision time
// response for every target and axis. ASCII, lines of 80 characters (the record formats are in docs/file-formats.md).
#pragma once

#include <string>

#include <tl/expected.hpp>

#include "moiregauge/io/tables/run_table.h"

namespace moiregauge::internal {

// The format has no number for "not measured".
enum class Gaps {
  kRefuse,
  kSplit,  // a dataset for every unbroken stretch, numbered by record 6's version; nothing is ever made up
};

// Node k is the k-th target, in mm on the board. An axis that no row shows is left out. Time is evenly spaced where
// every stamp lies within 5 % of a frame of its place, else every sample has its own (7 digits). fails   "what: where:
// what to do": a run without time; gaps that are not to be split
[[nodiscard]] tl::expected<std::string, std::string> uff58(const RunTable& table, Gaps gaps);

}  // namespace moiregauge::internal
