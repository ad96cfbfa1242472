// SPDX-License-Identifier: Apache-2.0
// Expected uncertainty of a measurement, from its reference frame alone.
#pragma once

#include <span>
#include <vector>

#include "moiregauge/displacement/sample.h"
#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// Standard uncertainties (k = 1) of a target's displacement since the reference frame along the board's axes, mm.
// Included: noise of both frames, and a lossy codec. Not included: lens, depth and a bent board, which show only if the
// camera moves.
// NaN: the target was not seen, or its grating does not show this axis.
struct ExpectedUncertainty {
  std::size_t marker = 0;      // index in the site
  Extent<frame::Board> u;      // by the two-stage method in frames like this one, with the codec's part
  Extent<frame::Board> codec;  // the codec's part; 0: lossless
  Extent<frame::Board> bound;  // Cramer-Rao bound: fundamentals over all pixels of the gratings, all references
};

// Returns one entry for every target with a grating, in the site's order.
// `later`: the quantiser at every marker in later frames, which may be predicted. Empty: as in the reference frame.
[[nodiscard]] std::vector<ExpectedUncertainty> expected_uncertainties(const Reference& reference,
                                                                      std::span<const Quantiser> later);

}  // namespace moiregauge::internal
