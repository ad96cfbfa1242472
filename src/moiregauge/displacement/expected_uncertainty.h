// SPDX-License-Identifier: Apache-2.0
// What a measurement will be good for, told from its reference frame alone.
#pragma once

#include <span>
#include <vector>

#include "moiregauge/displacement/sample.h"
#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// Standard uncertainties (k = 1) of a target's displacement since the reference frame along the board's axes, mm, of
// both frames' noise and of a lossy codec. Not included: a lens, depth or a bent board, which show only when the camera
// moves. NaN where the target was not seen or its print cannot show that axis.
struct ExpectedUncertainty {
  std::size_t marker = 0;      // index in the site
  Extent<frame::Board> u;      // of the two-stage method in frames as good as this one, the codec's share included
  Extent<frame::Board> codec;  // the codec's share; 0: nothing was lost
  Extent<frame::Board> bound;  // phase bound: fundamentals over every pixel of the printed patches, all references
};

// One for every target with a grating, in the site's order. `later`: the quantiser at every marker in the frames to
// come, which may be predicted where the reference frame is not; empty: as in the reference frame.
[[nodiscard]] std::vector<ExpectedUncertainty> expected_uncertainties(const Reference& reference,
                                                                      std::span<const Quantiser> later);

}  // namespace moiregauge::internal
