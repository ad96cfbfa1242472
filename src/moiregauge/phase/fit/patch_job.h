// SPDX-License-Identifier: Apache-2.0
// Data that sum_patch and sum_shift (patch_pass.cc) share on every SIMD target.
#pragma once

#include <array>

#include "moiregauge/phase/fit/patch_pass.h"

namespace moiregauge::internal {

inline constexpr int kBlockWidth = 16;
// Rows that are summed in single precision before the sums go into doubles. Chosen.
inline constexpr int kBandRows = 16;
inline constexpr int kStripRows = 64;  // the same for the sums by tiles
inline constexpr int kProducts = kColumns * (kColumns + 1) / 2;
inline constexpr int kShiftProducts = kShiftColumns * (kShiftColumns + 1) / 2;
enum class Sum {
  kRight,   // residual times each column, and squared residual
  kNormal,  // also the products of the columns
  // The same for a window that moves as a whole: with its four columns and their products.
  kShift,
  kBlocks  // squared residual by blocks of the window
};
// Returns the number of sums.
constexpr int sums_of(Sum sum) {
  return sum == Sum::kBlocks ? 1 : sum == Sum::kShift ? kShiftColumns + 1 + kShiftProducts : kColumns + 1;
}

// Map from pixels to (u, v). Pixels count from the window's middle one, so that the numbers suit single precision.
struct PatchJob {
  std::array<float, 9> uv_from_px{};  // homography, row by row, with last element 1
  int x = 0, y = 0;                   // middle pixel, px
  std::array<float, 3> light{}, contrast{}, gain{}, shape{};
  std::array<float, 4> nodes{};  // grating coordinates in nodes: [0] + u [1], [2] + v [3]
  const PrintNodes* table = nullptr;
  PixelBox box;
  PixelSteps steps;
};

// Sixteen lanes of every sum.
struct LaneSums {
  alignas(64) float right[kColumns + 1][kBlockWidth];  // in the order of the registers
  alignas(64) float normal[kProducts][kBlockWidth];    // lower triangle, row by row
  // By blocks: squared residuals, and numbers of pixels.
  alignas(64) float squares[kWindowBlocks * kWindowBlocks][kBlockWidth];
  int pixels[kWindowBlocks * kWindowBlocks];
};

// Totals in the order of the registers.
struct PatchTotals {
  std::array<double, kColumns + 1> sums{};
  NormalMatrix* normal = nullptr;
  BlockSums* blocks = nullptr;
  int pixels = 0;
};

[[nodiscard]] PatchJob job_of(const PatchModel& model, const PrintNodes& nodes, const PixelBox& box,
                              const PixelSteps& steps);

}  // namespace moiregauge::internal
