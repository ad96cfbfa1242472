// SPDX-License-Identifier: Apache-2.0
// What the user is told of a rolling shutter.
#pragma once

#include <string>

#include "moiregauge/displacement/method.h"

namespace moiregauge::internal {

// "rolling shutter: rows are read over 18.00 ms (solved, u 0.40 ms): up to 0.310 mm were corrected, 0.0130 mm are left in
// u at worst (frame 52)".
// relative       the readout as a part of the time between frames: what is told where frames have no times
// max_correction_mm   what the same frames would have been wrong by, taken for rows read at once
[[nodiscard]] std::string shutter_note(const Scene& scene, bool given, double relative, double max_correction_mm,
                                       const Samples& samples);

}  // namespace moiregauge::internal
