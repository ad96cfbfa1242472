// SPDX-License-Identifier: Apache-2.0
// Creates the output of `moiregauge calibrate`: terminal text and camera file.
#pragma once

#include <string>

#include "moiregauge/app/calibrate/calibrate_photos.h"

namespace moiregauge::internal::cli {

[[nodiscard]] std::string calibrate_text(const CalibrateReport& report);

// Returns the file for --camera, with standard uncertainties in [camera.u].
[[nodiscard]] std::string camera_text(const CalibrateReport& report);

}  // namespace moiregauge::internal::cli
