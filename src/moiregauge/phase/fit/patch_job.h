// SPDX-License-Identifier: Apache-2.0
// What sum_patch and sum_shift (patch_pass.cc) share on every SIMD target.
#pragma once

#include <array>

#include "moiregauge/phase/fit/patch_pass.h"

namespace moiregauge::internal {

inline constexpr int kBlockWidth = 16;
// Single precision holds the sums of so many rows; then they go into doubles.
inline constexpr int kBandRows = 16;
inline constexpr int kProducts = kColumns * (kColumns + 1) / 2;
inline constexpr int kShiftProducts = kShiftColumns * (kShiftColumns + 1) / 2;
enum class Sum {
  kRight,   // times each column, and squared
  kNormal,  // also the columns' products
  kShift    // of the patch as a whole: times each of its columns, squared, and these columns' products
};
// How many of them are kept in registers.
constexpr int registers_of(Sum sum) { return sum == Sum::kShift ? kShiftColumns + 1 + kShiftProducts : kColumns + 1; }

// (u, v) of pixels by their distance from the patch's middle pixel: numbers near 1, so that single precision will do.
struct PatchJob {
  std::array<float, 9> uv_from_px{};  // a homography, row by row, its last element 1
  int x = 0, y = 0;                   // of the middle pixel
  std::array<float, 3> light{}, contrast{}, gain{}, shape{};
  std::array<float, 4> nodes{};  // print coordinates in nodes: [0] + u [1], [2] + v [3]
  const PrintNodes* table = nullptr;
  PixelBox box;
  int row_step = 1;
};

// Sixteen lanes of every sum.
struct LaneSums {
  alignas(64) float right[kColumns + 1][kBlockWidth];  // in order of registers
  alignas(64) float normal[kProducts][kBlockWidth];    // lower triangle, row by row
};

// In the order of the registers.
struct PatchTotals {
  std::array<double, kColumns + 1> sums{};
  NormalMatrix* normal = nullptr;
  int pixels = 0;
};

// Every row_step-th row of `box`.
[[nodiscard]] PatchJob job_of(const PatchModel& model, const PrintNodes& nodes, const PixelBox& box, int row_step);

}  // namespace moiregauge::internal
