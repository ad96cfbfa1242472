// SPDX-License-Identifier: Apache-2.0
// Writes grey images as PNG files.
#pragma once

#include <string>

#include <tl/expected.hpp>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

// Statement of the file about its grey levels: none, or proportional to light (gAMA 1).
enum class PngTone { kUnstated, kLinear };

// Writes 8-bit images as they are. Images of 9 to 16 bits have `bits` in the sBIT chunk and the value in the low bits.
// Writes the whole file or none. Fails with the path and the reason.
[[nodiscard]] tl::expected<void, std::string> write_png(const std::string& path, const LumaView& picture, int bits,
                                                        PngTone tone = PngTone::kUnstated);

}  // namespace moiregauge::internal
