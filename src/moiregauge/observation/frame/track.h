// SPDX-License-Identifier: Apache-2.0
// Tracks a frame that agrees with the prediction, as nearly every frame does. Centroids locate the discs and templates
// the gratings; nothing is resampled. Any other frame goes through detection (docs/methods/precise/frame-reading.md).
#pragma once

#include "moiregauge/observation/frame/observe.h"

namespace moiregauge::internal {

// Reads the references at their predicted positions, and no targets. With Rows::kSome it takes a fraction of the time,
// and u is larger.
// Fails (nothing): a reference is occluded or not at its predicted position.
[[nodiscard]] std::optional<Observation> track_references(const GreyPicture& picture, const Reference& reference,
                                                          const Prediction& prediction, Rows rows = Rows::kAll);

// Reads target `i` at its predicted position, in the view through the references.
// Fails (nothing): the target must be searched.
[[nodiscard]] std::optional<MarkerObservation> track_target(const BoardPicture& now, const Reference& reference,
                                                            std::size_t i, const Prediction& prediction,
                                                            Rows rows = Rows::kAll);

}  // namespace moiregauge::internal
