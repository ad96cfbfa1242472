// SPDX-License-Identifier: Apache-2.0
// Judgement of a solved camera: refusal and warnings.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "moiregauge/app/calibrate/calibrate_photos.h"

namespace moiregauge::internal {

// Returns the reason why the solved camera is unusable, as an error line without `error: `. Empty if it is usable.
// `photos`: the input as typed.
[[nodiscard]] std::optional<std::string> calibrate_refusal(const CalibrateReport& report, const std::string& photos);

// Returns one line per excluded photograph, and per parameter that is poorly determined.
[[nodiscard]] std::vector<std::string> calibrate_warnings(const CalibrateReport& report);

}  // namespace moiregauge::internal
