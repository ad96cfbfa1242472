// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace moiregauge::internal {

// The whole life of the decoding child: reads the input on its descriptor, writes pictures into the shared memory and
// records into the socket (wire.h). No picture of more than `max_pixels` is decoded. Returns the exit code.
[[nodiscard]] int decode_child(std::int64_t max_pixels);

}  // namespace moiregauge::internal
