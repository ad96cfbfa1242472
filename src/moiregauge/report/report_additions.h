// SPDX-License-Identifier: Apache-2.0
// Adds to a written report.html what is computed later: channels of `derive`, the comparison of `compare`.
#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/report/page_scripts.h"
#include "moiregauge/results/comparison/comparison.h"
#include "moiregauge/results/derived/layer_choices.h"

namespace moiregauge::internal {

// Largest number of channel values in a page: about 6 bytes each.
inline constexpr double kMaxPageValues = 1e6;

// Returns the channels with every choice of layers. `choices`: not empty.
[[nodiscard]] PageScript derived_script(const std::vector<Layer>& layers, const std::vector<LayerChoice>& choices);

// Returns the rows of a comparison. `json`: comparison.json, whose figures the page shows.
[[nodiscard]] PageScript comparison_script(const Comparison& comparison, const std::string& json);

// Replaces a script in FOLDER/report.html and leaves all other data of the page as they are. Returns the path.
// Fails with "what: path: what to do". `can_write` is false if the disk refused it, and true if the folder has no
// report or another file of this name.
struct UnchangedReport {
  bool can_write = true;
  std::string message;
};
[[nodiscard]] tl::expected<std::string, UnchangedReport> update_report(const std::string& folder,
                                                                       const PageScript& script);

}  // namespace moiregauge::internal
