// SPDX-License-Identifier: Apache-2.0
// Prints that look alike. An outline tells in which whole pitch a print stands, not whose print it is: that follows
// from where each of them stood when it was last seen.
#pragma once

#include "moiregauge/observation/frame/observe.h"

namespace moiregauge::internal {

// A target found more than half as far from its own last place as from that of another marker like it may be that
// marker: its order becomes kContradicted, and it is looked for next where it was last sure. So nothing is mistaken for
// another as long as no print goes two thirds of the way to a like one's place from one frame to the next.
void flag_ambiguous_targets(const Reference& reference, const Prediction& prediction, Observation& seen);

}  // namespace moiregauge::internal
