// SPDX-License-Identifier: Apache-2.0
// A reference frame for a site whose circles do not determine a view: for a method that assumes a fixed camera.
#pragma once

#include <tl/expected.hpp>

#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// Has the site fewer reference circles than a homography needs?
[[nodiscard]] bool lacks_circles(const Site& site);

// Finds the site's gratings among those of the picture, and takes the view from their pitch. The gratings' centres
// become those that are seen (mm): the site's are priors. The board's x axis is nearest to the picture's horizontal.
// Fails when no grating of the first target's pitch is seen, or when the site fits the picture in several ways.
[[nodiscard]] tl::expected<Reference, ReferenceFailure> make_reference_by_gratings(const GreyPicture& picture,
                                                                                   const Site& site, const Camera& lens,
                                                                                   const ObserveOptions& options);

}  // namespace moiregauge::internal
