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

// Selects the scene model by BIC (Schwarz 1978): each added parameter must lower the cost by ln(n), for n residuals.
// Starts from the last accepted solution.
// Fails (nothing): no model can be solved with a focal length between 0.15 and 50 times the image's larger side.
[[nodiscard]] std::optional<BundleSolution> select_scene_model(const Site& site, std::span<const BundleFrame> frames,
                                                               const ScenePrior& prior, Prints prints,
                                                               Until until = Until::kConverged);

}  // namespace moiregauge::internal
