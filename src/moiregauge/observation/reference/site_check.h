// SPDX-License-Identifier: Apache-2.0
// Does the site agree with itself, as seen in the reference frame? Pitch against circle spacing, circles against spacing.
#pragma once

#include <optional>
#include <string>

namespace moiregauge::internal {

struct Reference;

// Values that differ by more than this are a wrong site file, not a printer's stretch or a tape measure's.
inline constexpr double kSiteTolerance = 0.02;  // relative
// A target that stands off the references' plane shows its pitch larger or smaller: 100 mm at a metre.
inline constexpr double kTargetTolerance = 0.1;    // relative
inline constexpr double kDiameterTolerance = 1.0;  // px, a circle's edge is not known better

// Says which two values of the site disagree; nullopt when all agree.
[[nodiscard]] std::optional<std::string> site_disagreement(const Reference& reference);

}  // namespace moiregauge::internal
