// SPDX-License-Identifier: Apache-2.0
// Computes residuals of a template fit by blocks of the window (docs/methods/precise/frame-reading.md). Noise, blur and
// a poor template affect the whole window alike, and u includes them. A hand, a leaf or a reflection covers a part and
// displaces the grating by more than u states.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "moiregauge/phase/fit/patch_fit.h"

namespace moiregauge::internal {

inline constexpr int kMissBlocks = kWindowBlocks;  // per side of the window
inline constexpr std::size_t kAllMissBlocks = std::size_t{kMissBlocks} * kMissBlocks;

// Residuals of the window's blocks, row by row from low grating coordinates.
struct PrintMisses {
  std::array<double, kAllMissBlocks> mean_square{};  // grey levels^2
  std::array<int, kAllMissBlocks> pixels{};
};
// Returns the change of blur along X and Y that a fit found, times its contrast, pitch^2.
[[nodiscard]] std::array<double, 2> blur_of(const PatchFit& fit);

// Returns the residuals of a fit in every row_step-th row. All are zero if its points determine no homography.
[[nodiscard]] PrintMisses template_residuals(const LumaView& luma, const PatchFit& fit, const PatchWindow& window,
                                             const PrintTemplate& print, int row_step = 1);

// Blocks that are covered in one frame only: now or in the reference frame.
using BlockSet = std::array<bool, kAllMissBlocks>;
struct CoveredBlocks {
  BlockSet now{};
  BlockSet then{};
  bool any_now = false;
  bool any_then = false;
};

// Returns the blocks covered in one of two frames. The frames may differ in noise, light and blur, so each block counts
// relative to the median of its frame. A block is covered if its mean square is three times that of the other frame. In
// a block of few pixels it must exceed six standard deviations of noise, too. `least`: smallest excess of a mean
// square, grey levels^2.
// Error: a smaller change, if all of it pulled one way, would move a grating of 13000 pixels by 4.5 u. That is sqrt(2)
// / 36 of sigma over its slope, and u is 1 / 114 of it.
[[nodiscard]] CoveredBlocks covered_blocks(const PrintMisses& then, const PrintMisses& now, double least);

// Returns the largest rectangle of the window without those blocks.
// Fails (nothing): it is smaller than two fifths of the window.
[[nodiscard]] std::optional<PatchWindow> free_window(const PatchWindow& window, const BlockSet& covered);

}  // namespace moiregauge::internal
