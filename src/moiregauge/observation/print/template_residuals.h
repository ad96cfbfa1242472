// SPDX-License-Identifier: Apache-2.0
// Where in a print its pixels miss the template. Noise, blur and a poor template are in all of the window alike, and u
// tells of them; a hand, a leaf or a reflection lies in some of it and draws the print with it by more than u says.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "moiregauge/phase/fit/patch_fit.h"

namespace moiregauge::internal {

inline constexpr int kMissBlocks = 6;  // to a side of the window
inline constexpr std::size_t kAllMissBlocks = std::size_t{kMissBlocks} * kMissBlocks;

// Block by block of the window, row by row from low print coordinates.
struct PrintMisses {
  std::array<double, kAllMissBlocks> mean_square{};  // grey levels squared
  std::array<int, kAllMissBlocks> pixels{};
};
[[nodiscard]] PrintMisses template_residuals(const LumaView& luma, const PatchFit& fit, const PatchWindow& window,
                                             const PrintTemplate& print);

// In which blocks something lies that is not there in the other frame.
using BlockSet = std::array<bool, kAllMissBlocks>;
struct CoveredBlocks {
  BlockSet now{};
  BlockSet then{};
  bool any_now = false;
  bool any_then = false;
};

// The frames may differ in noise, light and blur: what counts is how a block stands to the window's median. Covered is a
// block whose misses (squared) are three times what they are in the other frame, or more where it has so few pixels that
// noise could do that (six standard deviations). Below that, if all of it pulled one way, a print of 13000 pixels would
// move by 4.5 u: sqrt(2) / 36 of sigma over its slope, where u is a 114th.
// `least`: grey levels squared that a block must miss by in excess.
[[nodiscard]] CoveredBlocks covered_blocks(const PrintMisses& then, const PrintMisses& now, double least);

// The largest rectangle of the window without those blocks; empty if it holds less than two fifths of it.
[[nodiscard]] std::optional<PatchWindow> free_window(const PatchWindow& window, const BlockSet& covered);

}  // namespace moiregauge::internal
