// SPDX-License-Identifier: Apache-2.0
// What a run keeps and says of a lossy codec.
#pragma once

#include <cmath>
#include <optional>
#include <string>

#include "moiregauge/run/measure.h"

namespace moiregauge::internal {

// In the picture as displayed, px.
struct PixelRectangle {
  double x0 = INFINITY, y0 = INFINITY, x1 = -INFINITY, y1 = -INFINITY;
};
// Returns the rectangle round a marker's print (its circle where it has none), which moved by `shift`, mm.
[[nodiscard]] PixelRectangle rectangle_round(const Marker& marker, Extent<frame::Board> shift, const View& view);

// Every marker's quantiser, where it was seen in the frame; the frame's own where it was not.
void note_quantisers(const QuantiserMap& quantiser, const Site& site, const Camera& lens, Observation& seen);

// Grey levels (light, where the recording is mapped to it), rms, by which pixels of the markers may be wrong, looked up where they were seen last; 0 of lossless.
[[nodiscard]] double rounding_of(const QuantiserMap& quantiser, const Reference& reference, const Observation& last);

// The same of markers whose quantisers are noted.
[[nodiscard]] double rounding_of(const Reference& reference, const Observation& seen);

// Did a codec lose anything of these frames?
[[nodiscard]] bool is_lossy(const Observations& observations);

// What the user should know about compressed footage; nothing of any other.
[[nodiscard]] std::optional<std::string> codec_note(const Measurement& measurement);

}  // namespace moiregauge::internal
