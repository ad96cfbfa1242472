// SPDX-License-Identifier: Apache-2.0
// Finds targets that may be confused with a similar one (docs/methods/precise/fringe-order.md). An outline determines
// the fringe order of a grating, but not its marker. The marker follows from the last position of each grating.
#pragma once

#include "moiregauge/observation/frame/observe.h"

namespace moiregauge::internal {

// Sets the order of ambiguous targets to kContradicted, so that they are searched again at their last certain
// positions. A target is ambiguous if it moved half a pitch or more, and more than half its distance to a similar
// marker's last position. So none is mistaken for another as long as none moves two thirds of the way to a similar one
// between frames.
void flag_ambiguous_targets(const Reference& reference, const Prediction& prediction, Observation& seen);

}  // namespace moiregauge::internal
