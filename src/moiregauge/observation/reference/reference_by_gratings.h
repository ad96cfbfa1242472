// SPDX-License-Identifier: Apache-2.0
// Makes a reference frame for a site whose circles do not determine a view, for a method that assumes a fixed camera.
#pragma once

#include <tl/expected.hpp>

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// Returns true if the site has fewer reference circles than a homography needs.
[[nodiscard]] bool lacks_circles(const Site& site);

// Finds the site's gratings in the image and takes the view from their pitch. The gratings' centres become those
// detected (mm), because the site's are priors. The board's x axis is nearest to the image's horizontal.
// Fails: no grating of the first target's pitch is detected, or the site fits the image in several ways.
[[nodiscard]] tl::expected<Reference, ReferenceFailure> make_reference_by_gratings(const GreyPicture& picture,
                                                                                   const Site& site, const Camera& lens,
                                                                                   const ObserveOptions& options);

}  // namespace moiregauge::internal
