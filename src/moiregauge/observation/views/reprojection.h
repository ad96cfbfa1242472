// SPDX-License-Identifier: Apache-2.0
// A run as it would have been seen with a better site or lens. Readings belong to pixels; what a site and a lens decide
// is where on the board these pixels lie. So nothing is looked at again: every reading is carried to the place where
// its window would have stood, by the phase's own slope (exact to second order in how far that is).
#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/observation/reference/observations.h"

namespace moiregauge::internal {

struct Reprojected {
  Reference reference;
  Observations observations;
};

// How much a site may differ from the one a run was measured with. Beyond, its windows would have lain elsewhere.
inline constexpr double kRestatedPitch = 0.02;  // relative
inline constexpr double kRestatedAngle_deg = 1.5;
inline constexpr double kRestatedPlace =
    0.5;  // of the print's smaller side, between where it was read and where it is now

// fails  what is wrong with the site, in words, marker by marker
[[nodiscard]] tl::expected<Reprojected, std::string> reproject_observations(const Reference& reference,
                                                                            const Observations& observations,
                                                                            const Site& site, const Camera& lens);

}  // namespace moiregauge::internal
