// SPDX-License-Identifier: Apache-2.0
// What the layout and the footage cannot show, and what would show it.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "moiregauge/calibration/model/calibrate.h"
#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

// One line for the target that is worst off, where its layout tells one axis several times worse than the other:
// "references span 0.06 of their width in height: u_dx of 'mid' cannot be below 2.0 um, u_dy below 0.4 um: ..."
[[nodiscard]] std::optional<std::string> weak_axis_note(const Reference& reference);

// One line where prints are stretched along one axis beyond what the site says of their scale, for then neither axis'
// pitch is known.
[[nodiscard]] std::optional<std::string> stretched_prints_note(const Site& site, const Calibration& calibration);

// One line where the camera turns and goes so little in these frames that its lens was hardly put to the test.
[[nodiscard]] std::optional<std::string> still_camera_note(const Scene& scene, std::span<const BundleFrame> frames);

}  // namespace moiregauge::internal
