// SPDX-License-Identifier: Apache-2.0
// Draws the figures of a comparison with another sensor.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/drawing/figures/figure_run.h"
#include "moiregauge/results/comparison/comparison.h"

namespace moiregauge::internal::figure {

// Returns three figures. `series` shows both records over time. `difference` shows the difference with the band of U
// (k = 2). `bland-altman` shows the difference against the mean of both, with the limits of agreement about the bias.
[[nodiscard]] std::vector<NamedFigure> comparison_figures(const Comparison& comparison, const std::string& channel,
                                                          const std::string& unit);

}  // namespace moiregauge::internal::figure
