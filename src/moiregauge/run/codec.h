// SPDX-License-Identifier: Apache-2.0
// Records the quantiser of a lossy codec for each marker, and reports it.
#pragma once

#include <cmath>
#include <optional>
#include <string>

#include "moiregauge/run/measure.h"

namespace moiregauge::internal {

// Rectangle in the image as displayed, px. The default is empty.
struct PixelRectangle {
  double x0 = INFINITY, y0 = INFINITY, x1 = -INFINITY, y1 = -INFINITY;
};
// Returns the bounding rectangle of a marker's grating, or of its circle if it has no grating. `shift` is the marker's
// displacement, mm.
[[nodiscard]] PixelRectangle rectangle_round(const Marker& marker, Extent<frame::Board> shift, const View& view);

// Stores in `seen` the quantiser at each marker. Markers that were not found get the quantiser of the whole frame.
void note_quantisers(const QuantiserMap& quantiser, const Site& site, const Camera& lens, Observation& seen);

// Returns the rms error of marker pixels by quantisation, in grey levels (or in light levels, if the recording is
// mapped to light). Uses the marker positions of `last`. Returns 0 for a lossless codec.
[[nodiscard]] double rounding_of(const QuantiserMap& quantiser, const Reference& reference, const Observation& last);

// Returns the same for markers whose quantisers are stored in `seen`.
[[nodiscard]] double rounding_of(const Reference& reference, const Observation& seen);

// Returns true if a codec lost information in this frame, or in any of these frames.
[[nodiscard]] bool is_lossy(const Observation& seen);
[[nodiscard]] bool is_lossy(const Observations& observations);

// Returns a note on the effect of compression for the user. Returns nothing for uncompressed and lossless input.
[[nodiscard]] std::optional<std::string> codec_note(const Measurement& measurement);

}  // namespace moiregauge::internal
