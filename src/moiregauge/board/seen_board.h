// SPDX-License-Identifier: Apache-2.0
// Detection of the board in a photograph, as indexed points (docs/methods/calibrate.md).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "moiregauge/detection/gratings/grating_patches.h"
#include "moiregauge/detection/lattices/indexed_lattice.h"
#include "moiregauge/observation/reference/reference.h"

namespace moiregauge::internal {

enum class BoardPattern { kDots, kCheckerboard, kGrating };
[[nodiscard]] const char* name_of(BoardPattern pattern);

struct SeenBoard {
  BoardPattern pattern = BoardPattern::kDots;
  int columns = 0;
  int rows = 0;
  double step_pitches = 1.0;      // distance of columns; 0.5 for a checkerboard, whose pitch is two squares
  double diameter_pitches = 0.0;  // a dot's diameter; 0: no dots
  std::vector<LatticePoint> points;
};

// Detects the largest board in the image: a lattice of dots, the corners of a checkerboard, or a crossed grating.
// Fails (nothing): no lattice has kMinLatticeSide points along both axes.
[[nodiscard]] std::optional<SeenBoard> find_board(const GreyPicture& picture);

// Finds the points at which a crossed grating (squares, grid, cosine) repeats, each from its neighbour. A lens may bend
// the rows.
[[nodiscard]] SeenBoard grating_points(const LumaView& luma, const DetectedPatch& patch);

}  // namespace moiregauge::internal
