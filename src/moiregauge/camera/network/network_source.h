// SPDX-License-Identifier: Apache-2.0
// Network cameras (RTSP, HTTP) and V4L2 devices as a LiveSource.
#pragma once

#include <chrono>
#include <memory>

#include <tl/expected.hpp>

#include "moiregauge/decoder/live_video.h"
#include "moiregauge/run/live_source.h"

namespace moiregauge::internal {

struct NetworkOptions {
  std::int64_t max_pixels = 64'000'000;                           // --max-pixels
  std::chrono::milliseconds patience = std::chrono::seconds(60);  // until a lost stream ends the source
};

// Opens a stream, and connects again with increasing intervals once it is lost.
//
// Damaged frames are counted as incomplete and never delivered. Numbers continue after a new connection, although the
// frames in between are unknown. Times are those of the stream. The host's clock replaces them where the stream has
// none, and bridges a lost connection.
[[nodiscard]] tl::expected<std::unique_ptr<LiveSource>, InputError> open_network(const LiveAddress& address,
                                                                                 const NetworkOptions& options,
                                                                                 const DecoderOptions& decoder = {});

}  // namespace moiregauge::internal
