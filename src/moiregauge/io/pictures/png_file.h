// SPDX-License-Identifier: Apache-2.0
// Grey pictures as PNG files.
#pragma once

#include <string>

#include <tl/expected.hpp>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

// The file's statement about its grey levels: nothing, or that they are light (gAMA 1).
enum class PngTone { kUnstated, kLinear };

// Writes 8-bit pictures as they are; 9 to 16 bits with `bits` noted in the file (sBIT) and the value in the low bits.
// The file appears whole or not at all. An error reads "path: why".
[[nodiscard]] tl::expected<void, std::string> write_png(const std::string& path, const LumaView& picture, int bits,
                                                        PngTone tone = PngTone::kUnstated);

}  // namespace moiregauge::internal
