// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "moiregauge/io/picture.h"

namespace moiregauge {

// A PNG of any kind in grey levels: 8 bits in bytes, 16 bits in words. Colour becomes luma, transparency is ignored.
//
// A 16-bit file whose sBIT chunk says that fewer bits are significant is shifted back to them, as the PNG standard
// (11.3.3.4) lays them into the high bits; without sBIT it has 16.
// fails      kUnreadable (missing), kUnsupported (no PNG, too many pixels), kDamaged (cut or corrupt)
[[nodiscard]] PictureOrError read_png(const std::string& path);

}  // namespace moiregauge
