// SPDX-License-Identifier: Apache-2.0
// Prints finer in the picture than `precise` reads well.
#pragma once

#include <optional>
#include <string>

#include "moiregauge/geometry/view.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// Below these a note. A binary print's third harmonic needs 6 px for a period of its own in the pixels, and a third
// more for its template to hold it apart from the fundamental under blur and perspective; a cosine has no harmonics.
// Under kMinPitchPx (raster.h) nothing is read at all.
inline constexpr double kGoodBinaryPitchPx = 8.0;
inline constexpr double kGoodCosinePitchPx = 4.0;

// Says which print of the site is finest below its limit in the view, how fine, and what to do; nullopt when none is. A
// pattern that the site leaves open counts as binary.
[[nodiscard]] std::optional<std::string> fine_pitch_note(const Site& site, const View& view);

}  // namespace moiregauge::internal
