// SPDX-License-Identifier: Apache-2.0
// Regular targets in a picture, every point with its column and row: lattices of dots, and the inner corners of
// checkerboards. Seen at an angle, through a lens, with points missing and other things lying about
// (docs/methods/indexed-lattices.md).
#pragma once

#include <span>
#include <vector>

#include "moiregauge/detection/circles/circles.h"
#include "moiregauge/image/image.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal {

enum class LatticeKind { kDots, kCheckerCorners };

struct LatticePoint {
  int column = 0;        // 0 .. columns - 1, along the print's axis nearest to the picture's horizontal, rightwards
  int row = 0;           // 0 .. rows - 1, downwards
  ImagePoint at;         // px; of a dot the centre of the imaged ellipse
  double u_px = 0.0;     // standard uncertainty of each coordinate
  double size_px = 0.0;  // a dot's diameter (geometric mean of the axes); round a corner, the side of the squares
};

struct IndexedLattice {
  LatticeKind kind = LatticeKind::kDots;
  int columns = 0;
  int rows = 0;
  std::vector<LatticePoint> points;  // row by row, each row from left to right; places where nothing was seen left out
  double pitch_px = 0.0;             // median distance of neighbours: dot to dot, corner to corner (ONE square)
  // Dots: dark on light. Corners: the square to the lower right of (0, 0), between columns 0, 1 and rows 0, 1, is dark.
  bool dark = true;

  // A full rectangle: every place of columns x rows was seen.
  [[nodiscard]] bool whole() const {
    return points.size() == static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  }
  // The point at a place; null where nothing was seen.
  [[nodiscard]] const LatticePoint* find(int column, int row) const;
};

// Lattices of at least kMinLatticeSide x kMinLatticeSide points are told from chance.
inline constexpr int kMinLatticeSide = 3;

struct DotSearchOptions {
  double min_diameter_px = 5.0;
  double max_diameter_px = 400.0;
};

// The lattices some circles form, largest first. Circles that belong to none are left out.
[[nodiscard]] std::vector<IndexedLattice> find_dot_lattices(std::span<const DetectedCircle> circles);

// The lattices of dots in a picture, largest first. Where a lattice says that a dot must be and none was accepted, the
// place is looked at once more by the lattice's own measure of size. `seen`: circles already found in the picture.
[[nodiscard]] std::vector<IndexedLattice> find_dot_lattices(const LumaView& luma, std::span<const DetectedCircle> seen);
[[nodiscard]] std::vector<IndexedLattice> find_dot_lattices(const LumaView& luma, const DotSearchOptions& options);

// The inner corners of the checkerboards in a picture, largest first. `bits`: of the picture's grey levels.
[[nodiscard]] std::vector<IndexedLattice> find_checker_lattices(const LumaView& luma, int bits);

}  // namespace moiregauge::internal
