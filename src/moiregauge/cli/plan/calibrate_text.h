// SPDX-License-Identifier: Apache-2.0
// What `moiregauge calibrate` says: on the terminal, and in the camera file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "moiregauge/board/board_calibration.h"

namespace moiregauge::internal::cli {

struct CalibrateReport {
  std::vector<std::string> names;  // of the photographs, one per view
  std::string pattern;             // what is printed
  BoardCalibration solved;
};

[[nodiscard]] std::string calibrate_text(const CalibrateReport& report);

// Returns why the solved camera is no camera to measure with, as an error line without `error: `. `photos`: the input as
// given. Empty: it is one.
[[nodiscard]] std::optional<std::string> calibrate_refusal(const CalibrateReport& report, const std::string& photos);

// One line each: photographs left out, parameters that the photographs hardly determine.
[[nodiscard]] std::vector<std::string> calibrate_warnings(const CalibrateReport& report);

// What --camera reads, with the standard uncertainties in [camera.u].
[[nodiscard]] std::string camera_text(const CalibrateReport& report);

}  // namespace moiregauge::internal::cli
