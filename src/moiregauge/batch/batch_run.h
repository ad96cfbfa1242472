// SPDX-License-Identifier: Apache-2.0
// Measures many clips, several at once.
#pragma once

#include <chrono>
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
  std::size_t busy = 0;  // to measure here, but another process is measuring them
};

struct BatchRequest {
  std::string program;  // path of moiregauge
  BatchFolder folder;
  ClipOptions options;
  int jobs = 1;        // clips at the same time
  bool retry = false;  // repeats clips that failed
  // Called several times a second. False stops the batch: running clips keep their frames.
  std::function<bool(const BatchProgress&)> on_progress;
  // Time to wait, after all other clips, for clips that other processes measure. A killed batch leaves processes that
  // end within 15 s (clip_job.cc).
  std::chrono::milliseconds patience{15'000};
};

struct BatchEnd {
  BatchProgress progress;
  bool is_interrupted = false;
  std::vector<std::string> busy;  // names of clips that other processes are measuring. They are skipped
};

// Measures those clips that need it. Each is a process of its own, so a clip that crashes harms no other. A clip that
// another process is measuring comes last, and is skipped if that process does not end within `patience`.
// Fails with path and reason if OUT cannot be written or no process can start. Then all clips in progress keep their
// frames.
[[nodiscard]] tl::expected<BatchEnd, std::string> measure_clips(const BatchRequest& request,
                                                                const std::vector<Clip>& clips);

}  // namespace moiregauge::internal
