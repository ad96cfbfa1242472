// SPDX-License-Identifier: Apache-2.0
// Stores the recordings of alarms as lossless video (FFV1 in Matroska), which `measure` reads.
#pragma once

#include <string>

#include "moiregauge/live/record/recording_writer.h"

namespace moiregauge::internal {

// Returns a maker of recordings `folder`/NAME.mkv. It makes the folder with the first one. Time stamps are rounded to
// 1 ms. FFV1 holds 8, 9, 10, 12 or 16 bits.
[[nodiscard]] MakeRecordingWriter recording_videos(std::string folder);

}  // namespace moiregauge::internal
