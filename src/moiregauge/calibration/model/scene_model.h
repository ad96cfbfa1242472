// SPDX-License-Identifier: Apache-2.0
// The ladder of models: how much of the lens the footage demands.
#pragma once

#include <optional>
#include <span>

#include "moiregauge/calibration/scene/bundle.h"

namespace moiregauge::internal {

// Whether prints are rough beyond noise. Their errors are the same in every view and alike in neighbours, so chi2 is no
// likelihood any more: heights then bend to them (nine patches of a photographed board scattered by 10 um instead of
// 2.6), and are solved only where they pay.
enum class Prints { kPerfect, kRough };

// The scene of the largest model that pays for its parameters (Schwarz 1978: ln(rows) each), solved from where the last
// one accepted ended; none when no model can be solved.
[[nodiscard]] std::optional<BundleSolution> select_scene_model(const Site& site, std::span<const BundleFrame> frames,
                                                               const ScenePrior& prior, Prints prints,
                                                               Until until = Until::kConverged);

}  // namespace moiregauge::internal
