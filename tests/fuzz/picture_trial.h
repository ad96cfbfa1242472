// SPDX-License-Identifier: Apache-2.0
// Requirements on all readers of images.
#pragma once

#include "moiregauge/io/pictures/picture.h"
#include "tests/fuzz/input_file.h"

namespace moiregauge::internal::fuzz {

// Pixels. A header may state images of 250 MB, which take 0.1 s per trial without testing more code.
inline constexpr std::uint64_t kMaxTrialPixels = 1U << 22U;

// Reads all pixels, so that the sanitizer detects any outside their memory.
inline void look_at(const PictureOrError& picture) {
  if (!picture) return demand(!picture.error().message.empty());
  demand(picture->bits >= 8 && picture->bits <= 16 && picture->rotation_deg % 90 == 0);
  unsigned all = 0;
  const LumaView luma = view_of(*picture);
  std::visit(
      [&](const auto& view) {
        demand(view.width > 0 && view.height > 0);
        for (int y = 0; y < view.height; ++y) {
          for (const auto grey : view.row(y)) all |= grey;
        }
      },
      luma);
  demand(all < 1U << 16U);
}

}  // namespace moiregauge::internal::fuzz
