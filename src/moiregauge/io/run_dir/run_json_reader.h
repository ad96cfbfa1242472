// SPDX-License-Identifier: Apache-2.0
// Reads the input's fingerprint and the options of the results from a run.json.
#pragma once

#include <istream>
#include <optional>
#include <string>

#include "moiregauge/site/marker_choice.h"
#include "moiregauge/units/frame_range.h"

namespace moiregauge::internal {

// Returns the fingerprint, or an empty text if the file is no JSON or has none. Never throws.
[[nodiscard]] std::string input_sha256_of_run(std::istream& run_json);

// Options of the results in a run directory. `solve` may have changed them since the run was measured.
struct ResultOptions {
  std::string method;
  MarkerChoice choice;
  SearchArea area;
  std::optional<FrameRange> rest, zero;
  std::optional<double> readout_s;
  double print_scale = 1.0;
  std::optional<double> u_print_scale;
  double slow_motion = 1.0;
  std::optional<double> fps;  // after slow motion; nothing: unknown
  std::string time_source;
};

// Returns the options. Missing keys have their defaults. Fails if the file is no JSON or has no `config`. Never throws.
[[nodiscard]] std::optional<ResultOptions> options_of_results(std::istream& run_json);

}  // namespace moiregauge::internal
