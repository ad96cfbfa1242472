// SPDX-License-Identifier: Apache-2.0
// One pass over a patch's raw pixels: all that least squares needs of them, as sums. The hot loop of `precise`; it
// allocates nothing. Sixteen pixels side by side have a lane each, lanes are added in one fixed order, and no product
// is fused with a sum: the same bits on every SIMD target (Highway, chosen at run time).
#pragma once

#include <array>

#include <Eigen/Core>

#include "moiregauge/geometry/homography.h"
#include "moiregauge/image/image.h"
#include "moiregauge/phase/fit/print_template.h"

namespace moiregauge::internal {

namespace frame {
struct Window;  // (u, v): a patch's window, from -1 to 1 both ways
}

using PrintFromImage = Homography<frame::Print, frame::Image>;
using PrintFromPrint = Homography<frame::Print, frame::Print>;

// The pixels that count: |X - centre.x| <= half_x, |Y - centre.y| <= half_y in pitches, the print's edge left out.
struct PatchWindow {
  PrintPoint centre;
  double half_x = 0.0;
  double half_y = 0.0;
};

[[nodiscard]] inline Homography<frame::Window, frame::Print> window_from_print(const PatchWindow& w) {
  Matrix3 h;
  h << 1.0 / w.half_x, 0, -w.centre.x / w.half_x, 0, 1.0 / w.half_y, -w.centre.y / w.half_y, 0, 0, 1;
  return Homography<frame::Window, frame::Print>(h);
}

// Pixels, ends included.
struct PixelBox {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

// Unknowns in this order, in the window's own (u, v), each from -1 to 1: light b0 bu bv, contrast g0 gu gv, blur along
// X and along Y, width of the lines, then dX of u^i v^j (i fastest, i, j <= 2), then dY.
inline constexpr int kLightColumns = 6;
inline constexpr int kBlurColumns = 2;
inline constexpr int kWidthColumns = 1;
inline constexpr int kWidthColumn = kLightColumns + kBlurColumns;
inline constexpr int kBaseColumns = kLightColumns + kBlurColumns + kWidthColumns;
inline constexpr int kFieldColumns = 9;
inline constexpr int kColumns = kBaseColumns + 2 * kFieldColumns;
using NormalMatrix = Eigen::Matrix<double, kColumns, kColumns>;
using NormalVector = Eigen::Matrix<double, kColumns, 1>;

// A quantity that changes across the patch: its parts along 1, u, v.
using PatchPlane = std::array<double, 3>;

// What a pixel should show.
struct PatchModel {
  PrintFromImage map;
  PatchWindow window;
  PatchPlane light{}, contrast{};                            // taken off the grey levels before they are summed
  std::array<double, kBlurColumns + kWidthColumns> shape{};  // blur along X and Y, width of the lines: also taken off
  PatchPlane gain{1.0, 0.0, 0.0};  // times the template's slopes and second derivatives: the columns of blur and field
};

// Over the window's pixels, of what is left of the grey level.
struct PatchSums {
  NormalVector right = NormalVector::Zero();  // times each column
  double left2 = 0.0;                         // squared
  int pixels = 0;
};

// Over `box`, which must lie in the picture. With `normal` also the columns' products.
void sum_patch(const LumaView& luma, const PatchModel& model, const PrintNodes& nodes, const PixelBox& box,
               PatchSums& sums, NormalMatrix* normal = nullptr);

// Where only light, contrast and place of the patch as a whole are asked for (b0, g0, dX, dY), every row_step-th row.
inline constexpr int kShiftColumns = 4;
struct ShiftSums {
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  double left2 = 0.0;
  int pixels = 0;
};
void sum_shift(const LumaView& luma, const PatchModel& model, const PrintNodes& nodes, const PixelBox& box,
               int row_step, ShiftSums& sums);

}  // namespace moiregauge::internal
