// SPDX-License-Identifier: Apache-2.0
// Writes the Universal File Format (SDRC): dataset 164 (units), 15 (nodes), and a dataset 58 (real double-precision
// time response) for every target and axis. ASCII, lines of 80 characters (record formats: docs/file-formats.md).
#pragma once

#include <string>

#include <tl/expected.hpp>

#include "moiregauge/io/tables/run_table.h"
#include "moiregauge/results/modes/mode_shapes.h"

namespace moiregauge::internal {

// The format has no value for "not measured".
enum class Gaps {
  kRefuse,
  kSplit,  // one dataset per unbroken stretch, numbered by the version in record 6; no value is interpolated
};

// Returns the file. Node k is the k-th target, in mm on the board. An axis without values is omitted.
// Times are evenly spaced if every time stamp is within 5 % of a frame interval. Otherwise every sample has its own (6
// digits).
// Fails with "what happened: where: what to do": a run without times, or gaps with kRefuse.
[[nodiscard]] tl::expected<std::string, std::string> uff58(const RunTable& table, Gaps gaps);

// Returns a file with one complex spectrum (dataset 58, function 12) per target and axis: its value in mm at every
// peak, at uneven frequencies. Amplitude: ratio times the amplitude of the peak's reference. Phase: that to the
// reference. `shapes`: at least one. Their targets are the table's markers.
[[nodiscard]] std::string uff58_of_modes(const RunTable& table, const std::vector<ModeShape>& shapes);

}  // namespace moiregauge::internal
