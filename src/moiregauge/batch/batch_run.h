// SPDX-License-Identifier: Apache-2.0
// Measures many clips, several at once.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/batch/clip.h"
#include "moiregauge/batch/clip_state.h"
#include "moiregauge/batch/manifest.h"

namespace moiregauge::internal {

struct BatchProgress {
  std::size_t clips = 0;
  std::size_t skipped = 0;  // finished before
  std::size_t ended = 0;    // in this run
  std::size_t failed = 0;   // with another exit code than 0 and 5, also before
  std::size_t running = 0;
};

struct BatchRequest {
  std::string program;  // path of moiregauge
  BatchFolder folder;
  ClipOptions options;
  int jobs = 1;        // clips at the same time
  bool retry = false;  // repeats clips that failed
  // Called several times a second. False stops the batch: running clips keep their frames.
  std::function<bool(const BatchProgress&)> on_progress;
};

struct BatchEnd {
  BatchProgress progress;
  bool is_interrupted = false;
};

// Measures those clips that need it. Each is a process of its own, so a clip that crashes harms no other.
// Fails with path and reason if OUT cannot be written or no process can start. Then all clips in progress keep their
// frames.
[[nodiscard]] tl::expected<BatchEnd, std::string> measure_clips(const BatchRequest& request,
                                                                const std::vector<Clip>& clips);

}  // namespace moiregauge::internal
