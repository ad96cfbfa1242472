// SPDX-License-Identifier: Apache-2.0
// Sums the raw pixels of one grating for least squares. This is the hot loop of `precise`, and it allocates nothing.
// Each of sixteen adjacent pixels has a lane. Lanes are added in one fixed order, and no product is fused with a sum.
// So every SIMD target gives the same bits (Highway, chosen at run time; decision 0016).
#pragma once

#include <array>

#include <Eigen/Core>

#include "moiregauge/geometry/homography.h"
#include "moiregauge/image/image.h"
#include "moiregauge/phase/fit/print_template.h"

namespace moiregauge::internal {

namespace frame {
struct Window;  // (u, v): position in the window of a grating, -1 to 1 along both axes
}

using PrintFromImage = Homography<frame::Print, frame::Image>;
using PrintFromPrint = Homography<frame::Print, frame::Print>;

// Pixels of the fit: |X - centre.x| <= half_x and |Y - centre.y| <= half_y, in pitches. The grating's edge is outside.
struct PatchWindow {
  PrintPoint centre;
  double half_x = 0.0;
  double half_y = 0.0;
};

// Returns the map from grating coordinates (pitches) to window coordinates (-1 to 1).
[[nodiscard]] inline Homography<frame::Window, frame::Print> window_from_print(const PatchWindow& w) {
  Matrix3 h;
  h << 1.0 / w.half_x, 0, -w.centre.x / w.half_x, 0, 1.0 / w.half_y, -w.centre.y / w.half_y, 0, 0, 1;
  return Homography<frame::Window, frame::Print>(h);
}

// Order of the unknowns, in window coordinates (u, v): light b0 bu bv, contrast g0 gu gv, blur along X and Y, width.
// Then come the terms u^i v^j of dX (i fastest, i, j <= 2), then those of dY.
inline constexpr int kLightColumns = 6;
inline constexpr int kBlurColumns = 2;
inline constexpr int kWidthColumns = 1;
inline constexpr int kWidthColumn = kLightColumns + kBlurColumns;
inline constexpr int kBaseColumns = kLightColumns + kBlurColumns + kWidthColumns;
inline constexpr int kFieldColumns = 9;
inline constexpr int kColumns = kBaseColumns + 2 * kFieldColumns;
using NormalMatrix = Eigen::Matrix<double, kColumns, kColumns>;
using NormalVector = Eigen::Matrix<double, kColumns, 1>;

// Coefficients of 1, u and v of a quantity that is a plane over the window.
using PatchPlane = std::array<double, 3>;

// Predicted grey levels of a window.
struct PatchModel {
  PrintFromImage map;
  PatchWindow window;
  // Light (grey levels) and contrast (1), subtracted from the grey levels before these are summed.
  PatchPlane light{}, contrast{};
  // Blur along X and Y and width of the lines, subtracted, too.
  std::array<double, kBlurColumns + kWidthColumns> shape{};
  // Factor of the template's derivatives in the columns of blur, width and field.
  PatchPlane gain{1.0, 0.0, 0.0};
};

// Sums over the window's pixels of the residual: grey level minus prediction.
struct PatchSums {
  NormalVector right = NormalVector::Zero();  // residual times each column
  double left2 = 0.0;                         // squared residual, grey levels^2
  int pixels = 0;
};

// Sums the residuals over `box`, which must lie inside the image. With `normal`, sums the columns' products into it, too.
[[nodiscard]] PatchSums sum_patch(const LumaView& luma, const PatchModel& model, const PrintNodes& nodes,
                                  const PixelBox& box, NormalMatrix* normal = nullptr);

// Unknowns of a window that moves as a whole: b0, g0, dX, dY.
inline constexpr int kShiftColumns = 4;
struct ShiftSums {
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  double left2 = 0.0;
  int pixels = 0;
};
// Selects pixels of a box: every `rows`-th row, and every `blocks`-th block of sixteen pixels in it. Successive rows begin
// at successive blocks, so that all columns are met.
struct PixelSteps {
  int rows = 1;
  int blocks = 1;
};
// Sums the residuals and products of these four columns over the selected pixels of `box`.
[[nodiscard]] ShiftSums sum_shift(const LumaView& luma, const PatchModel& model, const PrintNodes& nodes,
                                  const PixelBox& box, const PixelSteps& steps);

// Blocks per side of a window. Chosen.
inline constexpr int kWindowBlocks = 6;
// Sums over the pixels of each block, row by row from low grating coordinates.
struct BlockSums {
  std::array<double, std::size_t{kWindowBlocks} * kWindowBlocks> squares{};  // squared residuals, grey levels^2
  std::array<int, std::size_t{kWindowBlocks} * kWindowBlocks> pixels{};
};
// Sums the squared residuals by blocks over every row_step-th row of `box`, which must lie inside the image.
[[nodiscard]] BlockSums sum_blocks(const LumaView& luma, const PatchModel& model, const PrintNodes& nodes,
                                   const PixelBox& box, int row_step);

}  // namespace moiregauge::internal
