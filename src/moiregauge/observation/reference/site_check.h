// SPDX-License-Identifier: Apache-2.0
// Checks that a site agrees with itself in the reference frame: pitches and circle diameters against the circle
// spacing.
#pragma once

#include <optional>
#include <string>

namespace moiregauge::internal {

struct Reference;

// Larger differences are an error in the site file. A printer's stretch or a tape measure causes less. Chosen.
inline constexpr double kSiteTolerance = 0.02;  // relative
// The pitch of a target off the references' plane looks larger or smaller: 100 mm at a metre cause 0.1.
inline constexpr double kTargetTolerance = 0.1;    // relative
inline constexpr double kDiameterTolerance = 1.0;  // px: a circle's edge is known to about that

// Returns the text on two values of the site that disagree, or nothing if all agree.
[[nodiscard]] std::optional<std::string> site_disagreement(const Reference& reference);

}  // namespace moiregauge::internal
