// SPDX-License-Identifier: Apache-2.0
// Opens the SOURCE of `moiregauge live`.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "moiregauge/app/measurement_run.h"
#include "moiregauge/camera/open_camera.h"
#include "moiregauge/run/live_source.h"

namespace moiregauge::internal {

// A source before its first frame: a recording or a camera.
struct OpenedSource {
  std::unique_ptr<FrameSource> recording;
  std::unique_ptr<LiveSource> camera;
  [[nodiscard]] const InputInfo& info() const { return recording ? recording->info() : camera->info(); }
};

// Opens a recording. `pace`: --pace, missing if it was not given.
// Fails: the recording cannot be opened, or it has no pace, or no times to replay it by.
[[nodiscard]] tl::expected<OpenedSource, RunFailure> open_recording(const std::string& source,
                                                                    const InputOptions& options,
                                                                    std::optional<double> pace);

// Opens a camera, a network stream or a pipe. Fails: it cannot be opened, or an option does not apply to it.
[[nodiscard]] tl::expected<OpenedSource, RunFailure> open_live_camera(const CameraArgs& args,
                                                                      std::optional<double> pace);

// Position of a resumed run: frames and time that have passed.
struct PassedFrames {
  long last = -1;       // number of the last frame
  double time_s = 0.0;  // s since frame 0, at which a camera continues
};

// Starts the source. A recording replays at `pace` after the passed frames. A camera continues numbers and times.
[[nodiscard]] std::unique_ptr<LiveSource> started(OpenedSource opened, double pace, const PassedFrames& passed);

}  // namespace moiregauge::internal
