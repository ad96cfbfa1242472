// SPDX-License-Identifier: Apache-2.0
// Calibration of a camera from photographs of a board: `moiregauge calibrate` as an application runs it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/app/measurement_run.h"
#include "moiregauge/board/board_calibration.h"

namespace moiregauge::internal {

struct CalibrateReport {
  std::vector<std::string> names;  // file names of the photographs, one per view
  std::string pattern;             // pattern of the board
  BoardCalibration solved;
};

// Solves the camera from photographs, or folders of them. `on_progress`: photographs read and expected; may be empty.
// Fails: an unreadable photograph, or no usable view.
[[nodiscard]] tl::expected<CalibrateReport, RunFailure> calibrate_photos(
    const std::vector<std::string>& photos, double pitch_mm, const BoardOptions& options,
    const std::function<void(long, long)>& on_progress);

}  // namespace moiregauge::internal
