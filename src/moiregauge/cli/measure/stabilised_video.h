// SPDX-License-Identifier: Apache-2.0
// --video of `measure`: DIR/stabilised.mp4. The frames are read a second time, because only the whole run tells what a
// target's displacement is and how far it goes.
#pragma once

#include <optional>

#include "moiregauge/io/run_dir/run_directory.h"
#include "moiregauge/run/measure.h"

namespace moiregauge::internal::cli {

struct VideoOptions {
  std::optional<double> exaggeration;  // none: what shows the motion best
  bool quiet = false;
};

// Leaves it out, with a note, of a run that was stopped and where the references are not known. `open` and `options`
// must outlive it.
[[nodiscard]] PutMore put_video(const VideoOptions& video, const OpenInput& open, const MeasureOptions& options);

}  // namespace moiregauge::internal::cli
