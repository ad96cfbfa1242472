// SPDX-License-Identifier: Apache-2.0
// Detects frames that repeat the previous frame to the last bit. A camera or converter inserts them, and their content
// is older than their time stamp. Sensor noise makes all other frames differ.
#pragma once

#include <cstdint>
#include <optional>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

class RepeatedFrames {
 public:
  // Returns true if this frame repeats the last one passed in. Compares every 16th row.
  [[nodiscard]] bool repeats(const LumaView& luma);

 private:
  std::optional<std::uint64_t> last_;
};

}  // namespace moiregauge::internal
