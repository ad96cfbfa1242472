// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace moiregauge {

// The whole life of the decoding child: reads the input on its descriptor, writes pictures into the shared memory and
// records into the socket (wire.h). Returns the exit code.
[[nodiscard]] int decode_child();

}  // namespace moiregauge
