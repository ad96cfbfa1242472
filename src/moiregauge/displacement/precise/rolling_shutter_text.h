// SPDX-License-Identifier: Apache-2.0
// Text about a rolling shutter.
#pragma once

#include <string>

#include "moiregauge/displacement/method.h"

namespace moiregauge::internal {

// Returns one line about a solved rolling shutter: readout time, largest correction, and largest remaining u with its
// frame.
// `relative`: readout time relative to the frame interval, for frames without times.
// `max_correction_mm`: largest error that a global shutter model would have caused.
[[nodiscard]] std::string shutter_note(const Scene& scene, bool given, double relative, double max_correction_mm,
                                       const Samples& samples);

}  // namespace moiregauge::internal
