// SPDX-License-Identifier: Apache-2.0
// Writes a simulated recording with its truth: `moiregauge simulate` as an application runs it.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/encoder/video_writer.h"
#include "moiregauge/simulator/simulator.h"

namespace moiregauge::internal {

struct RecordingPlan {
  std::optional<VideoFormat> video;  // none: DIR/frames/%06d.png
  simulator::Area area = simulator::Area::kWholeFrame;
  int threads = 0;
  // Receives frames written and expected, from any thread but one at a time. False stops. May be empty.
  std::function<bool(long, long)> on_progress;
};

// Writes the images, site.toml, truth.csv and truth-camera.toml, and removes those of an earlier recording. The truth is
// written last: a folder with truth.csv is complete. Files do not depend on the number of threads.
// Fails with the path and the reason.
[[nodiscard]] tl::expected<void, std::string> write_recording(const simulator::Scenario& scenario,
                                                              const RecordingPlan& plan, const std::string& folder);

}  // namespace moiregauge::internal
