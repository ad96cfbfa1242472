// SPDX-License-Identifier: Apache-2.0
// Detects regular boards in an image and gives each point its column and row: lattices of dots, and inner corners of
// checkerboards. Tolerates tilt, lens distortion, missing points and clutter (docs/methods/indexed-lattices.md).
#pragma once

#include <span>
#include <vector>

#include "moiregauge/detection/circles/circles.h"
#include "moiregauge/image/image.h"
#include "moiregauge/units/point.h"

namespace moiregauge::internal {

enum class LatticeKind { kDots, kCheckerCorners };

struct LatticePoint {
  int column = 0;        // 0 .. columns - 1, along the board's axis nearest to the image's horizontal, rightwards
  int row = 0;           // 0 .. rows - 1, downwards
  ImagePoint at;         // px; for a dot, the centre of the imaged ellipse
  double u_px = 0.0;     // px, standard uncertainty (k = 1) of each coordinate
  double size_px = 0.0;  // px, diameter of a dot (geometric mean of the axes), or side of the squares at a corner
};

struct IndexedLattice {
  LatticeKind kind = LatticeKind::kDots;
  int columns = 0;
  int rows = 0;
  std::vector<LatticePoint> points;  // detected points, row by row, each row from left to right
  double pitch_px = 0.0;             // px, median distance of neighbours: dot to dot, corner to corner (ONE square)
  // Dots: dark on light. Corners: the square to the lower right of (0, 0), between columns 0, 1 and rows 0, 1, is dark.
  bool dark = true;

  // Returns true for a full rectangle: all columns x rows points were detected.
  [[nodiscard]] bool whole() const {
    return points.size() == static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  }
  // Returns the point at a column and row; null if it was not detected.
  [[nodiscard]] const LatticePoint* find(int column, int row) const;
};

// Points per side of the smallest lattice; chance seldom produces one of 3 x 3.
inline constexpr int kMinLatticeSide = 3;

struct DotSearchOptions {
  double min_diameter_px = 5.0;    // px, geometric mean of the axes
  double max_diameter_px = 400.0;  // px
};

// Returns the lattices formed by some of the circles, largest first.
[[nodiscard]] std::vector<IndexedLattice> find_dot_lattices(std::span<const DetectedCircle> circles);

// Detects lattices of dots in an image, largest first. At predicted positions without an accepted dot, a second search
// uses the size and shape of the neighbours. `seen` holds the circles already detected in the image.
[[nodiscard]] std::vector<IndexedLattice> find_dot_lattices(const LumaView& luma, std::span<const DetectedCircle> seen);
[[nodiscard]] std::vector<IndexedLattice> find_dot_lattices(const LumaView& luma, const DotSearchOptions& options);

// Detects the inner corners of checkerboards in an image, largest board first. `bits` is the bit depth of the image.
// Returns none for an image with more than 20000 candidates.
[[nodiscard]] std::vector<IndexedLattice> find_checker_lattices(const LumaView& luma, int bits);

}  // namespace moiregauge::internal
