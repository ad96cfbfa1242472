// SPDX-License-Identifier: Apache-2.0
// Where sixteen pixels of a row lie in the print, and which light they have: what sum_patch (patch_pass.cc) asks for
// every row of a block, in double precision, before its lanes take over.
#pragma once

#include <array>

#include "moiregauge/phase/patch_pass.h"

namespace moiregauge {

inline constexpr int kBlockWidth = 16;

struct PatchJob {
  PatchMap map;
  Matrix3 h;  // of the map
  PatchWindow window;
  const PrintNodes* nodes = nullptr;
  PixelBox box;
  int row_step = 1;
};

// The map's field on one row, in u.
struct RowField {
  std::array<double, 3> dx{}, dy{};
};
[[nodiscard]] RowField field_on(const PatchMap& map, double v);

// Print coordinates along a block's row, in nodes from the template's middle: a + k (b + k c), k px from the row's
// middle.
struct RowMap {
  std::array<float, 3> x{}, y{};
  std::array<float, 2> light{}, contrast{}, gain{};  // a + k b; the gain by nodes
};
// `x`, `y`: of the row's middle, px.
[[nodiscard]] RowMap row_map(const PatchJob& job, const RowField& field, double x, double y);

}  // namespace moiregauge
