// SPDX-License-Identifier: Apache-2.0
// A frame in which everything is where the last ones let expect it, which is nearly every frame: discs by their
// centroids, prints by their templates, nothing resampled. Whatever is not as expected is left to the long way.
#pragma once

#include "moiregauge/observation/frame/observe.h"

namespace moiregauge::internal {

// The references; targets are not looked at yet. Nothing where any of them is not whole and in its place. Some of the
// rows tell every phase in a fraction of the time, with a wider u.
[[nodiscard]] std::optional<Observation> track_references(const GreyPicture& picture, const Reference& reference,
                                                          const Prediction& prediction, Rows rows = Rows::kAll);

// One target in the view that the references tell, from where it should be by now. False: look for it.
[[nodiscard]] bool track_target(const GreyPicture& picture, const Reference& reference, const View& view, std::size_t i,
                                const Prediction& prediction, MarkerObservation& seen, Rows rows = Rows::kAll);

}  // namespace moiregauge::internal
