// SPDX-License-Identifier: Apache-2.0
// Selection of the scene model by BIC.
#pragma once

#include <optional>
#include <span>

#include "moiregauge/calibration/scene/bundle.h"

namespace moiregauge::internal {

// Quality of the gratings. Errors of rough gratings are the same in every view, so chi2 is no likelihood. Heights then
// bend to them and must satisfy BIC. On a photographed board nine gratings otherwise scattered by 10 um instead of 2.6
// um.
enum class Prints { kPerfect, kRough };

struct Selection {
  Prints prints = Prints::kPerfect;
  Until until = Until::kConverged;
};

// Selects the scene model by BIC (Schwarz 1978), without tilts: each added parameter must lower the cost by ln(n), for n
// residuals. Starts from the last accepted solution.
// Fails (nothing): no model can be solved with a focal length between 0.15 and 50 times the image's larger side.
[[nodiscard]] std::optional<BundleSolution> select_scene_model(const Site& site, std::span<const BundleFrame> frames,
                                                               const ScenePrior& prior, const Selection& selection);

// Solves again with the tilts of all prints.
// Fails (nothing): they do not satisfy BIC, or explain too small a share of the residuals beyond noise.
[[nodiscard]] std::optional<BundleSolution> with_tilts(const Site& site, std::span<const BundleFrame> frames,
                                                       const ScenePrior& prior, const Selection& selection,
                                                       const BundleSolution& without);

// Returns by how much the tilts lower the excess of chi2 per degree of freedom over 1, relative to it.
[[nodiscard]] double share_of_excess(const Scene& without, const Scene& with);

}  // namespace moiregauge::internal
