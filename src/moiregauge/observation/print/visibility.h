// SPDX-License-Identifier: Apache-2.0
// Maps the fringe visibility of a grating: cells of half a pitch, each from 0 (none) to about 1
// (docs/methods/precise/template.md).
#pragma once

#include <complex>
#include <functional>
#include <vector>

#include "moiregauge/image/image.h"
#include "moiregauge/phase/fit/patch_fit.h"
#include "moiregauge/site/site.h"

namespace moiregauge::internal {

// Axes of a grating along which its grey level varies.
struct Axes {
  bool x = true;
  bool y = true;
};
[[nodiscard]] Axes axes_of(const Grating& grating);

// Cell of the map: fringe visibility, and the complex amplitudes of both fundamentals relative to the nominal lattice,
// 1.
struct Presence {
  double strength = 0.0;
  std::complex<double> first, second;
};

class VisibilityMap {
 public:
  VisibilityMap(PrintPoint low, int columns, int rows, bool diagonal)
      : low_(low), columns_(columns), rows_(rows), diagonal_(diagonal) {
    cells_.resize(static_cast<std::size_t>(columns * rows));
  }
  // Returns the cell with its middle at `low` + (i, j) / 2 pitches.
  [[nodiscard]] Presence& at(int i, int j) { return cells_[static_cast<std::size_t>(j * columns_ + i)]; }
  // Return the cells with their middle in the window, displaced by (i, j) half pitches, and their sum. Cells outside
  // the map are zero.
  [[nodiscard]] double sum(const PatchWindow& window, int i, int j) const;
  [[nodiscard]] std::vector<double> cells(const PatchWindow& window, int i, int j) const;
  // Returns the lattice in that window, from the phase steps of the fundamentals between cells. It maps the map's
  // coordinates to the grating's own, linearly about the window's middle. An axis that the grating does not show keeps
  // its coordinate.
  // Error: some per cent where scale or shear are wrong by a quarter.
  [[nodiscard]] PrintFromPrint lattice(const PatchWindow& window, int i, int j, Axes axes) const;

 private:
  struct Span {
    int i0, j0, i1, j1;  // cells, ends included
  };
  [[nodiscard]] Span span_of(const PatchWindow& window, int i, int j) const;

  PrintPoint low_;
  int columns_, rows_;
  bool diagonal_;
  std::vector<Presence> cells_;
};

// Returns true for a pixel that is known not to show the grating.
using IsHidden = std::function<bool(ImagePoint)>;

// Returns the window with a margin of `pitches` on each side.
[[nodiscard]] inline PatchWindow with_margin(const PatchWindow& window, int pitches) {
  return {window.centre, window.half_x + pitches, window.half_y + pitches};
}

// Returns the cells of a window, which may extend beyond the grating. A cell uses one pitch around its middle: the
// amplitudes of the fundamentals relative to the mean grey level. Their geometric mean over both axes excludes a lone
// edge. Cells beyond the image, or with a hidden pixel, are zero.
[[nodiscard]] VisibilityMap presence_round(const LumaView& luma, const Grating& grating,
                                           const PrintFromImage& print_from_image, const PatchWindow& window,
                                           const IsHidden& is_hidden = {});

}  // namespace moiregauge::internal
