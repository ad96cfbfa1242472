// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "moiregauge/observation/views/inspection.h"

namespace moiregauge::internal {

// Returns a site file of the markers that an inspection identified, with short numbers and comments. Circles and
// gratings that are no marker follow as commented entries. `title` names the image. Lengths are rounded to a hundredth
// of a pixel or finer, which the noise of a centre exceeds.
// The inspection must have a reference, and millimetres as unit.
[[nodiscard]] std::string site_draft(const Inspection& seen, const std::string& title);

}  // namespace moiregauge::internal
