// SPDX-License-Identifier: Apache-2.0
// What a run keeps and says of a lossy codec.
#pragma once

#include <optional>
#include <string>

#include "moiregauge/run/measure.h"

namespace moiregauge {

// Every marker's quantiser, where it was seen in the frame; the frame's own where it was not.
void note_quantisers(const QuantiserMap& quantiser, const Site& site, const Camera& lens, Observation& seen);

// Grey levels, rms, by which pixels of the markers may be wrong, looked up where they were seen last; 0 of lossless.
[[nodiscard]] double rounding_of(const QuantiserMap& quantiser, const Site& site, const Camera& lens,
                                 const Observation& last);

// The same of markers whose quantisers are noted.
[[nodiscard]] double rounding_of(const Observation& seen);

// What the user should know about compressed footage; nothing of any other.
[[nodiscard]] std::optional<std::string> codec_note(const Measurement& measurement);

}  // namespace moiregauge
