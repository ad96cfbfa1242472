// SPDX-License-Identifier: Apache-2.0
// Maps the fringe visibility of a grating: cells of half a pitch, each from 0 (none) to about 1
// (docs/methods/precise/template.md).
#pragma once

#include <complex>
#include <functional>
#include <optional>
#include <vector>

#include "moiregauge/geometry/view.h"
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

// Returns the cells within `pitches` of a grating's window. The grating coordinates are `correction` times those of a
// grating displaced by `moved` in the view. A cell uses one pitch around its middle: the amplitudes of the fundamentals
// relative to the mean grey level. Their geometric mean over both axes excludes a lone edge. Cells beyond the image, or
// with a hidden pixel, are zero.
// Fails (nothing): the grating's corners determine no homography in this view.
[[nodiscard]] std::optional<VisibilityMap> presence_round(const LumaView& luma, const View& view,
                                                          const Grating& grating, const PatchWindow& window,
                                                          Extent<frame::Board> moved, const PrintFromPrint& correction,
                                                          int pitches, const IsHidden& is_hidden = {});

}  // namespace moiregauge::internal
