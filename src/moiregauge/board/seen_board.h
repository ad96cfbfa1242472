// SPDX-License-Identifier: Apache-2.0
// The board of a photograph as indexed points, whatever is printed on it (docs/methods/calibrate.md).
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
  double step_pitches = 1.0;      // from one column to the next: of a checkerboard half its pitch, which is two squares
  double diameter_pitches = 0.0;  // of dots
  std::vector<LatticePoint> points;
};

// The largest board in the picture: a lattice of dots, the corners of a checkerboard, else the points at which a
// crossed grating (squares, grid, cosine) repeats. Nothing where none has kMinLatticeSide points along both its axes.
[[nodiscard]] std::optional<SeenBoard> find_board(const GreyPicture& picture);

// The points at which a crossed grating repeats, found from one to the next so that a lens may bend its rows.
[[nodiscard]] SeenBoard grating_points(const LumaView& luma, const DetectedPatch& patch);

}  // namespace moiregauge::internal
