// SPDX-License-Identifier: Apache-2.0
// Converts a run to a better site or lens. Readings belong to pixels, and site and lens determine the position of these
// pixels on the board. So no image is read again. Every reading moves to the new position of its window, by the
// slope of its phase. Error: second order in the distance of the two positions.
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

// Largest differences between a site and that of the run. With larger ones the windows would have been elsewhere.
// Chosen.
inline constexpr double kRestatedPitch = 0.02;  // relative
inline constexpr double kRestatedAngle_deg = 1.5;
// Distance between the old and the new position of a grating, as a share of its smaller side.
inline constexpr double kRestatedPlace = 0.5;

// Returns the run as if measured with `site` and `lens`.
// Fails: the text names the marker and its problem.
[[nodiscard]] tl::expected<Reprojected, std::string> reproject_observations(const Reference& reference,
                                                                            const Observations& observations,
                                                                            const Site& site, const Camera& lens);

// Returns the run as if measured with a part of its markers, other names or other roles. `chosen`: the new markers.
// `from`: their indices in the run's site.
// Fails: the references do not determine the view, or a target becomes a reference and its readings do not suffice.
[[nodiscard]] tl::expected<Reprojected, std::string> select_markers(const Reference& reference,
                                                                    const Observations& observations,
                                                                    const Site& chosen,
                                                                    const std::vector<std::size_t>& from);

}  // namespace moiregauge::internal
