// SPDX-License-Identifier: Apache-2.0
// A frame that repeats the one before, to the last bit: a camera or a converter that had none put it there, and its time
// is not that of what it shows. With a sensor's noise no two frames are alike.
#pragma once

#include <cstdint>
#include <optional>

#include "moiregauge/image/image.h"

namespace moiregauge::internal {

class RepeatedFrames {
 public:
  // Does this frame repeat the one shown last? By every sixteenth row.
  [[nodiscard]] bool repeats(const LumaView& luma);

 private:
  std::optional<std::uint64_t> last_;
};

}  // namespace moiregauge::internal
