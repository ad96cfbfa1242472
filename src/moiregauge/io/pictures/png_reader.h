// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "moiregauge/io/pictures/picture.h"

namespace moiregauge::internal {

// A PNG of any kind in grey levels: 8 bits in bytes, 16 bits in words. Colour becomes luma, transparency is ignored.
//
// A 16-bit file with an sBIT chunk has that many bits. The PNG standard (11.3.3.4) lays them into the high bits, some
// cameras and our own writer into the low ones: a sample too large for the low bits tells the first, and is shifted
// down. (A standard file that is darker than 2^bits / 2^16 everywhere is taken for the second; nothing can be seen in
// it.) fails      kUnreadable (missing), kUnsupported (no PNG, too many pixels), kDamaged (cut or corrupt)
[[nodiscard]] PictureOrError read_png(const std::string& path, std::int64_t max_pixels = InputOptions{}.max_pixels);

}  // namespace moiregauge::internal
