// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace moiregauge::internal {

// Runs the decoding child: reads the input from its descriptor, writes images to the shared memory and records to the
// socket (wire.h). Decodes no image of more than `max_pixels`. Frames before `first_frame` may be omitted. Returns the
// exit code.
[[nodiscard]] int decode_child(std::int64_t max_pixels, long first_frame);

// Runs the child of a live stream, whose input is a LiveAddress (live_stream.h). It connects first, and confines itself
// before it reads anything of the stream but the headers of the connection. Frames that find no free slot are dropped
// and counted, because a camera does not wait.
[[nodiscard]] int decode_live_child(std::int64_t max_pixels);

}  // namespace moiregauge::internal
