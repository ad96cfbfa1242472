// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace moiregauge::internal {

// Runs the decoding child: reads the input from its descriptor, writes images to the shared memory and records to the
// socket (wire.h). Decodes no image of more than `max_pixels`. Returns the exit code.
[[nodiscard]] int decode_child(std::int64_t max_pixels);

}  // namespace moiregauge::internal
