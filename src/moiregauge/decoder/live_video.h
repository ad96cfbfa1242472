// SPDX-License-Identifier: Apache-2.0
// Receives the frames of a live stream (RTSP, HTTP, V4L2), which a child process decodes.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "moiregauge/decoder/stream/live_address.h"
#include "moiregauge/decoder/video_source.h"

namespace moiregauge::internal {

struct LiveVideoFrame {
  Frame frame;                  // number of this connection; luma is valid until the next call of next()
  std::int64_t host_ns = 0;     // steady_clock when it was decoded
  std::int64_t queue_full = 0;  // frames dropped so far on this connection, because the parent was too slow
  std::int64_t undecoded = 0;   // packets so far that gave no frame
};

// One connection.
class LiveVideo {
 public:
  virtual ~LiveVideo() = default;
  // Connects, and waits for the first frame. RTSP uses TCP. Fails: no answer, another kind of data.
  [[nodiscard]] static tl::expected<std::unique_ptr<LiveVideo>, InputError> open(const LiveAddress& address,
                                                                                 std::int64_t max_pixels,
                                                                                 const DecoderOptions& decoder = {});
  [[nodiscard]] virtual const InputInfo& info() const = 0;
  // Returns true if Frame::time_s is the camera's; else it is libav's guess.
  [[nodiscard]] virtual bool has_camera_times() const = 0;
  // Returns the next frame, which may be marked damaged. Returns nothing if none came within `timeout`. Fails with the
  // reason once the connection is lost.
  [[nodiscard]] virtual tl::expected<std::optional<LiveVideoFrame>, std::string> next(
      std::chrono::milliseconds timeout) = 0;
};

// Returns the address with the password replaced by three asterisks.
[[nodiscard]] std::string without_password(const std::string& url);

}  // namespace moiregauge::internal
