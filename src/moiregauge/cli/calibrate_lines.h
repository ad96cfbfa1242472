// SPDX-License-Identifier: Apache-2.0
// What `moiregauge calibrate` says: on the terminal, and in the camera file.
#pragma once

#include <string>
#include <vector>

#include "moiregauge/calibration/board_calibration.h"

namespace moiregauge::cli {

struct CalibrateReport {
  std::vector<std::string> names;  // of the photographs, one per view
  std::string pattern;             // what is printed
  BoardCalibration solved;
};

[[nodiscard]] std::string calibrate_lines(const CalibrateReport& report);

// One line each: photographs left out, parameters that the photographs hardly determine.
[[nodiscard]] std::vector<std::string> calibrate_warnings(const CalibrateReport& report);

// What --camera reads, with the standard uncertainties in [camera.u].
[[nodiscard]] std::string camera_text(const CalibrateReport& report);

}  // namespace moiregauge::cli
