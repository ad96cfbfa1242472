// SPDX-License-Identifier: Apache-2.0
// `moiregauge live` as an application runs it: opens a live source, measures and publishes until it ends, stores and
// solves the run.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "moiregauge/app/live/live_store.h"
#include "moiregauge/camera/open_camera.h"
#include "moiregauge/live/live_loop.h"

namespace moiregauge::internal {

struct LiveRequest {
  std::string source;          // SOURCE as typed
  InputOptions input_options;  // for a recording
  CameraArgs camera;           // for a camera; `source`, `fps` and `max_pixels` are set from the above
  std::optional<double> pace;  // for a recording; 0: as fast as it is measured
  MeasureOptions options;
  LiveStoreOptions store;
  double max_s = std::numeric_limits<double>::infinity();
  std::vector<Publisher*> publishers;  // owned by the caller
  FrameSink* recorder = nullptr;       // owned by the caller; may be null
};

struct LiveCallbacks {
  std::function<bool()> should_stop;
  std::function<void()> on_solving;  // the source has ended, and the run is solved
};

struct FinishedLive {
  LiveStored stored;
  LiveEnd end;
  LiveHealth health;
  LiveRun run;  // empty without a reference frame
  Exit exit = Exit::kInternalError;
  std::vector<std::string> warnings;  // if the run has segments
};

// Fails without results where source, output or options do not allow a measurement.
[[nodiscard]] tl::expected<FinishedLive, RunFailure> run_live(const LiveRequest& request,
                                                              const LiveCallbacks& callbacks);

}  // namespace moiregauge::internal
