// SPDX-License-Identifier: Apache-2.0
// --video of `measure`: DIR/stabilised.mp4. The frames are read a second time, because only the finished run determines
// each target's displacement and its range.
#pragma once

#include <optional>

#include "moiregauge/app/run_progress.h"
#include "moiregauge/io/run_dir/run_directory.h"
#include "moiregauge/run/measure.h"

namespace moiregauge::internal {

// Returns the writer of the video. exaggeration: factor on the targets' motion; empty: chosen so that motion shows.
// Writes no video, and notes it, where the run was stopped or the references are unknown. All arguments but the first
// must outlive the writer.
[[nodiscard]] PutMore put_video(std::optional<double> exaggeration, const OpenInput& open,
                                const MeasureOptions& options, const RunCallbacks& callbacks);

}  // namespace moiregauge::internal
