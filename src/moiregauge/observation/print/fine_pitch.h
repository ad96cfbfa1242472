// SPDX-License-Identifier: Apache-2.0
// Finds gratings that are too fine in the image for `precise`.
#pragma once

#include <optional>
#include <string>

#include "moiregauge/geometry/view.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// Pitches below which a note appears, px. The third harmonic of a binary grating needs 6 px for a period of two pixels.
// Its template needs a third more to separate it from the fundamental under blur and perspective. A cosine has no
// harmonics. Below kMinPitchPx (raster.h) nothing is read. Chosen.
inline constexpr double kGoodBinaryPitchPx = 8.0;
inline constexpr double kGoodCosinePitchPx = 4.0;

// Returns a note on the grating that is finest relative to its limit: its pitch and a remedy. Returns nothing if none
// is below its limit. A pattern that the site does not state counts as binary.
[[nodiscard]] std::optional<std::string> fine_pitch_note(const Site& site, const View& view);

}  // namespace moiregauge::internal
