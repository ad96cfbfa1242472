// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "moiregauge/io/pictures/picture.h"

namespace moiregauge::internal {

// Reads any PNG as grey levels: 8 bits in bytes, 16 bits in words. Colour becomes luma, transparency is ignored.
//
// A 16-bit file with an sBIT chunk has that number of bits. The PNG standard (11.3.3.4) puts them in the high bits.
// Some cameras and this program's writer put them in the low bits.
// A sample too large for the low bits identifies the first kind, which is shifted down. A standard file darker than
// 2^bits / 2^16 everywhere is identified wrongly, but shows nothing anyway.
//
// Fails: kUnreadable (missing), kUnsupported (too many pixels), kDamaged (no PNG, truncated, corrupt).
[[nodiscard]] PictureOrError read_png(const std::string& path, std::int64_t max_pixels = InputOptions{}.max_pixels);

}  // namespace moiregauge::internal
