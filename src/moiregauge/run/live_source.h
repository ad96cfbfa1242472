// SPDX-License-Identifier: Apache-2.0
// Interface of a source whose frames come at their own time. Implementations: `camera` (GenICam, V4L2, network streams,
// y4m on stdin) and `live` (a recording replayed at its own pace).
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

#include "moiregauge/run/frame_source.h"

namespace moiregauge::internal {

// Frames that were never delivered, counted since the source was opened.
struct LostFrames {
  long queue_full = 0;  // they came while the bounded queue was full, because measuring was too slow
  long incomplete = 0;  // packets or lines are missing
  long in_camera = 0;   // gaps in the camera's frame numbers that neither of the others explains
  // They came while the reference frame was learned, which takes as long as many frames. The measurement counts them;
  // sources leave it at 0.
  long starting = 0;
  long reconnects = 0;  // times the connection was lost and made again; frames in between are not counted
  [[nodiscard]] long frames() const { return queue_full + incomplete + in_camera + starting; }
  friend bool operator==(const LostFrames&, const LostFrames&) = default;
};

struct LiveFrame {
  // Number: counts every frame that the camera sent, lost ones included, as far as the source knows them. Time: s since
  // frame 0, by the camera's clock if it has one, else by the host's monotonic clock. Luma: valid until the next call of
  // next().
  Frame frame;
  std::optional<std::int64_t> device_ns;  // time stamp of the camera, ns on its own clock
  std::int64_t host_ns = 0;               // std::chrono::steady_clock when the frame was complete, ns
  int queued = 0;                         // complete frames that wait behind this one
};

// The end of a source. No frame comes after it.
struct SourceEnd {
  enum class Kind {
    kFinished,  // a recording or a pipe came to its regular end
    kLost,      // the camera or the connection was lost and stays lost (exit 7)
  };
  Kind kind = Kind::kFinished;
  std::string message;  // kLost: "what happened: where: what to do"
};

// One thread calls all functions. A source queues a bounded number of complete frames. It drops and counts further
// frames, and never blocks the camera. A pipe drops nothing: its writer waits.
class LiveSource {
 public:
  virtual ~LiveSource() = default;
  // Returns the block `input` of run.json. Size and depth are known and constant from the start. `time_source` is
  // "camera" or "host". `frames` is -1. `start_utc` is the host's clock at frame 0.
  [[nodiscard]] virtual const InputInfo& info() const = 0;
  // Waits for the next frame. Returns nothing if none came within `timeout`.
  // Fails: the source ended. Every later call fails with the same end.
  [[nodiscard]] virtual tl::expected<std::optional<LiveFrame>, SourceEnd> next(std::chrono::milliseconds timeout) = 0;
  // Returns the frames lost so far.
  [[nodiscard]] virtual LostFrames lost() const = 0;
  // Returns true if the pixels of the last frame were intact while it was measured (FrameSource::is_frame_whole).
  [[nodiscard]] virtual bool is_frame_whole() const { return true; }
  // Returns settings for live.json, e.g. {"exposure_us", "500"}. Keys are unique and carry their unit.
  [[nodiscard]] virtual std::vector<std::pair<std::string, std::string>> settings() const { return {}; }
};

}  // namespace moiregauge::internal
