// SPDX-License-Identifier: Apache-2.0
// Creates the output of `moiregauge calibrate`: terminal text and camera file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "moiregauge/board/board_calibration.h"

namespace moiregauge::internal::cli {

struct CalibrateReport {
  std::vector<std::string> names;  // file names of the photographs, one per view
  std::string pattern;             // pattern of the board
  BoardCalibration solved;
};

[[nodiscard]] std::string calibrate_text(const CalibrateReport& report);

// Returns the reason why the solved camera is unusable, as an error line without `error: `. Empty if it is usable.
// `photos`: the input as typed.
[[nodiscard]] std::optional<std::string> calibrate_refusal(const CalibrateReport& report, const std::string& photos);

// Returns one line per excluded photograph, and per parameter that is poorly determined.
[[nodiscard]] std::vector<std::string> calibrate_warnings(const CalibrateReport& report);

// Returns the file for --camera, with standard uncertainties in [camera.u].
[[nodiscard]] std::string camera_text(const CalibrateReport& report);

}  // namespace moiregauge::internal::cli
